// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/facets.h"

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

namespace earshot::frustum {

class BoxArrivals;

/// A path without its points and triangles: what a response needs of it.
struct PathArrival {
    std::size_t order = 0;                        ///< reflections
    geometry::Vec3 last_point{0.0};               ///< the source's or of the last reflection
    std::span<const geometry::FacetId> facets{};  ///< that reflect, source first; valid until the
                                                  ///< next one is asked for
};

/// The paths of one pair in a box, in the order of PathFinder::find(), told one at a time from the
/// lattice of images: in less time and memory than with their points.
class PathArrivals {
public:
    explicit PathArrivals(std::unique_ptr<BoxArrivals> arrivals);
    PathArrivals(PathArrivals&&) noexcept;
    PathArrivals& operator=(PathArrivals&&) noexcept;
    ~PathArrivals();

    /// Metres, ascending: one per path, SpecularPath::length to the bit.
    std::span<const double> lengths() const noexcept;
    /// The path of lengths()[i]. Without `name_facets` the facets stay empty, which saves time.
    PathArrival at(std::size_t i, bool name_facets);

private:
    std::unique_ptr<BoxArrivals> arrivals_;
};

}  // namespace earshot::frustum
