// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/floating_point.h"

#include <string>
#include <string_view>
#include <vector>

namespace earshot {

// Wide kernels are compiled once per instruction set and chosen when the program runs. They cull
// conservatively, decide what is certain, or do the same operations on every number at any width
// (docs/determinism.md), so the choice changes speed and nothing else.

/// Names of the instruction sets that this CPU and this build have, best first: "avx512_dl",
/// "avx512", "avx2", "sse4", "ssse3", and always "scalar" at the end.
std::vector<std::string> simd_targets();

/// A hook for tests and benchmarks, and for the option --simd: overrides the choice of the named
/// set for all kernels of the process from now on; "auto" restores the best one. Not to be called
/// while kernels run. Throws Error if the name is not one of simd_targets().
void override_simd_target(std::string_view name);

}  // namespace earshot
