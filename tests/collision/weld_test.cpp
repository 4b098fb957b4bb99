// SPDX-License-Identifier: MIT
#include "earshot/collision/weld.h"

#include "earshot/collision/world.h"

#include <gtest/gtest.h>

#include "support/dice.h"
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <tuple>

namespace earshot::collision {
namespace {

using geometry::AnimatedMesh;
using geometry::Node;
using geometry::Part;
using geometry::Triangle;
using geometry::Vec3;
using geometry::VertexId;
using support::Dice;

/// A closed surface with shared vertices: a tetrahedron, every face of which is split in four.
geometry::Mesh closed_surface(int levels) {
    geometry::Mesh mesh{{{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}},
                        {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}}};
    for (int level = 0; level < levels; ++level) {
        std::map<std::array<VertexId, 2>, VertexId> middles;
        const auto middle = [&](VertexId a, VertexId b) {
            const std::array<VertexId, 2> edge{std::min(a, b), std::max(a, b)};
            const auto [entry, is_new] =
                middles.emplace(edge, static_cast<VertexId>(mesh.positions.size()));
            if (is_new) {
                mesh.positions.push_back(
                    glm::normalize(mesh.positions[edge[0]] + mesh.positions[edge[1]]));
            }
            return entry->second;
        };
        std::vector<Triangle> finer;
        for (const auto& [a, b, c] : mesh.triangles) {
            const VertexId ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
            finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
        }
        mesh.triangles = finer;
    }
    return mesh;
}

/// The same triangles with three vertices each, as STL stores them; `original` is what each copies.
geometry::Mesh split(const geometry::Mesh& mesh, std::vector<VertexId>& original) {
    geometry::Mesh result;
    for (const Triangle& triangle : mesh.triangles) {
        const auto first = static_cast<VertexId>(result.positions.size());
        for (const VertexId vertex : triangle) {
            result.positions.push_back(mesh.positions[vertex]);
            original.push_back(vertex);
        }
        result.triangles.push_back({first, first + 1, first + 2});
    }
    return result;
}

const std::vector<Triangle> kTwoTriangles{{0, 1, 4}, {2, 5, 3}};

TEST(Weld, CopiesStandForTheFirstOfThem) {
    const std::vector<std::vector<Vec3>> pose{{{1, 2, 3},
                                               {0, 0, 0},
                                               {1, 2, 3},
                                               {-0.0, 0, 0},
                                               {1, 2, std::nextafter(3.0, 4.0)},
                                               {7, 7, 7}}};
    EXPECT_EQ(weld(kTwoTriangles, pose), (std::vector<VertexId>{0, 1, 0, 1, 4, 5}));
}

TEST(Weld, VerticesThatPartInOnePoseStayDifferent) {
    const std::vector<Triangle> triangle{{0, 1, 2}};
    const std::vector<std::vector<Vec3>> poses{{{0, 0, 0}, {0, 0, 0}, {0, 0, 0}},
                                               {{1, 0, 0}, {1, 0, 0}, {2, 0, 0}},
                                               {{3, 0, 0}, {3, 0, 0}, {3, 0, 0}}};
    EXPECT_EQ(weld(triangle, poses), (std::vector<VertexId>{0, 0, 2}));
}

TEST(Weld, PositionsThatAreNoNumbersDoNoHarm) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const std::vector<std::vector<Vec3>> pose{
        {{nan, 0, 0}, {1, 0, 0}, {0, nan, 0}, {1, 0, 0}, {nan, 0, 0}, {0, 1, 0}}};
    EXPECT_EQ(weld(kTwoTriangles, pose), (std::vector<VertexId>{0, 1, 2, 1, 0, 5}));
}

TEST(Weld, ClosedSurfacesThatTouchStayTwo) {
    // Two tetrahedra with shared vertices that have a corner in common: not a vertex that was
    // split.
    const std::vector<std::vector<Vec3>> pose{{{0, 0, 0},
                                               {1, 0, 0},
                                               {0, 1, 0},
                                               {0, 0, 1},
                                               {0, 0, 0},
                                               {-1, 0, 0},
                                               {0, -1, 0},
                                               {0, 0, -1}}};
    std::vector<Triangle> closed{
        {0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}, {4, 6, 5}, {4, 5, 7}, {4, 7, 6}, {5, 6, 7}};
    EXPECT_EQ(weld(closed, pose), (std::vector<VertexId>{0, 1, 2, 3, 4, 5, 6, 7}));
    // Open at the corner, both may be pieces of one surface.
    closed.erase(closed.begin() + 4);
    closed.erase(closed.begin());
    EXPECT_EQ(weld(closed, pose), (std::vector<VertexId>{0, 1, 2, 3, 0, 5, 6, 7}));
}

/// Contacts of a mesh with itself, in terms of the vertices that `original` names.
std::set<std::tuple<ContactKind, std::vector<VertexId>, std::vector<VertexId>>> self_contacts(
    World& world, std::span<const VertexId> original) {
    std::set<std::tuple<ContactKind, std::vector<VertexId>, std::vector<VertexId>>> result;
    const ContactOptions options{.within_meshes = true};
    for (const auto& contacts : {world.contacts(options), world.contacts_at_begin(options)}) {
        for (const Contact& contact : contacts) {
            std::array<std::vector<VertexId>, 2> ids;
            for (std::size_t side = 0; side < 2; ++side) {
                const Element& element = side == 0 ? contact.a : contact.b;
                for (std::uint32_t i = 0; i < element.size; ++i) {
                    ids[side].push_back(original[element.vertices[i]]);
                }
                std::sort(ids[side].begin(), ids[side].end());
            }
            if (contact.kind != ContactKind::vertex_face) {
                std::sort(ids.begin(), ids.end());
            }
            result.emplace(contact.kind, ids[0], ids[1]);
        }
    }
    return result;
}

TEST(Weld, ContactsOfSplitTrianglesAreThoseOfTheSharedVertices) {
    // A closed surface that is dented so deep that it intersects itself in some rounds.
    Dice dice(3);
    std::size_t found = 0;
    for (int round = 0; round < 8; ++round) {
        geometry::Mesh shared = closed_surface(3);
        for (Vec3& position : shared.positions) {
            if (position.x > 0.6) {
                position.x -= 0.3 * round * dice.between(0.9, 1.1);
            }
        }
        std::vector<VertexId> original, itself(shared.positions.size());
        const geometry::Mesh copies = split(shared, original);
        for (VertexId i = 0; i < itself.size(); ++i) {
            itself[i] = i;
        }
        World expected, welded, kept;
        expected.add(AnimatedMesh::fixed(shared));
        welded.add(AnimatedMesh::fixed(copies));
        kept.add(AnimatedMesh::fixed(copies), false);
        for (World* world : {&expected, &welded, &kept}) {
            world->set_step(0.0, 0.0);
        }
        const auto contacts = self_contacts(expected, itself);
        EXPECT_EQ(self_contacts(welded, original), contacts) << round;
        EXPECT_GT(self_contacts(kept, original).size(), contacts.size() + 500) << round;
        found += contacts.size();
    }
    EXPECT_GT(found, 100U);
}

TEST(Weld, WorldTellsTheLowestIndex) {
    // Two triangles that share an edge as copies, and one that crosses the second.
    World world;
    world.add(AnimatedMesh::fixed({{{0, 0, 0},
                                    {1, 0, 0},
                                    {0, 0, 1},
                                    {1, 0, 0},
                                    {1, 0, 1},
                                    {0, 0, 1},
                                    {0.9, -1, 0.9},
                                    {0.9, 1, 0.9},
                                    {0.8, 1, 0.9}},
                                   {{0, 1, 2}, {3, 4, 5}, {6, 7, 8}}}));
    world.set_step(0.0, 0.0);
    const auto contacts = world.contacts_at_begin({.within_meshes = true});
    ASSERT_EQ(contacts.size(), 1U);
    EXPECT_EQ(contacts[0].a.vertices, (std::array<VertexId, 3>{1, 2, 4}));
    EXPECT_EQ(contacts[0].b.vertices, (std::array<VertexId, 3>{6, 7, 8}));
}

Part square(int node, double x) {
    Part part;
    part.node = node;
    part.positions = {{x, 0, 0}, {x + 1, 0, 0}, {x + 1, 0, 1}, {x, 0, 1}};
    return part;
}

const std::vector<Triangle> kTwoSquares{{0, 1, 2}, {0, 2, 3}, {4, 5, 6}, {4, 6, 7}};

TEST(Weld, PartsOfOneNodeAreOneMeshAndNodesAreNot) {
    Node still, moving;
    still.name = "still";
    moving.name = "moving";
    moving.translation = {
        geometry::Interpolation::linear, {0.0, 1.0}, {0.0, 0.0, 0.0, 0.0, 1.0, 0.0}};
    const AnimatedMesh one({still, moving}, {}, {square(1, 0), square(1, 1)}, kTwoSquares);
    EXPECT_EQ(weld(one), (std::vector<VertexId>{0, 1, 2, 3, 1, 5, 6, 2}));
    EXPECT_EQ(one.mesh_names(), std::vector<std::string>{"moving"});
    const AnimatedMesh two({still, moving}, {}, {square(0, 0), square(1, 1)}, kTwoSquares);
    EXPECT_EQ(weld(two), (std::vector<VertexId>{0, 1, 2, 3, 4, 5, 6, 7}));
    EXPECT_EQ(two.mesh_names(), (std::vector<std::string>{"still", "moving"}));
    World world;
    EXPECT_EQ(world.add(one), 0U);
    EXPECT_EQ(world.add(two), 1U);
    EXPECT_EQ(world.mesh_count(), 3U);
    world.set_step(0.0, 0.5);
    // The first scene's mesh moves up from where the still one is, whose neighbour moves too.
    std::set<std::pair<std::uint32_t, std::uint32_t>> pairs;
    for (const Contact& contact : world.contacts()) {
        pairs.insert(std::minmax(contact.a.mesh, contact.b.mesh));
        EXPECT_EQ(contact.toi, 0.0);
    }
    EXPECT_EQ(pairs, (std::set<std::pair<std::uint32_t, std::uint32_t>>{{0, 1}, {0, 2}, {1, 2}}));
    EXPECT_TRUE(world.contacts({.between_meshes = false, .within_meshes = true}).empty());
}

TEST(Weld, MorphTargetsAndJointsThatDifferKeepCopiesApart) {
    // Both squares move with one node; the seam's copies have other displacements in one vertex.
    Node node;
    Part left = square(0, 0), right = square(0, 1);
    left.targets = {{{{0, 0, 0}, {0, 1, 0}, {0, 1, 0}, {0, 0, 0}}}};
    right.targets = {{{{0, 1, 0}, {0, 0, 0}, {0, 0, 0}, {0, 2, 0}}}};
    left.rest_weights = right.rest_weights = {0.0};
    EXPECT_EQ(weld(AnimatedMesh({node}, {}, {left, right}, kTwoSquares)),
              (std::vector<VertexId>{0, 1, 2, 3, 1, 5, 6, 7}));

    Part skinned = square(0, 0);
    skinned.positions = {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}};
    skinned.skin = 0;
    skinned.influences_per_vertex = 2;
    skinned.influences = {
        {0, 0.5}, {1, 0.5}, {0, 1.0}, {1, 0.0}, {1, 0.0}, {0, 1.0}, {0, 0.5}, {1, 0.5}};
    const geometry::Skin skin{{0, 1}, {glm::dmat4(1.0), glm::dmat4(1.0)}};
    EXPECT_EQ(weld(AnimatedMesh({node, node}, {skin}, {skinned}, {{0, 1, 2}, {0, 2, 3}})),
              (std::vector<VertexId>{0, 1, 1, 0}));
}

}  // namespace
}  // namespace earshot::collision
