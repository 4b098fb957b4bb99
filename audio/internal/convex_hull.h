// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace earshot::audio {

/// The triangles of the convex hull of points on the unit sphere, counter-clockwise as seen from
/// outside (Barber, Dobkin, Huhdanpaa 1996). Where more than three points lie in one plane the
/// triangles between them are some of those possible, the same on every machine. Empty if all
/// points lie within `min_height` of one plane. Precondition: the points are at least 1e-3 apart.
std::vector<std::array<std::size_t, 3>> convex_hull(std::span<const std::array<double, 3>> points,
                                                    double min_height);

}  // namespace earshot::audio
