// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/clean.h"
#include "earshot/geometry/facets.h"

#include "support/random_rooms.h"
#include "support/rooms.h"
#include <array>
#include <cstdint>
#include <utility>
#include <vector>

namespace earshot::frustum {

/// A screen in the air, 2 m wide and 1 m high, with its middle in the origin.
inline support::Room screen() {
    using geometry::Vec3;
    support::Room room;
    support::add_polygon(
        room,
        std::array{Vec3(-1, -0.5, 0), Vec3(1, -0.5, 0), Vec3(1, 0.5, 0), Vec3(-1, 0.5, 0)},
        0,
        true);
    return room;
}

/// A random room whose facets have labels of their own, so that labels name facets.
struct LabelledRoom {
    explicit LabelledRoom(std::uint64_t seed) : room(support::random_room(seed)) {
        const geometry::CleanMesh clean = geometry::clean(room.mesh.view());
        std::vector<geometry::Triangle> kept;
        std::vector<std::uint32_t> labels;
        std::vector<std::uint8_t> is_sheet;
        for (const geometry::TriangleId t : clean.kept) {
            kept.push_back(room.mesh.triangles[t]);
            labels.push_back(room.labels[t]);
            is_sheet.push_back(room.is_sheet[t]);
        }
        room.mesh.triangles = std::move(kept);
        room.is_sheet = std::move(is_sheet);
        room.labels = geometry::find_facets(room.mesh.view(), clean.weld, labels).of_triangle;
    }

    support::Room room;
};

}  // namespace earshot::frustum
