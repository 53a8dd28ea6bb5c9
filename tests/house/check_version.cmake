cmake_minimum_required(VERSION 3.25)
# Files that cannot read CMakeLists.txt state its version, and no other.
foreach(line "CITATION.cff|version: ${VERSION}\n" "codemeta.json|\"version\": \"${VERSION}\""
        "CHANGELOG.md|## ${VERSION} ")
  string(REGEX MATCH "^([^|]*)[|](.*)$" whole "${line}")
  file(READ ${SOURCE_DIR}/${CMAKE_MATCH_1} text)
  string(FIND "${text}" "${CMAKE_MATCH_2}" at)
  if(at LESS 0)
    message(FATAL_ERROR "${CMAKE_MATCH_1} has not '${CMAKE_MATCH_2}'")
  endif()
endforeach()

# What runs where the project is published is what runs here.
file(STRINGS ${SOURCE_DIR}/.github/workflows/ci.yml run REGEX "- run: bash [.]ci/run$")
if(NOT run)
  message(FATAL_ERROR ".github/workflows/ci.yml does not run .ci/run")
endif()

file(STRINGS ${SOURCE_DIR}/src/io/plot.cc started REGEX "rsvg-convert")
file(READ ${SOURCE_DIR}/SECURITY.md page)
string(FIND "${page}" "starts rsvg-convert alone" at)
if(NOT started OR at LESS 0)
  message(FATAL_ERROR "SECURITY.md does not say which program is started")
endif()
