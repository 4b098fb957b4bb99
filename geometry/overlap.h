// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/aabb.h"
#include "earshot/geometry/closest_point.h"
#include "earshot/geometry/facets.h"
#include "earshot/geometry/types.h"

#include <array>
#include <concepts>
#include <cstddef>
#include <span>
#include <vector>

namespace earshot::geometry {

/// A closed part of space that triangles may share points with; contact counts. may_touch() is
/// false only if touches() is for every triangle whose vertices lie in the box. Triangles without
/// area are segments or points.
template <class T>
concept OverlapRegion = requires(const T& region, const Aabb& box, const Vec3& a) {
    { region.may_touch(box) } -> std::same_as<bool>;
    { region.touches(a, a, a) } -> std::same_as<bool>;
};

/// A box with sides along the axes, decided exactly. Bounds may be infinite; a box whose lower
/// bound is above its upper one, or not a number, touches nothing. For magnitudes see orient3d().
class BoxRegion {
public:
    BoxRegion(const Vec3& lower, const Vec3& upper) noexcept : lower_(lower), upper_(upper) {}

    bool may_touch(const Aabb& box) const noexcept;
    bool touches(const Vec3& a, const Vec3& b, const Vec3& c) const noexcept;

private:
    Vec3 lower_, upper_;
};

/// A ball: what PreparedPoint finds at `radius` metres or nearer. A centre that is not finite and a
/// radius that is negative or not a number touch nothing.
class SphereRegion {
public:
    SphereRegion(const Vec3& centre, double radius) noexcept
        : centre_(centre), radius_(radius), squared_bound_(PreparedPoint::squared_bound(radius)) {}

    bool may_touch(const Aabb& box) const noexcept {
        return centre_.squared_distance(box) <= squared_bound_;
    }
    bool touches(const Vec3& a, const Vec3& b, const Vec3& c) const noexcept {
        return centre_.is_valid() && centre_.closest_point(a, b, c, radius_).has_value();
    }

private:
    PreparedPoint centre_;
    double radius_;
    double squared_bound_;
};

/// What lies on or behind every one of some planes, such as a frustum. A triangle whose vertices
/// all lie before one plane does not touch; otherwise it is clipped by the planes in turn and
/// touches if anything is left, so that contacts within a rounding of the coordinates may go either
/// way. Normals need not have unit length.
class ConvexRegion {
public:
    static constexpr std::size_t kMaxPlanes = 32;

    /// Without planes it is all of space; with one that is not finite it touches nothing. Throws
    /// Error for more than kMaxPlanes.
    explicit ConvexRegion(std::span<const Plane> planes);

    bool may_touch(const Aabb& box) const noexcept;
    bool touches(const Vec3& a, const Vec3& b, const Vec3& c) const noexcept;

private:
    std::vector<Plane> planes_;
    bool is_valid_ = true;
};

/// A triangle, decided exactly, coplanar cases included. One with a coordinate that is not finite
/// touches nothing. For magnitudes see orient3d().
class TriangleRegion {
public:
    TriangleRegion(const Vec3& a, const Vec3& b, const Vec3& c) noexcept;

    bool may_touch(const Aabb& box) const noexcept;
    bool touches(const Vec3& a, const Vec3& b, const Vec3& c) const noexcept;

private:
    std::array<Vec3, 3> corners_;
    Vec3 lower_, upper_;  // not numbers if a coordinate is not finite
    bool has_area_ = false;
};

}  // namespace earshot::geometry
