# `docs_api`: the documentation of the public headers, as the Doxyfile says, in build/…/api/html.
find_package(Doxygen 1.9 QUIET)
if(NOT DOXYGEN_FOUND)
  return()
endif()
set(command ${CMAKE_COMMAND} -E env MINDAHL_API=${PROJECT_BINARY_DIR}/api
  $<TARGET_FILE:Doxygen::doxygen>)
add_custom_target(docs_api COMMAND ${command} WORKING_DIRECTORY ${PROJECT_SOURCE_DIR}
  COMMENT "Documenting the public headers")
if(MINDAHL_BUILD_TESTS)
  add_test(NAME docs/api COMMAND ${command} WORKING_DIRECTORY ${PROJECT_SOURCE_DIR})
endif()
