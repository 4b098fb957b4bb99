# Compiles through ccache where it is installed: every part of a build whose sources and flags are the same as in an
# earlier one, also of another clone, is taken from its cache. Whoever sets CMAKE_CXX_COMPILER_LAUNCHER has another way.
include_guard()
option(EARSHOT_COMPILER_CACHE "Compile through ccache where it is installed" ${PROJECT_IS_TOP_LEVEL})
find_program(EARSHOT_CCACHE ccache)
if(EARSHOT_COMPILER_CACHE AND EARSHOT_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  # Paths count relative to the build, else no other clone would find them.
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env
    CCACHE_BASEDIR=${PROJECT_SOURCE_DIR} CCACHE_NOHASHDIR=1 ${EARSHOT_CCACHE})
endif()
