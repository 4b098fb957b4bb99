# Install and export: an outside project says find_package(earshot) and links earshot::bvh, or
# earshot::earshot for everything. Include this last, when every module has been declared.
include(CMakePackageConfigHelpers)

install(EXPORT earshot NAMESPACE earshot:: FILE earshot-targets.cmake DESTINATION lib/cmake/earshot)
configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/earshot-config.cmake.in
  ${PROJECT_BINARY_DIR}/earshot-config.cmake INSTALL_DESTINATION lib/cmake/earshot)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/earshot-config-version.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/earshot-config.cmake
              ${PROJECT_BINARY_DIR}/earshot-config-version.cmake
        DESTINATION lib/cmake/earshot)
