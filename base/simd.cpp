// SPDX-License-Identifier: MIT
#include "earshot/base/simd.h"

#include "earshot/base/error.h"

#include <hwy/targets.h>

#include <array>
#include <cstdint>

namespace earshot {
namespace {

struct NamedTarget {
    std::string_view name;
    std::int64_t bit;
};

constexpr std::array<NamedTarget, 5> kTargets = {{{"avx512_dl", HWY_AVX3_DL},
                                                  {"avx512", HWY_AVX3},
                                                  {"avx2", HWY_AVX2},
                                                  {"sse4", HWY_SSE4},
                                                  {"ssse3", HWY_SSSE3}}};

constexpr std::string_view kScalar = "scalar";

/// Dispatches every kernel of the process to the given targets from now on; 0: to those of the CPU.
/// Highway offers no other means than this hook for its own tests: it sets variables of the process
/// without a lock, which is why override_simd_target() is not for use beside running kernels.
void override_dispatch(std::int64_t targets) {
    hwy::SetSupportedTargetsForTest(targets);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

}  // namespace

std::vector<std::string> simd_targets() {
    static const std::int64_t of_cpu = hwy::SupportedTargets();
    std::vector<std::string> names;
    for (const NamedTarget& target : kTargets) {
        if ((of_cpu & target.bit) != 0) {
            names.emplace_back(target.name);
        }
    }
    names.emplace_back(kScalar);
    return names;
}

void override_simd_target(std::string_view name) {
    std::string known = "auto";
    for (const std::string& target : simd_targets()) {
        known += ", " + target;
        if (target != name) {
            continue;
        }
        std::int64_t bits = HWY_EMU128;
        for (const NamedTarget& candidate : kTargets) {
            bits = candidate.name == name ? candidate.bit : bits;
        }
        override_dispatch(bits);
        return;
    }
    if (name != "auto") {
        throw Error(
            std::string(name), "is no instruction set of this machine", "use one of " + known);
    }
    override_dispatch(0);
}

}  // namespace earshot
