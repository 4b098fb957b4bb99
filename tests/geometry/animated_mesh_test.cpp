// SPDX-License-Identifier: MIT
#include "earshot/geometry/animated_mesh.h"

#include "earshot/base/error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

namespace earshot::geometry {
namespace {

const std::vector<Vec3> kCorner{{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}};
const std::vector<Triangle> kOneTriangle{{0, 1, 2}};

/// Slides along x from 0 at 0 s to 2 m at 1 s.
Track slide() {
    return {Interpolation::linear, {0.0, 1.0}, {0.0, 0.0, 0.0, 2.0, 0.0, 0.0}};
}

Node node(int parent, const Vec3& translation) {
    Node made;
    made.parent = parent;
    made.rest.translation = translation;
    return made;
}

Part rigid_part(int on_node) {
    Part part;
    part.node = on_node;
    part.positions = kCorner;
    return part;
}

TEST(AnimatedMesh, FixedKeepsPositionsToTheLastBit) {
    const Mesh mesh{{{0.1, 0.2, 0.3}, {1e12, -1e-300, 0.0}, {3.0, 1.0 / 3.0, 2.0}}, kOneTriangle};
    const AnimatedMesh animated = AnimatedMesh::fixed(mesh);
    EXPECT_EQ(animated.positions_at(0.0), mesh.positions);
    EXPECT_EQ(animated.positions_at(5.0), mesh.positions);
    EXPECT_EQ(animated.triangles(), mesh.triangles);
    EXPECT_EQ(animated.duration(), 0.0);
}

TEST(AnimatedMesh, NodesAreMeshesUntilOthersAreNamed) {
    Node named = node(-1, {});
    named.name = "chair";
    const std::vector<Triangle> triangles{{0, 1, 2}, {3, 4, 5}, {6, 7, 8}};
    AnimatedMesh mesh(
        {named, node(-1, {})}, {}, {rigid_part(1), rigid_part(0), rigid_part(1)}, triangles);
    EXPECT_EQ(mesh.mesh_names(), (std::vector<std::string>{"", "chair"}));
    EXPECT_EQ(mesh.mesh_of_triangle(), (std::vector<std::uint32_t>{0, 1, 0}));
    EXPECT_EQ(mesh.mesh_of_vertex(), (std::vector<std::uint32_t>{0, 0, 0, 1, 1, 1, 0, 0, 0}));
    mesh.set_meshes({"a", "b"}, {1, 0, 1});
    EXPECT_EQ(mesh.mesh_names(), (std::vector<std::string>{"a", "b"}));
    EXPECT_EQ(mesh.mesh_of_vertex(), (std::vector<std::uint32_t>{1, 1, 1, 0, 0, 0, 1, 1, 1}));
    EXPECT_THROW(mesh.set_meshes({"a"}, {0, 0}), Error);
    EXPECT_THROW(mesh.set_meshes({"a"}, {0, 0, 1}), Error);
}

TEST(AnimatedMesh, VerticesOfNoTriangleGoWithTheOneBeforeThem) {
    AnimatedMesh mesh =
        AnimatedMesh::fixed({std::vector<Vec3>(9, Vec3(1.0)), {{1, 2, 3}, {5, 6, 7}}});
    mesh.set_meshes({"a", "b"}, {0, 1});
    EXPECT_EQ(mesh.mesh_of_vertex(), (std::vector<std::uint32_t>{0, 0, 0, 0, 0, 1, 1, 1, 1}));
    AnimatedMesh shared =
        AnimatedMesh::fixed({std::vector<Vec3>(5, Vec3(1.0)), {{0, 1, 2}, {2, 3, 4}}});
    EXPECT_THROW(shared.set_meshes({"a", "b"}, {0, 1}), Error);
}

TEST(AnimatedMesh, ChildMovesWithItsParent) {
    Node parent = node(-1, {});
    parent.translation = slide();
    const AnimatedMesh mesh({parent, node(0, {0.0, 5.0, 0.0})}, {}, {rigid_part(1)}, kOneTriangle);
    EXPECT_EQ(mesh.duration(), 1.0);
    EXPECT_EQ(mesh.positions_at(0.5)[0], Vec3(1.0, 5.0, 0.0));
    EXPECT_EQ(mesh.positions_at(0.5)[2], Vec3(1.0, 6.0, 0.0));
}

TEST(AnimatedMesh, TimeIsClampedToTheAnimation) {
    Node mover = node(-1, {});
    mover.translation = slide();
    const AnimatedMesh mesh({mover}, {}, {rigid_part(0)}, kOneTriangle);
    EXPECT_EQ(mesh.positions_at(-3.0), mesh.positions_at(0.0));
    EXPECT_EQ(mesh.positions_at(99.0), mesh.positions_at(1.0));
    EXPECT_EQ(mesh.positions_at(99.0)[0], Vec3(2.0, 0.0, 0.0));
}

TEST(AnimatedMesh, NodeTransformIsWhatMovesItsPart) {
    Node root = node(-1, {1.0, 2.0, 3.0});
    root.rest.rotation = {0.5, 0.5, 0.5, 0.5};
    Node child = node(0, {0.3, 0.2, 0.1});
    child.rest.scale = {1.5, 2.5, 0.7};
    child.translation = slide();
    Node leaf = node(1, {0.0, 0.1, 0.0});
    const AnimatedMesh mesh({root, child, leaf}, {}, {rigid_part(2)}, kOneTriangle);
    for (const double t : {0.0, 0.3, 1.0}) {
        const glm::dmat4 world = mesh.node_transform(2, t);
        for (std::size_t i = 0; i < 3; ++i) {
            EXPECT_EQ(mesh.positions_at(t)[i], transform_point(world, kCorner[i]));
        }
    }
}

TEST(AnimatedMesh, MatrixNodeShearsWhatTransformsCannot) {
    Node sheared = node(-1, {});
    glm::dmat4 matrix(1.0);
    matrix[1][0] = 0.5;  // x += y / 2
    sheared.matrix = matrix;
    const AnimatedMesh mesh({sheared}, {}, {rigid_part(0)}, kOneTriangle);
    EXPECT_EQ(mesh.positions_at(0.0)[2], Vec3(0.5, 1.0, 0.0));
}

TEST(AnimatedMesh, MorphTargetsAddWeightedDisplacements) {
    Part part = rigid_part(-1);
    part.targets = {{{{0.0, 0.0, 1.0}, {}, {}}}, {{{0.0, 4.0, 0.0}, {}, {}}}};
    part.rest_weights = {0.0, 0.0};
    part.weights = {Interpolation::linear, {0.0, 2.0}, {0.0, 1.0, 1.0, 0.5}};
    const AnimatedMesh mesh({}, {}, {part}, kOneTriangle);
    EXPECT_EQ(mesh.duration(), 2.0);
    EXPECT_EQ(mesh.positions_at(1.0)[0], Vec3(0.0, 3.0, 0.5));
    EXPECT_EQ(mesh.positions_at(1.0)[1], kCorner[1]);
}

/// Two joints, the second sliding; every vertex half on each. The mesh's node stands elsewhere.
AnimatedMesh two_joints() {
    Node sliding = node(-1, {0.0, 0.0, 7.0});
    sliding.translation = {Interpolation::linear, {0.0, 1.0}, {0.0, 0.0, 7.0, 2.0, 0.0, 7.0}};
    glm::dmat4 unbind(1.0);
    unbind[3] = {0.0, 0.0, -7.0, 1.0};
    Part part = rigid_part(2);
    part.skin = 0;
    part.influences_per_vertex = 2;
    part.influences = {{0, 0.5}, {1, 0.5}, {0, 1.0}, {1, 0.0}, {0, 0.0}, {1, 1.0}};
    return {{node(-1, {}), sliding, node(-1, {50.0, 50.0, 50.0})},
            {Skin{{0, 1}, {glm::dmat4(1.0), unbind}}},
            {part},
            kOneTriangle};
}

TEST(AnimatedMesh, SkinMovesVerticesByTheirJointsNotTheirNode) {
    const AnimatedMesh mesh = two_joints();
    EXPECT_EQ(mesh.positions_at(0.0), kCorner);  // the bind pose
    const std::vector<Vec3> end = mesh.positions_at(1.0);
    EXPECT_EQ(end[0], Vec3(1.0, 0.0, 0.0));
    EXPECT_EQ(end[1], kCorner[1]);
    EXPECT_EQ(end[2], Vec3(2.0, 1.0, 0.0));
}

TEST(AnimatedMesh, MorphComesBeforeTheSkin) {
    Node turned = node(-1, {});
    turned.rest.rotation = {0.0, 0.0, 0.0, 1.0};  // half a turn about z
    Part part = rigid_part(0);
    part.skin = 0;
    part.influences_per_vertex = 1;
    part.influences = {{0, 1.0}, {0, 1.0}, {0, 1.0}};
    part.targets = {{{{0.0, 1.0, 0.0}, {}, {}}}};
    part.rest_weights = {1.0};
    const AnimatedMesh mesh({turned}, {Skin{{0}, {glm::dmat4(1.0)}}}, {part}, kOneTriangle);
    EXPECT_EQ(mesh.positions_at(0.0)[0], Vec3(0.0, -1.0, 0.0));
}

TEST(AnimatedMesh, MirroredPartsAreTurnedSoThatTheirFrontStaysFront) {
    Node mirror = node(-1, {});
    mirror.rest.scale = {-1.0, 1.0, 1.0};
    const AnimatedMesh rigid({mirror}, {}, {rigid_part(0)}, kOneTriangle);
    EXPECT_EQ(rigid.triangles()[0], (Triangle{0, 2, 1}));

    Part skinned = rigid_part(-1);
    skinned.skin = 0;
    skinned.influences_per_vertex = 1;
    skinned.influences = {{0, 1.0}, {0, 1.0}, {0, 1.0}};
    const AnimatedMesh bent({mirror}, {Skin{{0}, {glm::dmat4(1.0)}}}, {skinned}, kOneTriangle);
    EXPECT_EQ(bent.triangles()[0], (Triangle{0, 2, 1}));

    Node twice = node(0, {});
    twice.rest.scale = {1.0, -3.0, 1.0};
    const AnimatedMesh even({mirror, twice}, {}, {rigid_part(1)}, kOneTriangle);
    EXPECT_EQ(even.triangles()[0], (Triangle{0, 1, 2}));
}

TEST(AnimatedMesh, VerticesAreNumberedPartAfterPart) {
    const AnimatedMesh mesh(
        {node(-1, {0.0, 0.0, 1.0})}, {}, {rigid_part(-1), rigid_part(0)}, {{0, 1, 2}, {3, 4, 5}});
    EXPECT_EQ(mesh.vertex_count(), 6U);
    EXPECT_EQ(mesh.positions_at(0.0)[5], Vec3(0.0, 1.0, 1.0));
}

struct Ingredients {
    std::vector<Node> nodes{node(-1, {}), node(0, {})};
    std::vector<Skin> skins{Skin{{0, 1}, {glm::dmat4(1.0), glm::dmat4(1.0)}}};
    std::vector<Part> parts{rigid_part(1)};
    std::vector<Triangle> triangles = kOneTriangle;
};

TEST(AnimatedMesh, RefusesWhatDoesNotFitTogether) {
    const double nan = std::nan("");
    const std::vector<std::function<void(Ingredients&)>> spoil{
        [](Ingredients& m) { m.nodes[0].parent = 1; },
        [](Ingredients& m) { m.nodes[1].parent = 1; },
        [](Ingredients& m) { m.nodes[1].parent = -2; },
        [=](Ingredients& m) { m.nodes[1].rest.scale.y = nan; },
        [=](Ingredients& m) { m.nodes[1].matrix = glm::dmat4(nan); },
        [](Ingredients& m) {
            m.nodes[1].matrix = glm::dmat4(1.0);
            m.nodes[1].translation = slide();
        },
        [](Ingredients& m) { m.nodes[1].rotation = slide(); },
        [](Ingredients& m) {
            m.nodes[1].translation = slide();
            m.nodes[1].translation.times = {1.0, 1.0};
        },
        [=](Ingredients& m) {
            m.nodes[1].translation = slide();
            m.nodes[1].translation.values[0] = nan;
        },
        [](Ingredients& m) { m.skins[0].joints[1] = 2; },
        [](Ingredients& m) { m.skins[0].inverse_bind.pop_back(); },
        [=](Ingredients& m) { m.skins[0].inverse_bind[0][3][0] = nan; },
        [](Ingredients& m) { m.parts[0].node = 2; },
        [=](Ingredients& m) { m.parts[0].positions[1].z = nan; },
        [](Ingredients& m) { m.parts[0].skin = 1; },
        [](Ingredients& m) { m.parts[0].skin = 0; },
        [](Ingredients& m) {
            m.parts[0].skin = 0;
            m.parts[0].influences_per_vertex = 1;
            m.parts[0].influences = {{0, 1.0}, {0, 1.0}, {2, 1.0}};
        },
        [](Ingredients& m) { m.parts[0].rest_weights = {1.0}; },
        [](Ingredients& m) {
            m.parts[0].rest_weights = {1.0};
            m.parts[0].targets = {{{{}, {}}}};
        },
        [](Ingredients& m) { m.parts[0].weights = slide(); },
        [](Ingredients& m) { m.triangles[0][1] = 3; },
    };
    const Ingredients good;
    EXPECT_NO_THROW(AnimatedMesh(good.nodes, good.skins, good.parts, good.triangles));
    for (std::size_t i = 0; i < spoil.size(); ++i) {
        Ingredients bad;
        spoil[i](bad);
        EXPECT_THROW(AnimatedMesh(bad.nodes, bad.skins, bad.parts, bad.triangles), Error)
            << "case " << i;
    }
}

}  // namespace
}  // namespace earshot::geometry
