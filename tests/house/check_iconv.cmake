cmake_minimum_required(VERSION 3.25)
# Where the C library has no iconv, as on macOS, libiconv is linked to the shared library, and mindahl.pc
# and the package's configuration name it. Configured alone.
file(REMOVE_RECURSE ${SCRATCH})
file(MAKE_DIRECTORY ${SCRATCH}/own)
file(WRITE ${SCRATCH}/own/libiconv.a "")
execute_process(
  COMMAND ${CMAKE_COMMAND} -S ${SOURCE_DIR} -B ${SCRATCH}/build -G Ninja -DCMAKE_CXX_COMPILER=${CXX}
          -DMINDAHL_BUILD_TESTS=OFF -DMINDAHL_BUILD_EXAMPLES=OFF -DMINDAHL_BUILD_PROGRAM=OFF
          -DIconv_IS_BUILT_IN=OFF -DIconv_LIBRARY=${SCRATCH}/own/libiconv.a
  OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)

file(READ ${SCRATCH}/build/build.ninja rules)
if(NOT rules MATCHES "build src/libmindahl[.]so[^\n]*(\n[^\n]+)*own/libiconv[.]a")
  message(FATAL_ERROR "build.ninja does not link libiconv to the shared library")
endif()
file(READ ${SCRATCH}/build/mindahl.pc text)
if(NOT text MATCHES "Libs.private:[^\n]* -liconv")
  message(FATAL_ERROR "mindahl.pc does not link libiconv: ${text}")
endif()
file(READ ${SCRATCH}/build/mindahlConfig.cmake text)
if(NOT text MATCHES "mindahl_io_needs \"[^\"]*Iconv")
  message(FATAL_ERROR "find_package(mindahl) does not look for libiconv")
endif()
