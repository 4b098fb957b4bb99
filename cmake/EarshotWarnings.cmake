# One set of flags for every target. The floating-point flags are part of the promise that results do
# not depend on the machine (docs/determinism.md): no contraction to fused multiply-add, no fast-math.
option(EARSHOT_WARNINGS_AS_ERRORS "Treat warnings as errors" OFF)

add_compile_options(
  -ffp-contract=off -fno-math-errno
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wnon-virtual-dtor -Woverloaded-virtual)
if(EARSHOT_WARNINGS_AS_ERRORS)
  add_compile_options(-Werror)
endif()
