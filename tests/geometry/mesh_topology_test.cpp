// SPDX-License-Identifier: MIT
#include "earshot/geometry/mesh_topology.h"

#include "earshot/base/error.h"
#include "earshot/base/math.h"
#include "earshot/base/random.h"

#include <gtest/gtest.h>

#include "made_meshes.h"
#include "support/meshes.h"
#include <algorithm>
#include <map>
#include <set>
#include <utility>
#include <vector>

namespace earshot::geometry {
namespace {

/// Welded edges with the number of their triangles, by brute force.
using EdgeUses = std::map<std::pair<VertexId, VertexId>, std::size_t>;

EdgeUses edge_uses(const Mesh& mesh, const CleanMesh& clean) {
    EdgeUses uses;
    for (const TriangleId id : clean.kept) {
        for (std::size_t k = 0; k < 3; ++k) {
            ++uses[std::minmax(clean.weld[mesh.triangles[id][k]],
                               clean.weld[mesh.triangles[id][(k + 1) % 3]])];
        }
    }
    return uses;
}

/// Numbers of the components of triangles that share edges, by spreading labels until none changes.
std::set<std::size_t> component_sizes(const Mesh& mesh, const CleanMesh& clean) {
    std::map<TriangleId, TriangleId> label;
    for (const TriangleId id : clean.kept) {
        label[id] = id;
    }
    const auto share_edge = [&](TriangleId a, TriangleId b) {
        std::size_t shared = 0;
        for (const VertexId p : mesh.triangles[a]) {
            for (const VertexId q : mesh.triangles[b]) {
                shared += clean.weld[p] == clean.weld[q] ? 1 : 0;
            }
        }
        return shared >= 2;
    };
    for (bool changed = true; changed;) {
        changed = false;
        for (const TriangleId a : clean.kept) {
            for (const TriangleId b : clean.kept) {
                if (label[b] < label[a] && share_edge(a, b)) {
                    label[a] = label[b];
                    changed = true;
                }
            }
        }
    }
    std::map<TriangleId, std::size_t> sizes;
    for (const auto& [id, root] : label) {
        ++sizes[root];
    }
    std::set<std::size_t> roots_and_sizes;
    for (const auto& [root, size] : sizes) {
        roots_and_sizes.insert(root * 1000000 + size);
    }
    return roots_and_sizes;
}

std::size_t open_edges_of(const MeshTopology& topology) {
    std::size_t count = 0;
    for (const HoleLoop& hole : topology.holes) {
        count += hole.open_edges;
    }
    return count;
}

void remove_triangles(Mesh& mesh, const std::set<TriangleId>& removed) {
    std::vector<Triangle> rest;
    for (TriangleId t = 0; t < mesh.triangles.size(); ++t) {
        if (!removed.contains(t)) {
            rest.push_back(mesh.triangles[t]);
        }
    }
    mesh.triangles = rest;
}

/// A torus of n x n cells, closed, fronts outside.
Mesh torus(int n) {
    Mesh mesh;
    for (int i = 0; i < n; ++i) {
        for (int k = 0; k < n; ++k) {
            const double u = 2.0 * math::kPi * i / n;
            const double v = 2.0 * math::kPi * k / n;
            const double r = 2.0 + 0.5 * math::cos(v);
            mesh.positions.emplace_back(r * math::cos(u), 0.5 * math::sin(v), r * math::sin(u));
        }
    }
    const auto at = [n](int i, int k) { return static_cast<VertexId>(i % n * n + k % n); };
    for (int i = 0; i < n; ++i) {
        for (int k = 0; k < n; ++k) {
            mesh.triangles.push_back({at(i, k), at(i, k + 1), at(i + 1, k + 1)});
            mesh.triangles.push_back({at(i, k), at(i + 1, k + 1), at(i + 1, k)});
        }
    }
    return mesh;
}

class Topology : public testing::Test {
protected:
    void SetUp() override {
        if (!topology_available()) {
            GTEST_SKIP() << "this build is without OpenMesh";
        }
    }
};

TEST_F(Topology, AClosedManifoldHasNothingToTell) {
    for (const auto& [mesh, euler] : {std::pair{test::sphere(2, 1.0, Vec3(3.0)), 2},
                                      {box_mesh({4.0, 2.0, 8.0}, 4), 2},
                                      {test::cube(3, 1.0), 2},
                                      {torus(12), 0}}) {
        const MeshTopology topology = find_topology(mesh.view());
        ASSERT_EQ(topology.islands.size(), 1U);
        EXPECT_TRUE(topology.islands[0].is_closed);
        EXPECT_TRUE(topology.islands[0].is_orientable);
        EXPECT_EQ(topology.islands[0].euler_characteristic, euler);
        EXPECT_EQ(topology.islands[0].triangles, mesh.triangles.size());
        EXPECT_TRUE(topology.holes.empty());
        EXPECT_TRUE(topology.doubled.empty());
        EXPECT_TRUE(topology.t_junctions.empty());
        EXPECT_EQ(topology.split_vertices, 0U);
    }
}

TEST_F(Topology, FlippedTrianglesAreNamed) {
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        Mesh mesh = seed % 2 == 0 ? box_mesh({4.0, 2.0, 8.0}, 4) : torus(8);
        std::vector<TriangleId> flipped;
        for (TriangleId t = 0; t < mesh.triangles.size(); ++t) {
            if (random(seed, 0, t) < 0.2) {
                std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
                flipped.push_back(t);
            }
        }
        EXPECT_EQ(find_topology(mesh.view()).flipped, flipped) << seed;
    }
}

TEST_F(Topology, AHoleHasItsRimPlaceAndSize) {
    // The cell of the top from (1, 4) to (2, 6) of a box whose cells measure 1 x 2 there.
    Mesh mesh = box_mesh({4.0, 2.0, 8.0}, 4);
    std::set<TriangleId> removed;
    for (TriangleId t = 0; t < mesh.triangles.size(); ++t) {
        const auto [a, b, c] = corners(mesh, t);
        const Vec3 centre = (a + b + c) / 3.0;
        if (a.y == 2.0 && b.y == 2.0 && c.y == 2.0 && centre.x > 1.0 && centre.x < 2.0 &&
            centre.z > 4.0 && centre.z < 6.0) {
            removed.insert(t);
        }
    }
    ASSERT_EQ(removed.size(), 2U);
    remove_triangles(mesh, removed);
    // Winding does not matter.
    for (TriangleId t = 0; t < mesh.triangles.size(); ++t) {
        if (random(1, 0, t) < 0.3) {
            std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
        }
    }
    const MeshTopology topology = find_topology(mesh.view());
    ASSERT_EQ(topology.holes.size(), 1U);
    const HoleLoop& hole = topology.holes[0];
    EXPECT_EQ(hole.rim.size(), 4U);
    EXPECT_EQ(hole.open_edges, 4U);
    EXPECT_EQ(hole.centre, Vec3(1.5, 2.0, 5.0));
    EXPECT_EQ(hole.lower, Vec3(1.0, 2.0, 4.0));
    EXPECT_EQ(hole.upper, Vec3(2.0, 2.0, 6.0));
    EXPECT_EQ(hole.rim_length, 6.0);
    EXPECT_EQ(hole.area, 2.0);
    EXPECT_EQ(hole.normal, Vec3(0.0, -1.0, 0.0));  // fronts are inside
    EXPECT_FALSE(hole.is_outline);
    EXPECT_FALSE(topology.islands[0].is_closed);
    EXPECT_EQ(topology.islands[0].euler_characteristic, 1);
}

TEST_F(Topology, CutHolesHaveTheOpenEdgesOfBruteForce) {
    for (std::uint64_t seed = 0; seed < 30; ++seed) {
        Mesh mesh = seed % 2 == 0 ? torus(9) : box_mesh({4.0, 2.0, 8.0}, 4);
        std::set<TriangleId> removed;
        for (TriangleId t = 0; t < mesh.triangles.size(); ++t) {
            if (random(seed, 1, t) < 0.1) {
                removed.insert(t);
            }
        }
        remove_triangles(mesh, removed);
        const MeshTopology topology = find_topology(mesh.view());
        std::set<std::pair<VertexId, VertexId>> want, got;
        for (const auto& [edge, uses] : edge_uses(mesh, topology.clean)) {
            if (uses == 1) {
                want.insert(edge);
            }
        }
        for (const HoleLoop& hole : topology.holes) {
            EXPECT_EQ(hole.rim.size(), hole.open_edges);
            for (std::size_t i = 0; i < hole.rim.size(); ++i) {
                got.insert(std::minmax(hole.rim[i], hole.rim[(i + 1) % hole.rim.size()]));
            }
        }
        EXPECT_EQ(got, want) << seed;
        EXPECT_EQ(open_edges_of(topology), want.size()) << seed;
    }
}

TEST_F(Topology, AnySoupIsTaken) {
    constexpr VertexId kVertices = 12;
    for (std::uint64_t seed = 0; seed < 300; ++seed) {
        Mesh mesh;
        for (VertexId v = 0; v < kVertices; ++v) {
            mesh.positions.push_back(test::random_point(seed, v));
        }
        const std::size_t count = 1 + random_bits(seed, 9, 0) % 40;
        for (std::uint64_t t = 0; t < count; ++t) {
            const auto vertex = [&](std::uint64_t k) {
                return static_cast<VertexId>(random_bits(seed, k, t) % kVertices);
            };
            mesh.triangles.push_back({vertex(3), vertex(4), vertex(5)});
        }
        const MeshTopology topology = find_topology(mesh.view());
        std::size_t open = 0;
        for (const auto& [edge, uses] : edge_uses(mesh, topology.clean)) {
            open += uses == 1 ? 1 : 0;
        }
        EXPECT_EQ(open_edges_of(topology), open) << seed;
        std::set<std::size_t> islands;
        for (const Island& island : topology.islands) {
            islands.insert(island.first_triangle * std::size_t{1000000} + island.triangles);
        }
        EXPECT_EQ(islands, component_sizes(mesh, topology.clean)) << seed;
    }
}

TEST_F(Topology, AMoebiusStripHasNoFront) {
    Mesh mesh;
    constexpr VertexId kCells = 9;
    for (VertexId i = 0; i < kCells; ++i) {
        const double turn = 2.0 * math::kPi * i / kCells;
        const Vec3 outward(math::cos(turn), 0.0, math::sin(turn));
        const Vec3 across =
            math::cos(0.5 * turn) * Vec3(0.0, 1.0, 0.0) + math::sin(0.5 * turn) * outward;
        mesh.positions.push_back(4.0 * outward + across);
        mesh.positions.push_back(4.0 * outward - across);
    }
    for (VertexId i = 0; i < kCells; ++i) {
        const VertexId a = 2 * i;
        // The last cell meets the first one upside down.
        const VertexId c = i + 1 < kCells ? a + 2 : 1;
        const VertexId d = i + 1 < kCells ? a + 3 : 0;
        mesh.triangles.push_back({a, a + 1, d});
        mesh.triangles.push_back({a, d, c});
    }
    const MeshTopology topology = find_topology(mesh.view());
    ASSERT_EQ(topology.islands.size(), 1U);
    EXPECT_FALSE(topology.islands[0].is_orientable);
    EXPECT_EQ(open_edges_of(topology), 2U * kCells);
}

TEST_F(Topology, ASheetOnAFloorIsAnOutlineAndTheFloorStaysWhole) {
    Mesh mesh;
    add_plate(mesh, Vec3(0.0), {0.0, 0.0, 4.0}, {4.0, 0.0, 0.0}, 4, 4);
    add_plate(mesh, {2.0, 0.0, 0.0}, {0.0, 0.0, 4.0}, {0.0, 1.0, 0.0}, 4, 1);
    const MeshTopology topology = find_topology(mesh.view());
    EXPECT_EQ(topology.islands.size(), 1U);
    ASSERT_EQ(topology.holes.size(), 2U);
    for (const HoleLoop& hole : topology.holes) {
        EXPECT_TRUE(hole.is_outline);
    }
    const HoleLoop& sheet = topology.holes[topology.holes[0].area < 10.0 ? 0 : 1];
    EXPECT_EQ(sheet.area, 4.0);
    EXPECT_EQ(sheet.rim.size(), 10U);
    EXPECT_EQ(sheet.open_edges, 6U);  // the four others are on the floor
    EXPECT_EQ(topology.split_vertices, 5U);
}

TEST_F(Topology, CubesThatShareAnEdgeStayClosed) {
    Mesh mesh = box_mesh(Vec3(2.0), 1);
    const Mesh other = mesh;
    const auto first = static_cast<VertexId>(mesh.positions.size());
    for (const Vec3& p : other.positions) {
        mesh.positions.push_back(p + Vec3(2.0, 2.0, 0.0));
    }
    for (const auto& [a, b, c] : other.triangles) {
        mesh.triangles.push_back({a + first, b + first, c + first});
    }
    const MeshTopology topology = find_topology(mesh.view());
    EXPECT_EQ(topology.islands.size(), 1U);
    EXPECT_TRUE(topology.islands[0].is_closed);
    EXPECT_TRUE(topology.holes.empty());
    EXPECT_TRUE(topology.flipped.empty());
}

TEST_F(Topology, DoubledFacesAreToldWithTheirSense) {
    Mesh mesh = box_mesh({4.0, 2.0, 8.0}, 2);
    const auto count = static_cast<TriangleId>(mesh.triangles.size());
    const auto [a, b, c] = mesh.triangles[5];
    mesh.triangles.push_back({b, c, a});
    mesh.triangles.push_back({mesh.triangles[7][0], mesh.triangles[7][2], mesh.triangles[7][1]});
    const std::vector<DoubledFace> want{{5, count, false}, {7, count + 1, true}};
    EXPECT_EQ(find_topology(mesh.view()).doubled, want);
}

TEST_F(Topology, TJunctionsAndSliversHavePlaces) {
    // Two triangles along an edge of the first, whose middle they meet in.
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {2, 0, 0}, {1, 0, 2}, {1, 0, 0}, {1, 0, -1}};
    mesh.triangles = {{0, 1, 2}, {0, 4, 3}, {3, 4, 1}};
    MeshTopology topology = find_topology(mesh.view());
    const std::vector<TJunction> want{{3, {1.0, 0.0, 0.0}}};
    EXPECT_EQ(topology.t_junctions, want);
    EXPECT_TRUE(topology.slivers.empty());

    mesh.positions.push_back({6.0, 0.0, 0.0});
    mesh.positions.push_back({10.0, 0.0, 0.0});
    mesh.positions.push_back({8.0, 0.001, 0.0});
    mesh.triangles.push_back({5, 6, 7});
    topology = find_topology(mesh.view());
    ASSERT_EQ(topology.slivers.size(), 1U);
    EXPECT_EQ(topology.slivers[0].triangle, 3U);
    EXPECT_NEAR(topology.slivers[0].height, 0.001, 1e-12);
    EXPECT_EQ(topology.slivers[0].length, 4.0);
    EXPECT_NEAR(topology.slivers[0].centre.x, 8.0, 1e-12);
}

TEST_F(Topology, NoTrianglesGiveNothing) {
    const MeshTopology topology = find_topology({});
    EXPECT_TRUE(topology.islands.empty());
    EXPECT_TRUE(topology.holes.empty());
}

TEST(TopologyWithoutOpenMesh, SaysWhatIsMissing) {
    if (topology_available()) {
        GTEST_SKIP() << "this build has OpenMesh";
    }
    EXPECT_THROW(find_topology(test::cube(1, 1.0).view()), Error);
}

}  // namespace
}  // namespace earshot::geometry
