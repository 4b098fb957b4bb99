// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/types.h"
#include "earshot/propagation/pair_result.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <vector>

namespace earshot::io {

/// A first-order reflection: where, and how much later than the direct sound it arrives.
struct FirstReflection {
    geometry::Vec3 point{0.0};
    double excess = std::numeric_limits<double>::infinity();  ///< of length, metres
    double delay = 0.0;                                       ///< the same in seconds
};

/// A surface and its earliest reflection at each instant, of any pair; empty where it has none.
struct FirstReflector {
    std::uint32_t patch = 0;     ///< of FeatureEdges
    std::uint32_t material = 0;  ///< index into Scene::materials
    std::vector<std::optional<FirstReflection>> reflections{};
};

/// The patches of the first-order reflections that follow the direct sound soonest over all
/// instants, in that order, of equal ones by number; at most `max_count`. Materials that
/// `leave_out` holds for do not count.
std::vector<FirstReflector> first_reflectors(
    std::span<const propagation::PairResult> pairs,
    std::span<const double> times,
    std::span<const std::uint32_t> patch_of_triangle,
    std::size_t max_count,
    const std::function<bool(std::uint32_t material)>& leave_out);

}  // namespace earshot::io
