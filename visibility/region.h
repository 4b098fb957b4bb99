// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/types.h"

namespace earshot::visibility {

/// An axis-aligned box where viewers may be, metres, borders included.
struct Region {
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
    friend bool operator==(const Region&, const Region&) = default;
};

/// Throws Error unless the corners are finite and in order and the volume is finite.
void check(const Region& region);

/// The part of a line that lies in a region, as parameters: of a segment from 0 at `from` to 1 at
/// `to`.
struct Passage {
    double begin = 0.0;
    double end = 1.0;
    bool is_empty() const noexcept { return begin > end; }
};

/// Of a line, origin + s * step, the part of `within` that lies in a region, borders included.
Passage passage(const geometry::Vec3& origin,
                const geometry::Vec3& step,
                const Region& region,
                Passage within) noexcept;

/// The same of a segment.
inline Passage passage(const geometry::Segment& segment, const Region& region) noexcept {
    return passage(segment.from, segment.to - segment.from, region, {});
}

}  // namespace earshot::visibility
