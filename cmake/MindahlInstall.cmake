# Two components: `tool`, the program with its manual pages, and `development`, the
# library. Every module but the command line is installed: static libraries, or all as a shared one.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

get_property(modules GLOBAL PROPERTY MINDAHL_MODULES)
list(REMOVE_ITEM modules cli)
list(TRANSFORM modules PREPEND mindahl_ OUTPUT_VARIABLE library_targets)

if(MINDAHL_BUILD_PROGRAM)
  install(TARGETS mindahl RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT tool)
endif()
if(BUILD_SHARED_LIBS)
  set(library_targets mindahl_shared)
endif()
install(TARGETS ${library_targets} EXPORT mindahlTargets COMPONENT development)
install(DIRECTORY include/mindahl DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT development
        FILES_MATCHING PATTERN "*.h")
install(DIRECTORY docs/schema DESTINATION ${CMAKE_INSTALL_DATADIR}/mindahl COMPONENT development)

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/mindahl)
install(EXPORT mindahlTargets NAMESPACE mindahl:: DESTINATION ${package_dir} COMPONENT development)
# What find_package() must find for each module to be linked.
set(module_needs "")
if(NOT BUILD_SHARED_LIBS)
  foreach(module IN LISTS modules)
    get_property(needs GLOBAL PROPERTY MINDAHL_NEEDS_${module})
    list(FILTER needs INCLUDE REGEX "::")
    list(TRANSFORM needs REPLACE "::.*" "")
    string(APPEND module_needs "set(mindahl_${module}_needs \"${needs}\")\n")
  endforeach()
endif()
configure_package_config_file(cmake/mindahlConfig.cmake.in
  ${PROJECT_BINARY_DIR}/mindahlConfig.cmake INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/mindahlConfigVersion.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/mindahlConfig.cmake
              ${PROJECT_BINARY_DIR}/mindahlConfigVersion.cmake
        DESTINATION ${package_dir} COMPONENT development)

# What the library links of others: how pkg-config finds it, and the Debian package that has it.
set(Ceres__ceres_pc Libs "-lceres -lglog -lgflags")
set(Ceres__ceres_package libceres-dev)
set(fmt__fmt_pc Requires fmt)
set(fmt__fmt_package libfmt-dev)
set(ZLIB__ZLIB_pc Requires zlib)
set(ZLIB__ZLIB_package zlib1g-dev)
set(Iconv__Iconv_pc Libs -liconv)
set(Threads__Threads_pc Libs -pthread)
set(Threads__Threads_package "")
set(linked "")
foreach(module IN LISTS modules)
  get_property(needs GLOBAL PROPERTY MINDAHL_NEEDS_${module})
  list(APPEND linked ${needs})
endforeach()
list(REMOVE_DUPLICATES linked)
set(pc_Requires "")
set(pc_Libs "")
set(linked_packages "")
foreach(library IN LISTS linked)
  string(MAKE_C_IDENTIFIER ${library} id)
  if(NOT DEFINED ${id}_pc)
    message(FATAL_ERROR "the library links ${library}: say here how its users find it")
  endif()
  list(GET ${id}_pc 0 kind)
  list(GET ${id}_pc 1 value)
  string(APPEND pc_${kind} " ${value}")
  list(APPEND linked_packages ${${id}_package})
endforeach()

# Modules are added after those that they use; a static linker wants them the other way round.
set(link_order ${modules})
list(REVERSE link_order)
list(TRANSFORM link_order PREPEND -lmindahl_)
list(JOIN link_order " " module_libraries)
if(BUILD_SHARED_LIBS)
  set(module_libraries -lmindahl)
  set(pc_Requires "")
  set(pc_Libs "")
endif()
file(RELATIVE_PATH prefix_from_pc /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
string(REGEX REPLACE "/$" "" prefix_from_pc "${prefix_from_pc}")
configure_file(cmake/mindahl.pc.in ${PROJECT_BINARY_DIR}/mindahl.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/mindahl.pc
        DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT development)

# The manual pages, one a command, are made by help2man from the help of a program that runs here.
find_program(HELP2MAN help2man)
if(MINDAHL_BUILD_PROGRAM AND HELP2MAN AND NOT CMAKE_CROSSCOMPILING)
  set(pages "")
  foreach(command "" fit simulate validate contact convert tradeoff plan track batch)
    set(name mindahl)
    set(help --help)
    if(command)
      set(name mindahl-${command})
      set(help "${command} --help-all")
    endif()
    set(page ${PROJECT_BINARY_DIR}/manual/${name}.1)
    add_custom_command(OUTPUT ${page}
      COMMAND ${CMAKE_COMMAND} -E make_directory ${PROJECT_BINARY_DIR}/manual
      COMMAND ${HELP2MAN} --no-info --help-option=${help} --version-string=${PROJECT_VERSION}
              "--name=${PROJECT_DESCRIPTION}" --output=${page} $<TARGET_FILE:mindahl>
      DEPENDS mindahl VERBATIM)
    list(APPEND pages ${page})
  endforeach()
  add_custom_target(manual ALL DEPENDS ${pages})
  install(FILES ${pages} DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT tool)
endif()

# The licence and what has changed, as every Debian package has them.
execute_process(COMMAND gzip -9nc ${PROJECT_SOURCE_DIR}/CHANGELOG.md
  OUTPUT_FILE ${PROJECT_BINARY_DIR}/changelog.gz COMMAND_ERROR_IS_FATAL ANY)
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/CHANGELOG.md)
function(install_papers component package)
  set(directory ${CMAKE_INSTALL_DATADIR}/doc/${package})
  install(FILES ${PROJECT_SOURCE_DIR}/LICENSE RENAME copyright DESTINATION ${directory}
          COMPONENT ${component})
  install(FILES ${PROJECT_BINARY_DIR}/changelog.gz DESTINATION ${directory} COMPONENT ${component})
endfunction()
install_papers(tool mindahl)
install_papers(development libmindahl-dev)
get_cmake_property(installed COMPONENTS)
if(python IN_LIST installed)
  install_papers(python python3-mindahl)
endif()
