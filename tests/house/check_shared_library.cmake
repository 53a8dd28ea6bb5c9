cmake_minimum_required(VERSION 3.25)
# Builds users of the shared library against it and the public headers alone, without what it links,
# and looks for what it should hide.
file(REMOVE_RECURSE ${SCRATCH})
file(MAKE_DIRECTORY ${SCRATCH})
set(sanitizer "")
if(SANITIZE)
  set(sanitizer -fsanitize=address,undefined)
endif()
cmake_path(GET LIBRARY PARENT_PATH folder)
foreach(user fit_to_json cycles_of_stream)
  execute_process(COMMAND ${CXX} -std=c++20 ${sanitizer} -I${SOURCE_DIR}/include
                          ${SOURCE_DIR}/examples/${user}.cc ${LIBRARY} -Wl,-rpath,${folder}
                          -o ${SCRATCH}/${user} COMMAND_ERROR_IS_FATAL ANY)
endforeach()
execute_process(COMMAND ${SCRATCH}/fit_to_json ${SOURCE_DIR}/data/mindlin_sphere_on_plane.csv 50
                OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${SCRATCH}/cycles_of_stream COMMAND_ERROR_IS_FATAL ANY)

execute_process(COMMAND ${NM} --dynamic --defined-only --demangle ${LIBRARY} OUTPUT_VARIABLE symbols
                COMMAND_ERROR_IS_FATAL ANY)
string(FIND "${symbols}" " mindahl::identification::Fitter::Fit(" at)
if(at LESS 0)
  message(FATAL_ERROR "nm does not show what the library has")
endif()
# A function of each folder of src/ that has headers of its own.
foreach(hidden IsTerminal io::ForMessage identification::Problem
        identification::FindStartsOf report::ToSentence)
  string(REGEX MATCH "[^\n]* [TVWu] mindahl::${hidden}[^A-Za-z_][^\n]*" found "${symbols}")
  if(found)
    message(FATAL_ERROR "the shared library exports what is its own: ${found}")
  endif()
endforeach()
