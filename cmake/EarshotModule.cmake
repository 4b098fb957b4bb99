# earshot_module(NAME SOURCES ... [USES ...] [PUBLIC_LIBS ...] [PRIVATE_LIBS ...])
#
# One folder = one static library earshot::NAME. Its headers are found as "earshot/NAME/x.h" through
# an include root of its own, which only targets that USE the module receive: an include against the
# order of dependencies does not compile (tests/layering proves it). Who links a module compiles
# without contraction of floating-point operations, as the module itself does: inline functions in
# headers must give the same bits (docs/determinism.md).
include(GNUInstallDirs)

function(earshot_module name)
  cmake_parse_arguments(ARG "" "" "SOURCES;USES;PUBLIC_LIBS;PRIVATE_LIBS" ${ARGN})
  set(facade ${PROJECT_BINARY_DIR}/include/${name})
  file(MAKE_DIRECTORY ${facade}/earshot)
  file(CREATE_LINK ${CMAKE_CURRENT_SOURCE_DIR} ${facade}/earshot/${name} SYMBOLIC)
  add_library(earshot_${name} STATIC ${ARG_SOURCES})
  add_library(earshot::${name} ALIAS earshot_${name})
  set_target_properties(earshot_${name} PROPERTIES EXPORT_NAME ${name} POSITION_INDEPENDENT_CODE ON)
  target_compile_features(earshot_${name} PUBLIC cxx_std_20)
  target_include_directories(earshot_${name} PUBLIC
    $<BUILD_INTERFACE:${facade}> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  target_compile_options(earshot_${name} INTERFACE $<$<COMPILE_LANGUAGE:CXX>:-ffp-contract=off>)
  list(TRANSFORM ARG_USES PREPEND earshot_)
  target_link_libraries(earshot_${name}
    PUBLIC ${ARG_USES} ${ARG_PUBLIC_LIBS} PRIVATE ${ARG_PRIVATE_LIBS})
  install(TARGETS earshot_${name} EXPORT earshot)
  set_property(GLOBAL APPEND PROPERTY EARSHOT_MODULES ${name})
  install(DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR}/
          DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/earshot/${name}
          FILES_MATCHING PATTERN "*.h" PATTERN "internal" EXCLUDE PATTERN "kernels" EXCLUDE
          PATTERN "simd" EXCLUDE PATTERN "*-inl.h" EXCLUDE)
endfunction()
