// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/scenes/shapes.h"

#include <vector>

namespace earshot::scenes {

/// How a prism's edges are rounded and its faces divided.
struct Rounding {
    int pieces = 6;            ///< of the arc at each corner of the profile; of the ends half
    double radius = 0.008;     ///< of these arcs, metres; of the ends half
    double max_length = 0.15;  ///< of the pieces of straight edges, metres
};

/// A closed prism as prism() makes it, whose profile's corners and whose ends are rounded.
/// Preconditions: the arcs of neighbouring corners do not overlap; length > radius.
Faces rounded_prism(const std::vector<Vec2>& profile,
                    double length,
                    const Frame& frame,
                    std::size_t material,
                    const Rounding& rounding);

}  // namespace earshot::scenes
