# Install and export: an outside project says find_package(earshot) and links earshot::bvh, or
# earshot::earshot for everything. Include this last, when every module has been declared.
include(CMakePackageConfigHelpers)

add_library(earshot_everything INTERFACE)
add_library(earshot::earshot ALIAS earshot_everything)
set_target_properties(earshot_everything PROPERTIES EXPORT_NAME earshot)
foreach(module base geometry bvh collision visibility frustum audio propagation io)
  if(TARGET earshot_${module})
    target_link_libraries(earshot_everything INTERFACE earshot_${module})
  endif()
endforeach()
install(TARGETS earshot_everything EXPORT earshot)

install(EXPORT earshot NAMESPACE earshot:: FILE earshot-targets.cmake DESTINATION lib/cmake/earshot)
configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/earshot-config.cmake.in
  ${PROJECT_BINARY_DIR}/earshot-config.cmake INSTALL_DESTINATION lib/cmake/earshot)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/earshot-config-version.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/earshot-config.cmake
              ${PROJECT_BINARY_DIR}/earshot-config-version.cmake
        DESTINATION lib/cmake/earshot)
