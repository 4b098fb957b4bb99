// SPDX-License-Identifier: MIT
//
// Visible sets: the triangles visible from a point, from anywhere in a region, and from each of its
// view cells, with a bound on what the sampled sets miss.

#include "earshot/visibility/visible_sets.h"

#include "earshot/bvh/deformable_bvh.h"
#include "earshot/visibility/global_sampling.h"
#include "earshot/visibility/guided_sampling.h"
#include "earshot/visibility/pvs_validation.h"
#include "earshot/visibility/visible_triangles.h"

#include <array>
#include <iostream>
#include <utility>

/// Adds a closed room of 12 triangles.
void add_room(earshot::geometry::Mesh& mesh, double x, double width) {
    const auto v = static_cast<earshot::geometry::VertexId>(mesh.positions.size());
    for (unsigned i = 0; i < 8; ++i) {
        mesh.positions.emplace_back(
            x + width * (i & 1U), 3.0 * (i >> 1U & 1U), 4.0 * (i >> 2U & 1U));
    }
    for (const auto& [a, b, c, d] : {std::array{0U, 2U, 6U, 4U},
                                     {1U, 5U, 7U, 3U},
                                     {0U, 4U, 5U, 1U},
                                     {2U, 3U, 7U, 6U},
                                     {0U, 1U, 3U, 2U},
                                     {4U, 6U, 7U, 5U}}) {
        mesh.triangles.push_back({v + a, v + b, v + c});
        mesh.triangles.push_back({v + a, v + c, v + d});
    }
}

int main() {
    using namespace earshot;
    geometry::Mesh mesh;
    add_room(mesh, 0.0, 5.0);
    add_room(mesh, 5.5, 3.0);
    const bvh::DeformableBvh hierarchy(mesh.view());

    const geometry::Vec3 listener{2, 1.5, 2};
    const auto from_point = visibility::visible_triangles(hierarchy.view(), listener);
    std::cout << from_point.triangles.size() << " triangles are visible from the listener, "
              << from_point.free_solid_angle << " sr are free\n";

    const visibility::ViewRegion region{{1, 1, 1}, {4, 2, 3}};
    const auto from_region =
        visibility::sample_region(hierarchy.view(), region, {.max_rays = 100'000});
    std::cout << from_region.triangles.size() << " from anywhere in its room\n";

    // Two view cells, one in each room.
    const auto cells = visibility::ViewCells::grid({{0.5, 1, 1}, {8, 2, 3}}, {2, 1, 1});
    const auto objects = visibility::Objects::triangles(mesh.triangles.size());
    auto pvs = visibility::sample_cells(hierarchy.view(), objects, cells, {.max_rays = 200'000});
    const auto missed =
        visibility::validate_pvs(hierarchy.view(), objects, cells, pvs.visible, {.rays = 30'000});
    const visibility::VisibleSets sets(
        cells, objects, std::move(pvs.visible), {.validation = missed});
    const auto cell = sets.cells().cell_at(listener);
    std::cout << "The sets miss " << missed.estimate() << " of all directions, at most "
              << missed.upper_bound() << "\nWhere the listener is triangle 23 "
              << (sets.contains(*cell, 23) ? "may be" : "is never") << " visible\n";
}
