# Install and export: an outside project says find_package(earshot) and links earshot::bvh, or
# earshot::earshot for everything, or in C earshot::capi; others ask pkg-config for `earshot` or
# `earshot-c`. Include this last, when every module has been declared.
include(CMakePackageConfigHelpers)
get_property(modules GLOBAL PROPERTY EARSHOT_MODULES)

list(TRANSFORM modules PREPEND earshot_ OUTPUT_VARIABLE targets)

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/earshot)
install(EXPORT earshot NAMESPACE earshot:: FILE earshot-targets.cmake DESTINATION ${package_dir})
configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/earshot-config.cmake.in
  ${PROJECT_BINARY_DIR}/earshot-config.cmake INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/earshot-config-version.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/earshot-config.cmake
              ${PROJECT_BINARY_DIR}/earshot-config-version.cmake
        DESTINATION ${package_dir})

# earshot.pc: the facade and the modules from the top down, as linkers want static libraries, and what they link:
# packages that pkg-config knows, and libraries that it does not.
set(EARSHOT_PC_LIBS)
set(EARSHOT_PC_REQUIRES)
foreach(module IN LISTS modules ITEMS everything)
  string(PREPEND EARSHOT_PC_LIBS "-learshot_${module} ")
endforeach()
foreach(target IN LISTS targets)
  get_target_property(libraries ${target} LINK_LIBRARIES)
  foreach(library IN LISTS libraries)
    if(library MATCHES "^PkgConfig::(.+)$")
      string(TOLOWER ${CMAKE_MATCH_1} package)
      list(APPEND EARSHOT_PC_REQUIRES ${package})
    elseif(library STREQUAL "hwy::hwy")
      list(APPEND EARSHOT_PC_REQUIRES libhwy)
    elseif(library STREQUAL "TBB::tbb")
      list(APPEND EARSHOT_PC_REQUIRES tbb)
    elseif(library MATCHES "^TinyGLTF::")
      string(APPEND EARSHOT_PC_LIBS "-ltinygltf ")
    elseif(library MATCHES "^(draco|meshoptimizer)::")
      string(APPEND EARSHOT_PC_LIBS "-l${CMAKE_MATCH_1} ")
    elseif(library MATCHES "^[A-Za-z0-9_]+$" AND NOT library MATCHES "^earshot_")
      string(APPEND EARSHOT_PC_LIBS "-l${library} ")
    elseif(NOT library MATCHES "^(earshot_.*|glm::glm|Boost::headers|nlohmann_json::nlohmann_json)$")
      message(FATAL_ERROR "earshot.pc: say in EarshotInstall.cmake what ${library} is to pkg-config")
    endif()
  endforeach()
endforeach()
list(REMOVE_DUPLICATES EARSHOT_PC_REQUIRES)
list(JOIN EARSHOT_PC_REQUIRES " " EARSHOT_PC_REQUIRES)
set(pkgconfig_dir ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
cmake_path(IS_ABSOLUTE CMAKE_INSTALL_LIBDIR is_absolute)
if(is_absolute)
  set(EARSHOT_PC_PREFIX ${CMAKE_INSTALL_PREFIX})
else()
  # Found from the file's own place, so that the installed tree can be moved.
  file(RELATIVE_PATH up /${pkgconfig_dir} /)
  string(REGEX REPLACE "/$" "" up "${up}")
  set(EARSHOT_PC_PREFIX "\${pcfiledir}/${up}")
endif()
foreach(file IN ITEMS earshot.pc earshot-c.pc)
  configure_file(${PROJECT_SOURCE_DIR}/cmake/${file}.in ${PROJECT_BINARY_DIR}/${file} @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/${file} DESTINATION ${pkgconfig_dir})
endforeach()
