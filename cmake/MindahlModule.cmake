# Warnings and sanitizers, linked PRIVATE by every target of the project and never exported.
add_library(mindahl_build_flags INTERFACE)
target_compile_options(mindahl_build_flags INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion
  $<$<BOOL:${MINDAHL_WARNINGS_AS_ERRORS}>:-Werror>)
# What these say of g++ 12's own std::string depends on what was inlined, down to the length of a
# path in a macro: shown, never an error. The sanitizers look for the same mistakes as they happen.
set(flow_warnings array-bounds stringop-overflow stringop-overread restrict maybe-uninitialized
    mismatched-new-delete free-nonheap-object nonnull use-after-free dangling-pointer)
list(TRANSFORM flow_warnings PREPEND "-Wno-error=")
target_compile_options(mindahl_build_flags INTERFACE
  "$<$<CXX_COMPILER_ID:GNU>:${flow_warnings}>")
if(MINDAHL_SANITIZE)
  target_compile_options(mindahl_build_flags INTERFACE
    -fsanitize=address,undefined,float-cast-overflow,float-divide-by-zero
    -fno-sanitize-recover=all
    -fno-omit-frame-pointer)
  # A null pointer ends the program under the address sanitizer too; these checks, one before every
  # use of a pointer, take 40 % of the time to compile.
  if(NOT MINDAHL_SANITIZE_POINTERS)
    target_compile_options(mindahl_build_flags INTERFACE
      -fno-sanitize=null,alignment,object-size,vptr)
  endif()
  target_link_options(mindahl_build_flags INTERFACE -fsanitize=address,undefined)
  # Else Eigen aligns memory by itself under the sanitizer, and frees so what Ceres, which is built
  # without it, has allocated.
  target_compile_definitions(mindahl_build_flags INTERFACE EIGEN_MALLOC_ALREADY_ALIGNED=1)
endif()

if(MINDAHL_FUZZ)
  target_compile_options(mindahl_build_flags INTERFACE -fsanitize=fuzzer-no-link)
endif()

separate_arguments(cold_options UNIX_COMMAND "${MINDAHL_COLD_COMPILE_OPTIONS}")

# mindahl_add_module(NAME [COLD] SOURCES ... [PUBLIC targets...] [PRIVATE targets...] [PRECOMPILE headers...])
# One static library a module, mindahl::NAME, whose public headers are include/mindahl/NAME/*.h. What
# these declare is visible in a shared library that it becomes part of, and nothing else.
# COLD: no part of the time that it takes to run is spent in it.
# PRECOMPILE: headers of others that take most of the time to compile its sources.
# What is all headers is asked of nobody who links the library.
set(header_only Eigen3::Eigen Boost::headers nlohmann_json::nlohmann_json CLI11::CLI11)
function(mindahl_add_module name)
  cmake_parse_arguments(PARSE_ARGV 1 MODULE "COLD" "" "SOURCES;PUBLIC;PRIVATE;PRECOMPILE")
  add_library(mindahl_${name} STATIC ${MODULE_SOURCES})
  add_library(mindahl::${name} ALIAS mindahl_${name})
  target_compile_features(mindahl_${name} PUBLIC cxx_std_20)
  set_target_properties(mindahl_${name} PROPERTIES
    EXPORT_NAME ${name} CXX_EXTENSIONS OFF POSITION_INDEPENDENT_CODE ON
    CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
  target_include_directories(mindahl_${name}
    PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include> $<INSTALL_INTERFACE:include>
    PRIVATE ${PROJECT_SOURCE_DIR}/src)
  file(GLOB headers CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/include/mindahl/${name}/*.h)
  # It takes long to compile, and states its visibility itself.
  list(FILTER headers EXCLUDE REGEX "/ceres_problem[.]h$")
  set(visible "")
  if(headers)
    list(TRANSFORM headers REPLACE ".*/include/(mindahl/.+)" "#include \"\\1\"\n")
    list(JOIN headers "" headers)
    set(visible ${CMAKE_CURRENT_BINARY_DIR}/generated/visible/${name}.h)
    file(CONFIGURE OUTPUT ${visible} @ONLY CONTENT
      "#pragma GCC visibility push(default)\n@headers@#pragma GCC visibility pop\n")
  endif()
  set(private_libraries "")
  set(needs "")
  foreach(library IN LISTS MODULE_PUBLIC MODULE_PRIVATE)
    if(library MATCHES "^mindahl::(.*)")
      get_property(others GLOBAL PROPERTY MINDAHL_NEEDS_${CMAKE_MATCH_1})
      list(APPEND needs ${others})
    elseif(NOT library IN_LIST header_only)
      list(APPEND needs ${library})
    endif()
  endforeach()
  list(REMOVE_DUPLICATES needs)
  # What others than the project's that are linked with the module, by itself or what it uses.
  set_property(GLOBAL PROPERTY MINDAHL_NEEDS_${name} ${needs})
  foreach(library IN LISTS MODULE_PRIVATE)
    if(library IN_LIST header_only)
      set(library $<BUILD_INTERFACE:${library}>)
    endif()
    list(APPEND private_libraries ${library})
  endforeach()
  target_link_libraries(mindahl_${name}
    PUBLIC ${MODULE_PUBLIC}
    PRIVATE ${private_libraries} $<BUILD_INTERFACE:mindahl_build_flags>)
  if(MODULE_COLD)
    target_compile_options(mindahl_${name} PRIVATE ${cold_options})
  endif()
  set_property(GLOBAL APPEND PROPERTY MINDAHL_MODULES ${name})
  # Joined sources parse them once: to precompile them costs more.
  if(MINDAHL_PRECOMPILE_HEADERS AND MODULE_PRECOMPILE AND NOT CMAKE_UNITY_BUILD)
    target_precompile_headers(mindahl_${name} PRIVATE ${visible} ${MODULE_PRECOMPILE})
  elseif(visible)
    target_compile_options(mindahl_${name} PRIVATE "SHELL:-include ${visible}")
  endif()
endfunction()
