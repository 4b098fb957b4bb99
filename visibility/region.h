// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/interval.h"
#include "earshot/geometry/types.h"

namespace earshot::visibility {

/// The view space of a from-region query: an axis-aligned box where viewpoints may be, metres,
/// boundary included. It may be flat or a single point.
struct ViewRegion {
    geometry::Vec3 lower{};
    geometry::Vec3 upper{};

    bool contains(const geometry::Vec3& point) const noexcept {
        return point.x >= lower.x && point.y >= lower.y && point.z >= lower.z &&
               point.x <= upper.x && point.y <= upper.y && point.z <= upper.z;
    }
    geometry::Vec3 size() const noexcept { return upper - lower; }
    /// Cubic metres.
    double volume() const noexcept {
        const geometry::Vec3 edges = size();
        return edges.x * edges.y * edges.z;
    }
    friend bool operator==(const ViewRegion&, const ViewRegion&) = default;
};

/// Throws Error unless the corners are finite and in order and the volume is finite.
void validate(const ViewRegion& region);

/// Clips the line origin + s * step to a region, boundary included: the part of the interval
/// `within` of s that lies inside.
geometry::Interval clip(const geometry::Vec3& origin,
                        const geometry::Vec3& step,
                        const ViewRegion& region,
                        geometry::Interval within) noexcept;

/// Clips a segment to a region, as parameters from 0 at `from` to 1 at `to`.
inline geometry::Interval clip(const geometry::Segment& segment,
                               const ViewRegion& region) noexcept {
    return clip(segment.from, segment.to - segment.from, region, {0.0, 1.0});
}

}  // namespace earshot::visibility
