// SPDX-License-Identifier: MIT
#include "earshot/collision/narrow_phase/internal/element_tester.h"

#include "earshot/collision/narrow_phase/ccd.h"

#include <algorithm>
#include <utility>

namespace earshot::collision {

using geometry::Triangle;
using geometry::VertexId;

namespace {

bool share_a_vertex(std::span<const VertexId> a, std::span<const VertexId> b) {
    return std::any_of(a.begin(), a.end(), [&](VertexId vertex) {
        return std::find(b.begin(), b.end(), vertex) != b.end();
    });
}

}  // namespace

void ElementTester::test(std::uint32_t slot_a, std::uint32_t slot_b) {
    ++statistics_.triangle_pairs;
    if (disjoint(swept_bvh_.dop(slot_a), swept_bvh_.dop(slot_b))) {
        return;
    }
    const std::uint32_t a = swept_bvh_.triangle(slot_a);
    const std::uint32_t b = swept_bvh_.triangle(slot_b);
    // Triangles that share a vertex cannot be separated by a plane.
    if (!share_a_vertex(scene_.triangles[a], scene_.triangles[b])) {
        const MovingCorners one = scene_.corners_of(scene_.triangles[a]);
        const MovingCorners other = scene_.corners_of(scene_.triangles[b]);
        const double margin =
            options_.margin() + std::max(scene_.deviation_of(scene_.triangles[a]),
                                         scene_.deviation_of(scene_.triangles[b]));
        if (disjoint_along_normal(one, other, margin) ||
            disjoint_along_normal(other, one, margin)) {
            return;
        }
    }
    if (time_bound_ < 1.0) {
        const MovingCorners one = scene_.corners_of(scene_.triangles[a]);
        const MovingCorners other = scene_.corners_of(scene_.triangles[b]);
        if (is_late(a, b, {one.begin, one.end}, {other.begin, other.end})) {
            return;
        }
    }
    test_elements(a, b);
}

/// Whether elements of two triangles cannot be in contact by the time bound.
bool ElementTester::is_late(std::uint32_t a,
                            std::uint32_t b,
                            const MovingElement& element_a,
                            const MovingElement& element_b) const {
    // Exact times lie less than this before the true ones; those with a separation and on screws
    // may lie further before them.
    constexpr double kEarly = 0x1p-30;
    const bool is_exact =
        options_.min_separation == 0.0 && !scene_.on_screws(mesh_of(a), mesh_of(b));
    return is_exact && first_overlap(element_a, element_b) > time_bound_ + kEarly;
}

/// The same of the element of the first `size` vertices and that of the others.
bool ElementTester::are_late(const std::array<VertexId, 4>& vertices,
                             std::size_t size,
                             std::uint32_t a,
                             std::uint32_t b) const {
    if (!(time_bound_ < 1.0)) {
        return false;
    }
    const MovingPoints points = scene_.points_of(vertices);
    const std::span<const geometry::Vec3> begin(points.begin), end(points.end);
    return is_late(
        a, b, {begin.first(size), end.first(size)}, {begin.subspan(size), end.subspan(size)});
}

void ElementTester::test_elements(std::uint32_t a, std::uint32_t b) {
    test_corners(a, b);
    test_corners(b, a);
    for (unsigned i = 0; i < 3; ++i) {
        for (unsigned k = 0; k < 3; ++k) {
            if ((representatives_[a] >> (3 + i) & representatives_[b] >> (3 + k) & 1) != 0) {
                test_edges(a, i, b, k);
            }
        }
    }
}

void ElementTester::test_corners(std::uint32_t of, std::uint32_t face) {
    const Triangle& corners = scene_.triangles[face];
    for (unsigned i = 0; i < 3; ++i) {
        const VertexId vertex = scene_.triangles[of][i];
        if ((representatives_[of] >> i & 1) == 0 ||
            share_a_vertex(std::span(&vertex, 1), corners) ||
            are_late({vertex, corners[0], corners[1], corners[2]}, 1, of, face)) {
            continue;
        }
        ++statistics_.elementary_tests;
        // Ascending, so that the time does not depend on how the triangle is written.
        std::array<VertexId, 4> vertices{vertex, corners[0], corners[1], corners[2]};
        std::sort(vertices.begin() + 1, vertices.end());
        const auto time = vertex_face_time(vertices, of, face);
        if (time) {
            Contact contact{.kind = ContactKind::vertex_face,
                            .a = scene_.element(mesh_of(of), std::span(vertices).first(1)),
                            .b = scene_.element(mesh_of(face), std::span(vertices).last(3)),
                            .toi = *time};
            scene_.set_point_and_normal(vertices, contact);
            contacts_.push_back(contact);
        }
    }
}

std::optional<double> ElementTester::vertex_face_time(const std::array<VertexId, 4>& vertices,
                                                      std::uint32_t of,
                                                      std::uint32_t face) const {
    MovingPoints points = scene_.points_of(vertices);
    if (scene_.meshes_on_screws != 0) {
        if (scene_.on_screws(mesh_of(of), mesh_of(face))) {
            return vertex_face_screw_ccd(
                scene_.screw_points_of(vertices, mesh_of(of), mesh_of(face)),
                options_.min_separation);
        }
        scene_.rest_if_on_screw(mesh_of(of), points);
    }
    return options_.min_separation > 0.0 ? vertex_face_min_separation_ccd(points, separation())
                                         : vertex_face_ccd(points);
}

std::optional<double> ElementTester::edge_edge_time(const std::array<VertexId, 4>& vertices,
                                                    std::uint32_t a,
                                                    std::uint32_t b) const {
    MovingPoints points = scene_.points_of(vertices);
    if (scene_.meshes_on_screws != 0) {
        if (scene_.on_screws(mesh_of(a), mesh_of(b))) {
            return edge_edge_screw_ccd(scene_.screw_points_of(vertices, mesh_of(a), mesh_of(b)),
                                       options_.min_separation);
        }
        scene_.rest_if_on_screw(mesh_of(a), points);
    }
    return options_.min_separation > 0.0 ? edge_edge_min_separation_ccd(points, separation())
                                         : edge_edge_ccd(points);
}

void ElementTester::test_edges(std::uint32_t a, unsigned i, std::uint32_t b, unsigned k) {
    std::array<VertexId, 4> vertices{scene_.triangles[a][i],
                                     scene_.triangles[a][(i + 1) % 3],
                                     scene_.triangles[b][k],
                                     scene_.triangles[b][(k + 1) % 3]};
    if (share_a_vertex(std::span(vertices).first(2), std::span(vertices).last(2)) ||
        are_late(vertices, 2, a, b)) {
        return;
    }
    ++statistics_.elementary_tests;
    // In the order of the elements, so that the time does not depend on the triangles: vertices
    // of later meshes come later.
    std::sort(vertices.begin(), vertices.begin() + 2);
    std::sort(vertices.begin() + 2, vertices.end());
    if (std::pair(vertices[2], vertices[3]) < std::pair(vertices[0], vertices[1])) {
        std::rotate(vertices.begin(), vertices.begin() + 2, vertices.end());
        std::swap(a, b);
    }
    const auto time = edge_edge_time(vertices, a, b);
    if (time) {
        Contact contact{.kind = ContactKind::edge_edge,
                        .a = scene_.element(mesh_of(a), std::span(vertices).first(2)),
                        .b = scene_.element(mesh_of(b), std::span(vertices).last(2)),
                        .toi = *time};
        scene_.set_point_and_normal(vertices, contact);
        contacts_.push_back(contact);
    }
}

}  // namespace earshot::collision
