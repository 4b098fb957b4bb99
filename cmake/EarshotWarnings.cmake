# One set of flags for every target. The floating-point flags are part of the promise that results do
# not depend on the machine (docs/determinism.md): no contraction to fused multiply-add, no fast-math.
option(EARSHOT_WARNINGS_AS_ERRORS "Treat warnings as errors" OFF)

add_compile_options(
  -ffp-contract=off -fno-math-errno
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion
  $<$<COMPILE_LANGUAGE:CXX>:-Wnon-virtual-dtor> $<$<COMPILE_LANGUAGE:CXX>:-Woverloaded-virtual>)
# gcc 12 takes the joining of strings for overlapping copies when it optimises fully (its bug 105651).
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  add_compile_options(-Wno-restrict)
endif()
# Comparisons of boxes are joined by & on purpose: one branch for six of them.
if(CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
  add_compile_options(-Wno-bitwise-instead-of-logical)
endif()
if(EARSHOT_WARNINGS_AS_ERRORS)
  add_compile_options(-Werror)
endif()
