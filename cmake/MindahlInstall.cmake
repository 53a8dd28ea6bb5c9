include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(library_modules mindahl_core mindahl_contact mindahl_loop mindahl_models
    mindahl_methods mindahl_tradeoff mindahl_convert mindahl_identification mindahl_io mindahl_report mindahl_request)
install(TARGETS ${library_modules} EXPORT mindahlTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(TARGETS mindahl RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
install(DIRECTORY include/mindahl DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} FILES_MATCHING PATTERN "*.h")

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/mindahl)
install(EXPORT mindahlTargets NAMESPACE mindahl:: DESTINATION ${package_dir})
configure_package_config_file(cmake/mindahlConfig.cmake.in
  ${PROJECT_BINARY_DIR}/mindahlConfig.cmake INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/mindahlConfigVersion.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/mindahlConfig.cmake
              ${PROJECT_BINARY_DIR}/mindahlConfigVersion.cmake DESTINATION ${package_dir})
