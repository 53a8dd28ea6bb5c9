cmake_minimum_required(VERSION 3.25)
# Where the C library has no iconv, as on macOS, and libmd is in a folder of its own, both are linked to
# the shared library, and mindahl.pc and the package's configuration name libiconv. Configured alone.
file(REMOVE_RECURSE ${SCRATCH})
file(MAKE_DIRECTORY ${SCRATCH}/own)
foreach(name md iconv)
  file(WRITE ${SCRATCH}/own/lib${name}.a "")
endforeach()
file(WRITE ${SCRATCH}/own/sha2.h "")
execute_process(
  COMMAND ${CMAKE_COMMAND} -S ${SOURCE_DIR} -B ${SCRATCH}/build -G Ninja -DCMAKE_CXX_COMPILER=${CXX}
          -DMINDAHL_BUILD_TESTS=OFF -DMINDAHL_BUILD_EXAMPLES=OFF -DMINDAHL_BUILD_PROGRAM=OFF
          -DIconv_IS_BUILT_IN=OFF -DIconv_LIBRARY=${SCRATCH}/own/libiconv.a
          -DLIBMD_LIBRARY=${SCRATCH}/own/libmd.a -DLIBMD_INCLUDE_DIR=${SCRATCH}/own
  OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)

file(READ ${SCRATCH}/build/build.ninja rules)
foreach(what "-I[^ ]*own|-isystem [^ ]*own" "build src/libmindahl[.]so[^\n]*(\n[^\n]+)*own/libmd[.]a"
        "build src/libmindahl[.]so[^\n]*(\n[^\n]+)*own/libiconv[.]a")
  if(NOT rules MATCHES "${what}")
    message(FATAL_ERROR "build.ninja has no ${what}")
  endif()
endforeach()
file(READ ${SCRATCH}/build/mindahl.pc text)
if(NOT text MATCHES "Libs.private:[^\n]* -liconv")
  message(FATAL_ERROR "mindahl.pc does not link libiconv: ${text}")
endif()
file(READ ${SCRATCH}/build/mindahlConfig.cmake text)
if(NOT text MATCHES "mindahl_io_needs \"[^\"]*Iconv")
  message(FATAL_ERROR "find_package(mindahl) does not look for libiconv")
endif()
