cmake_minimum_required(VERSION 3.25)
# Installs the build into a scratch prefix and builds and runs examples against it, by find_package and
# by pkg-config. The JSON that a user of the library writes is that of the installed program, byte for
# byte.
set(prefix ${BUILD_DIR}/installed_package/prefix)
set(user ${BUILD_DIR}/installed_package/user)
file(REMOVE_RECURSE ${BUILD_DIR}/installed_package)

include(${CMAKE_CURRENT_LIST_DIR}/run.cmake)

set(flags "")
if(SANITIZE)
  set(flags -DCMAKE_EXE_LINKER_FLAGS=-fsanitize=address,undefined)
endif()
run(${CMAKE_COMMAND} --install ${BUILD_DIR} --prefix ${prefix})
# What only building mindahl needs is asked of no user.
set(not_needed "")
foreach(package Boost nlohmann_json CLI11 GTest)
  list(APPEND not_needed -DCMAKE_DISABLE_FIND_PACKAGE_${package}=ON)
endforeach()
run(${CMAKE_COMMAND} -S ${SOURCE_DIR}/examples -B ${user} -G ${GENERATOR} -DCMAKE_CXX_COMPILER=${CXX}
    -DCMAKE_BUILD_TYPE=Release -DCMAKE_PREFIX_PATH=${prefix} ${not_needed} ${flags})
# The two that together need every module which others may use; the project builds and tests all.
run(${CMAKE_COMMAND} --build ${user} --target fit_to_json cycles_of_stream)
run(${user}/cycles_of_stream)

# The models alone are found where neither Ceres nor what files are read with is.
file(WRITE ${user}_models/CMakeLists.txt "cmake_minimum_required(VERSION 3.25)
project(user LANGUAGES CXX)
find_package(mindahl REQUIRED COMPONENTS models)
add_executable(mass ${SOURCE_DIR}/examples/mass_on_contact.cc)
target_link_libraries(mass PRIVATE mindahl::models)
find_package(mindahl QUIET COMPONENTS no_such_module)
if(mindahl_FOUND)
  message(FATAL_ERROR \"a module is found that there is not\")
endif()
")
foreach(package Ceres ZLIB Threads)
  list(APPEND not_needed -DCMAKE_DISABLE_FIND_PACKAGE_${package}=ON)
endforeach()
run(${CMAKE_COMMAND} -S ${user}_models -B ${user}_models/build -G ${GENERATOR} -DCMAKE_CXX_COMPILER=${CXX}
    -DCMAKE_PREFIX_PATH=${prefix} ${not_needed} ${flags})
run(${CMAKE_COMMAND} --build ${user}_models/build)
run(${user}_models/build/mass)

# The page names every package that the whole library needs, beside what CMake finds with Ceres.
file(READ ${prefix}/lib/cmake/mindahl/mindahlConfig.cmake config)
file(READ ${SOURCE_DIR}/docs/library.md page)
string(REGEX MATCH "mindahl_request_needs \"([^\"]*)\"" needs "${config}")
set(needs ${CMAKE_MATCH_1})
foreach(package IN LISTS needs)
  string(FIND "${page}" "`${package}`" at)
  if(at LESS 0)
    message(FATAL_ERROR "docs/library.md does not say that the library needs ${package}")
  endif()
endforeach()

file(GLOB_RECURSE pc ${prefix}/*/mindahl.pc)
get_filename_component(pc_directory "${pc}" DIRECTORY)
find_program(pkg_config pkg-config REQUIRED)
execute_process(
  COMMAND ${CMAKE_COMMAND} -E env PKG_CONFIG_PATH=${pc_directory}
          ${pkg_config} --cflags --libs --static mindahl
  OUTPUT_VARIABLE pc_flags COMMAND_ERROR_IS_FATAL ANY OUTPUT_STRIP_TRAILING_WHITESPACE)
separate_arguments(pc_flags UNIX_COMMAND "${pc_flags}")
set(sanitizer "")
if(SANITIZE)
  set(sanitizer -fsanitize=address,undefined)
endif()
run(${CXX} -std=c++20 ${sanitizer} ${SOURCE_DIR}/examples/fit_to_json.cc -o ${user}/by_pkg_config
    ${pc_flags})
run(${user}/by_pkg_config ${SOURCE_DIR}/data/mindlin_sphere_on_plane.csv)

foreach(file include/mindahl/identification/fit.h share/mindahl/schema/fit.json
        share/man/man1/mindahl-fit.1)
  if(NOT EXISTS ${prefix}/${file})
    message(FATAL_ERROR "${file} is not installed")
  endif()
endforeach()
# Of every module that others may use, and of the program's own none.
foreach(module core loop models contact methods tradeoff convert identification io report campaign)
  file(GLOB_RECURSE library ${prefix}/lib*/libmindahl_${module}.a)
  if(NOT library)
    message(FATAL_ERROR "libmindahl_${module}.a is not installed")
  endif()
endforeach()
file(GLOB_RECURSE own ${prefix}/lib*/libmindahl_cli.a)
if(own)
  message(FATAL_ERROR "the program's own library is installed")
endif()

function(expect_same_json record)  # further arguments: the normal load
  set(option "")
  if(ARGN)
    set(option --normal-load ${ARGN})
  endif()
  foreach(who user program)
    if("${who}" STREQUAL "user")
      set(command ${user}/fit_to_json ${record} ${ARGN})
    else()
      set(command ${prefix}/bin/mindahl fit ${record} ${option} --json -)
    endif()
    execute_process(COMMAND ${command} RESULT_VARIABLE status OUTPUT_FILE ${user}/${who}.json
                    ERROR_VARIABLE messages)
    if(NOT status EQUAL 0)
      message(FATAL_ERROR "${command} exits with ${status}: ${messages}")
    endif()
  endforeach()
  file(SIZE ${user}/user.json size)
  if(size LESS 1000)
    message(FATAL_ERROR "the JSON of ${record} has only ${size} bytes")
  endif()
  run(${CMAKE_COMMAND} -E compare_files ${user}/user.json ${user}/program.json)
endfunction()

# A record with a column of its load, too.
set(loaded ${user}/loaded.csv)
file(READ ${SOURCE_DIR}/data/mindlin_sphere_on_plane.csv text)
string(REPLACE "\n" ",50.5\n" text "${text}")
string(REPLACE "force [N],50.5" "force [N],normal load [N]" text "${text}")
file(WRITE ${loaded} "${text}")

expect_same_json(${SOURCE_DIR}/data/mindlin_sphere_on_plane.csv)
expect_same_json(${SOURCE_DIR}/data/mindlin_sphere_on_plane.csv 50)
expect_same_json(${SOURCE_DIR}/data/far_from_slip.csv 80)
expect_same_json(${loaded})
