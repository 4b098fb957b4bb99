// SPDX-License-Identifier: MIT
#include "earshot/base/halton.h"

#include <algorithm>

namespace earshot {

namespace {

constexpr double kBelowOne = 1.0 - 0x1p-53;

}  // namespace

double radical_inverse(std::uint64_t index, std::uint32_t base) noexcept {
    const double step = 1.0 / base;
    double weight = step;
    double sum = 0.0;
    for (; index > 0; index /= base) {
        sum += static_cast<double>(index % base) * weight;
        weight *= step;
    }
    return std::min(sum, kBelowOne);
}

double shifted_radical_inverse(std::uint64_t index, std::uint32_t base, double shift) noexcept {
    const double sum = radical_inverse(index, base) + shift;
    return sum < 1.0 ? sum : sum - 1.0;
}

}  // namespace earshot
