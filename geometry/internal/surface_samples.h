// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/floating_point.h"
#include "earshot/geometry/mesh.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace earshot::geometry {

/// The squared distance of a point from a triangle, or from a segment where two corners are equal.
double squared_distance(const Vec3& point, const Corners& triangle) noexcept;

/// Points of a surface that is being simplified. Each stands in the list of the element (triangle
/// or piece of a border) that replaces its neighbourhood (Klein, Liebich and Strasser 1996). Where
/// an operation removes elements and makes others, their points must be close to what is made.
class SurfaceSamples {
public:
    using Element = std::uint32_t;

    /// What an operation makes: an element that exists already and takes this form.
    struct Made {
        Element element = 0;
        Corners corners;
    };

    /// What fits() has found, for move().
    using Moves = std::vector<std::pair<std::uint32_t, Element>>;

    /// Of elements 0 ... labels.size() - 1. Points stay with elements of one label.
    explicit SurfaceSamples(std::vector<std::uint32_t> labels);

    void add(Element element, const Vec3& point);

    /// Whether all points of the removed elements lie within `max_distance` of a made element of
    /// their label; then `moves` tells the closest one of each.
    bool fits(std::span<const Element> removed,
              std::span<const Made> made,
              double max_distance,
              Moves& moves) const;

    /// Calls visit(point) for the numbers of the points of an element, which add() has counted from
    /// 0.
    template <typename Visit>
    void for_each(Element element, Visit&& visit) const {
        for (std::uint32_t i = first_[element]; i != kNone; i = next_[i]) {
            visit(i);
        }
    }

    /// Hands the points on. Precondition: what fits() has found for these elements.
    void move(std::span<const Element> removed, const Moves& moves);

private:
    static constexpr std::uint32_t kNone = 0xffffffffU;

    std::vector<std::uint32_t> labels_;
    std::vector<std::uint32_t> first_;  // per element
    std::vector<std::uint32_t> next_;   // per point
    std::vector<Vec3> points_;
};

}  // namespace earshot::geometry
