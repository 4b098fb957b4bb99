// SPDX-License-Identifier: MIT
#include "earshot/frustum/internal/box_room.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace earshot::frustum {

using geometry::Facet;
using geometry::FacetId;
using geometry::Vec3;

namespace {

/// Largest BoxRoom::tilt. What rounding in files does to a box is far below this, and what a room
/// that is no box has is far above.
constexpr double kMaxTilt = 0x1p-14;
/// Largest BoxRoom::error, as a share of the largest coordinate; chosen likewise.
constexpr double kMaxError = 0x1p-16;
/// Thinner boxes, as a share of the largest coordinate, are left to frusta.
constexpr double kMinSize = 0x1p-7;

constexpr std::size_t kWalls = 6;

bool may_be_box(const SceneView& scene) {
    const auto& facets = scene.facets.facets;
    const auto has_four_corners = [](const Facet& facet) {
        return facet.loops.size() == 1 && facet.loops.front().size() == 4;
    };
    return facets.size() == kWalls && std::all_of(facets.begin(), facets.end(), has_four_corners) &&
           std::all_of(scene.transmissive.begin(),
                       scene.transmissive.end(),
                       [](std::uint8_t is_transmissive) { return is_transmissive == 0; });
}

/// The first wall's normal, that of the first wall across from it made perpendicular, and the
/// normal to both.
std::optional<std::array<Vec3, 3>> find_axes(std::span<const Facet> facets) {
    const Vec3& first = facets.front().plane.normal;
    for (const Facet& facet : facets) {
        const Vec3& normal = facet.plane.normal;
        const double cosine = glm::dot(normal, first);
        if (std::abs(cosine) <= kMaxTilt) {
            const Vec3 second = glm::normalize(normal - cosine * first);
            return std::array<Vec3, 3>{first, second, glm::cross(first, second)};
        }
    }
    return std::nullopt;
}

double mean_position(const Facet& facet, const Vec3& axis) {
    double sum = 0.0;
    for (const Vec3& corner : facet.loops.front()) {
        sum += glm::dot(axis, corner);
    }
    return sum / static_cast<double>(facet.loops.front().size());
}

/// Sorts the walls by axis and side. False: they are not two of each axis.
bool place_walls(BoxRoom& room, std::span<const Facet> facets) {
    std::array<std::size_t, 3> count{};
    for (std::size_t i = 0; i < facets.size(); ++i) {
        std::size_t axis = 0;
        while (axis < 3 && std::abs(glm::dot(facets[i].plane.normal, room.axes[axis])) < 0.5) {
            ++axis;
        }
        if (axis == 3 || count[axis] == 2) {
            return false;
        }
        room.walls[axis][count[axis]++] = static_cast<FacetId>(i);
    }
    for (std::size_t axis = 0; axis < 3; ++axis) {
        auto& [low, high] = room.walls[axis];
        room.low[axis] = mean_position(facets[low], room.axes[axis]);
        room.high[axis] = mean_position(facets[high], room.axes[axis]);
        if (room.low[axis] > room.high[axis]) {
            std::swap(low, high);
            std::swap(room.low[axis], room.high[axis]);
        }
    }
    return true;
}

/// How far the corner of a wall lies from the corner of the box next to it, and which that is: one
/// bit per axis.
struct Corner {
    double error = 0.0;
    unsigned side = 0;
};

Corner closest_corner(const BoxRoom& room, const Vec3& point) {
    Corner corner;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const double position = glm::dot(room.axes[axis], point);
        const bool is_high = position > 0.5 * (room.low[axis] + room.high[axis]);
        corner.side |= (is_high ? 1U : 0U) << axis;
        corner.error += std::abs(position - (is_high ? room.high : room.low)[axis]);
    }
    return corner;
}

/// Measures how far a wall lies off the ideal one. False: it has other corners.
bool measure(BoxRoom& room, const Facet& facet, std::size_t axis, bool is_high) {
    unsigned corners = 0;
    for (const Vec3& point : facet.loops.front()) {
        const Corner corner = closest_corner(room, point);
        if (((corner.side >> axis) & 1U) != (is_high ? 1U : 0U)) {
            return false;
        }
        corners |= 1U << corner.side;
        room.error = std::max(room.error, corner.error);
    }
    for (unsigned side = 0; side < 8; ++side) {
        if (((side >> axis) & 1U) != (is_high ? 1U : 0U)) {
            continue;
        }
        if (((corners >> side) & 1U) == 0) {
            return false;
        }
        Vec3 ideal(0.0);
        for (std::size_t k = 0; k < 3; ++k) {
            ideal += (((side >> k) & 1U) != 0 ? room.high : room.low)[k] * room.axes[k];
        }
        room.error = std::max(room.error, std::abs(facet.plane.distance(ideal)));
    }
    const Vec3& normal = facet.plane.normal;
    const double side = glm::dot(normal, room.axes[axis]) > 0.0 ? 1.0 : -1.0;
    room.tilt = std::max(room.tilt, glm::length(normal - side * room.axes[axis]));
    room.error = std::max(room.error, facet.deviation);
    return true;
}

}  // namespace

bool BoxRoom::is_straight() const noexcept {
    return tilt == 0.0 && std::all_of(axes.begin(), axes.end(), [](const Vec3& axis) {
               return (axis.x != 0.0 ? 1 : 0) + (axis.y != 0.0 ? 1 : 0) + (axis.z != 0.0 ? 1 : 0) ==
                      1;
           });
}

std::array<double, 3> BoxRoom::local(const Vec3& point) const noexcept {
    return {glm::dot(axes[0], point) - low[0],
            glm::dot(axes[1], point) - low[1],
            glm::dot(axes[2], point) - low[2]};
}

std::optional<BoxRoom> find_box_room(const SceneView& scene) {
    if (!may_be_box(scene)) {
        return std::nullopt;
    }
    const auto& facets = scene.facets.facets;
    const auto axes = find_axes(facets);
    BoxRoom room;
    if (!axes || !place_walls(room = {.axes = *axes}, facets)) {
        return std::nullopt;
    }
    double extent = 0.0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        for (const bool is_high : {false, true}) {
            const FacetId id = room.walls[axis][is_high ? 1 : 0];
            const bool faces_inside =
                (glm::dot(facets[id].plane.normal, room.axes[axis]) > 0.0) != is_high;
            if (!measure(room, facets[id], axis, is_high) ||
                (!faces_inside && !scene.one_sided.empty() && scene.one_sided[id] != 0)) {
                return std::nullopt;
            }
            for (const Vec3& corner : facets[id].loops.front()) {
                extent =
                    std::max({extent, std::abs(corner.x), std::abs(corner.y), std::abs(corner.z)});
            }
        }
    }
    const double size = std::min({room.size(0), room.size(1), room.size(2)});
    return room.tilt <= kMaxTilt && room.error <= kMaxError * extent && size >= kMinSize * extent
               ? std::optional(room)
               : std::nullopt;
}

}  // namespace earshot::frustum
