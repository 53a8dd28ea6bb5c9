cmake_minimum_required(VERSION 3.25)
# Installs the build into a scratch prefix and builds and runs the examples of examples/ against it.
set(prefix ${BUILD_DIR}/installed_package/prefix)
set(user ${BUILD_DIR}/installed_package/user)
file(REMOVE_RECURSE ${BUILD_DIR}/installed_package)

function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT status EQUAL 0)
    list(JOIN ARGN " " command)
    message(FATAL_ERROR "${command}\n${output}")
  endif()
endfunction()

set(flags "")
if(SANITIZE)
  set(flags -DCMAKE_EXE_LINKER_FLAGS=-fsanitize=address,undefined)
endif()
run(${CMAKE_COMMAND} --install ${BUILD_DIR} --prefix ${prefix})
run(${CMAKE_COMMAND} -S ${SOURCE_DIR}/examples -B ${user} -G ${GENERATOR} -DCMAKE_CXX_COMPILER=${CXX}
    -DCMAKE_BUILD_TYPE=Release -DCMAKE_PREFIX_PATH=${prefix} ${flags})
run(${CMAKE_COMMAND} --build ${user})
run(${user}/fit_record ${SOURCE_DIR}/data/mindlin_sphere_on_plane.csv)
run(${user}/mass_on_contact)
