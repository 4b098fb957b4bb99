// SPDX-License-Identifier: MIT
#include "earshot/base/random.h"
#include "earshot/geometry/clean.h"
#include "earshot/geometry/tolerance.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "geometry/made_meshes.h"
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

namespace earshot::geometry {
namespace {

/// Two boxes of cells, one of which moves through the other, with copies of some triangles, and
/// vertices that come together and part: `frame` after `frame`.
Mesh pose(std::uint64_t seed, int frame) {
    Mesh mesh = box_mesh(Vec3(4.0, 2.0, 3.0), 2);
    const std::size_t fixed = mesh.positions.size();
    Mesh other = box_mesh(Vec3(1.0), 2);
    for (const Vec3& position : other.positions) {
        mesh.positions.push_back(position + Vec3(0.25 * frame, 0.5, 0.5));
    }
    for (const Triangle& triangle : other.triangles) {
        const auto at = static_cast<VertexId>(fixed);
        mesh.triangles.push_back({triangle[0] + at, triangle[1] + at, triangle[2] + at});
    }
    // A copy of a triangle, exact in even frames, off by less than the tolerance or more in others.
    const double tolerance = coplanar_tolerance(mesh.view());
    const double off = frame % 2 == 0 ? 0.0 : frame % 4 == 1 ? 0.3 * tolerance : 3.0 * tolerance;
    const auto copy = static_cast<VertexId>(mesh.positions.size());
    for (const VertexId vertex : std::array(mesh.triangles[5])) {
        mesh.positions.push_back(mesh.positions[vertex] + Vec3(off, 0.0, 0.0));
    }
    mesh.triangles.push_back({copy + 1, copy + 2, copy});
    // A triangle that loses its area now and then, and one whose corner meets another's.
    const auto flat = static_cast<VertexId>(mesh.positions.size());
    mesh.positions.insert(mesh.positions.end(),
                          {Vec3(9, 0, 0), Vec3(9, 1, 0), Vec3(9, 2, frame % 3 == 0 ? 0.0 : 0.5)});
    mesh.triangles.push_back({flat, flat + 1, flat + 2});
    const auto tip = static_cast<VertexId>(mesh.positions.size());
    mesh.positions.insert(mesh.positions.end(),
                          {Vec3(8, 0, 1), Vec3(8, 1, 1), Vec3(9, frame % 5 == 2 ? 1.0 : 1.5, 0)});
    mesh.triangles.push_back({tip, tip + 1, tip + 2});
    // In some runs the same vertices jitter, in others they stay.
    for (std::uint64_t i = 0; seed % 2 == 1 && i < 3; ++i) {
        const std::size_t vertex = random_bits(seed, 1, i) % fixed;
        mesh.positions[vertex].y += 0.01 * random(seed, static_cast<std::uint64_t>(frame), i);
    }
    return mesh;
}

std::vector<Triangle> welded_triangles(const Mesh& mesh, const CleanMesh& clean) {
    std::vector<Triangle> triangles;
    for (const TriangleId id : clean.kept) {
        const auto [a, b, c] = mesh.triangles[id];
        triangles.push_back({clean.weld[a], clean.weld[b], clean.weld[c]});
    }
    return triangles;
}

TEST(CleanMeshCache, CleansEveryPoseAsIfItWereTheFirst) {
    int kept = 0, changed = 0;
    for (std::uint64_t seed = 0; seed < 8; ++seed) {
        CleanMeshCache cache;
        Executor two(2);
        std::vector<Triangle> before;
        std::vector<TriangleId> kept_before;
        for (int frame = 0; frame < 40; ++frame) {
            SCOPED_TRACE(std::to_string(seed) + ", frame " + std::to_string(frame));
            // Frames come twice and more in a row, so that there is something to keep.
            const Mesh mesh = pose(seed, frame / 3);
            const CleanMesh fresh = clean(mesh.view());
            const bool is_same = cache.update(mesh.view(), two);
            EXPECT_EQ(cache.clean().kept, fresh.kept);
            EXPECT_EQ(cache.clean().duplicates, fresh.duplicates);
            const std::vector<Triangle> triangles = welded_triangles(mesh, fresh);
            EXPECT_EQ(welded_triangles(mesh, cache.clean()), triangles);
            EXPECT_EQ(cache.report(mesh.view(), two), fresh.report);
            if (is_same) {
                EXPECT_EQ(triangles, before);
                EXPECT_EQ(fresh.kept, kept_before);
            }
            before = triangles;
            kept_before = fresh.kept;
            (is_same ? kept : changed) += 1;
        }
    }
    EXPECT_GT(kept, 40);
    EXPECT_GT(changed, 40);
}

/// Vertices on a sheet that sways, none near another.
TEST(CleanMeshCache, KeepsWhatASwayingSheetLeavesAlone) {
    Mesh sheet;
    add_plate(sheet, Vec3(0.0), {3, 0, 0}, {0, 2, 0}, 30, 20);
    CleanMeshCache cache;
    EXPECT_FALSE(cache.update(sheet.view()));
    for (int frame = 1; frame < 10; ++frame) {
        Mesh moved = sheet;
        for (Vec3& position : moved.positions) {
            position.z += 0.2 * std::sin(3.0 * position.x + frame);
        }
        EXPECT_TRUE(cache.update(moved.view())) << frame;
    }
}

// Exhaustively: what is a copy of what, as clean() promises it.
TEST(Clean, DropsTheNearCopiesThatAnExhaustiveSearchFinds) {
    std::size_t dropped = 0;
    for (std::uint64_t seed = 0; seed < 40; ++seed) {
        Mesh mesh = pose(seed, 2);
        const double tolerance = coplanar_tolerance(mesh.view());
        const std::size_t count = mesh.triangles.size();
        for (std::uint64_t i = 0; i < 30; ++i) {
            const Triangle copied = mesh.triangles[random_bits(seed, 7, i) % count];
            const auto first = static_cast<VertexId>(mesh.positions.size());
            for (std::size_t k = 0; k < 3; ++k) {
                const VertexId vertex = copied[(k + i) % 3];
                const Vec3 direction = glm::normalize(Vec3(random(seed, 8, 3 * i + k) - 0.5,
                                                           random(seed, 9, 3 * i + k) - 0.5,
                                                           random(seed, 10, 3 * i + k) - 0.5));
                const double off = (i % 3 == 0 ? 0.0 : 1.6 * random(seed, 11, i)) * tolerance;
                mesh.positions.push_back(mesh.positions[vertex] + off * direction);
            }
            mesh.triangles.push_back({first, first + 1, first + 2});
        }
        const auto agree = [&](TriangleId a, TriangleId b) {
            const Corners p = corners(mesh, a);
            std::array<std::size_t, 3> order = {0, 1, 2};
            do {
                const Corners q = corners(mesh, b);
                if (glm::distance(p[0], q[order[0]]) <= tolerance &&
                    glm::distance(p[1], q[order[1]]) <= tolerance &&
                    glm::distance(p[2], q[order[2]]) <= tolerance) {
                    return true;
                }
            } while (std::next_permutation(order.begin(), order.end()));
            return false;
        };
        // Triangles here are far larger than the tolerance, or have no area.
        const auto has_area = [&](TriangleId id) {
            const auto [a, b, c] = corners(mesh, id);
            return glm::length(glm::cross(b - a, c - a)) > 1e-3;
        };
        std::vector<TriangleId> kept;
        for (TriangleId id = 0; id < mesh.triangles.size(); ++id) {
            const bool repeats = std::any_of(
                kept.begin(), kept.end(), [&](TriangleId other) { return agree(other, id); });
            if (has_area(id) && !repeats) {
                kept.push_back(id);
            }
        }
        const CleanMesh result = clean(mesh.view());
        EXPECT_EQ(result.kept, kept) << seed;
        dropped += result.duplicates.size();
    }
    EXPECT_GT(dropped, 300U);
}

}  // namespace
}  // namespace earshot::geometry
