// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/error.h"
#include "earshot/geometry/types.h"

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <iterator>
#include <vector>

namespace earshot {

// Of a curve of what was found (a member of its points) against rays.

template <typename Point>
std::uint64_t found_after(const std::vector<Point>& curve,
                          std::uint64_t Point::*found,
                          std::uint64_t rays) {
    const auto after = std::upper_bound(
        curve.begin(), curve.end(), rays, [](std::uint64_t value, const Point& point) {
            return value < point.rays;
        });
    return after == curve.begin() ? 0 : (*std::prev(after)).*found;
}

/// 0 if never.
template <typename Point>
std::uint64_t rays_until(const std::vector<Point>& curve,
                         std::uint64_t Point::*found,
                         std::uint64_t count) {
    const auto place = std::find_if(
        curve.begin(), curve.end(), [&](const Point& point) { return point.*found >= count; });
    return place == curve.end() ? 0 : place->rays;
}

/// Throws Error unless the text is X,Y,Z.
inline geometry::Vec3 point_of(const char* text) {
    geometry::Vec3 point;
    if (std::sscanf(text, "%lf,%lf,%lf", &point.x, &point.y, &point.z) != 3) {
        throw Error(text, "is not of the form X,Y,Z", "give metres");
    }
    return point;
}

}  // namespace earshot
