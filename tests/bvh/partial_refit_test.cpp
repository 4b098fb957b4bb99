// SPDX-License-Identifier: MIT
#include "earshot/bvh/partial_refit.h"

#include <gtest/gtest.h>

#include "support/meshes.h"
#include <array>
#include <cstring>

namespace earshot::bvh {
namespace {

using geometry::Mesh;

bool have_same_bits(const WideTree& a, const WideTree& b) {
    return a.box() == b.box() &&
           std::memcmp(a.nodes().data(), b.nodes().data(), a.nodes().size_bytes()) == 0 &&
           std::memcmp(a.packed_leaves().data(),
                       b.packed_leaves().data(),
                       a.packed_leaves().size_bytes()) == 0;
}

Mesh with_moved(Mesh mesh, std::span<const TriangleRange> ranges, std::uint64_t seed) {
    for (const TriangleRange& range : ranges) {
        for (std::uint32_t i = range.begin; i < range.end; ++i) {
            for (const geometry::VertexId vertex : mesh.triangles[i]) {
                mesh.positions[vertex] += test::random_point(seed, vertex);
            }
        }
    }
    return mesh;
}

TEST(PartialRefit, EqualsAFullRefitBitForBit) {
    Mesh mesh = test::triangle_soup(1, 5000);  // no vertex is shared
    WideTree partial = WideTree::build(Tree::build(triangle_boxes(mesh.view())), mesh.view());
    WideTree full = partial;
    PartialRefit places(partial);
    const std::array<std::vector<TriangleRange>, 5> frames = {
        {{{10, 11}}, {{0, 50}, {4950, 5000}}, {{100, 400}, {300, 500}}, {}, {{0, 5000}}}};
    for (std::size_t frame = 0; frame < frames.size(); ++frame) {
        mesh = with_moved(mesh, frames[frame], frame);
        places.refit(partial, mesh.view(), frames[frame]);
        full.refit(mesh.view());
        EXPECT_TRUE(have_same_bits(partial, full)) << "frame " << frame;
    }
}

TEST(PartialRefit, HoldsSmallAndEmptyTrees) {
    for (const std::size_t count : {0U, 1U, 9U}) {
        Mesh mesh = test::triangle_soup(2, count);
        WideTree tree = WideTree::build(Tree::build(triangle_boxes(mesh.view())), mesh.view());
        WideTree full = tree;
        PartialRefit places(tree);
        const std::vector<TriangleRange> all = {{0, static_cast<std::uint32_t>(count)}};
        mesh = with_moved(mesh, all, 3);
        places.refit(tree, mesh.view(), all);
        full.refit(mesh.view());
        EXPECT_TRUE(count == 0 || have_same_bits(tree, full)) << count;
    }
}

TEST(MovedTriangles, AreThoseOfWhichAVertexIsElsewhere) {
    // Triangle i has the vertices i, i + 1 and i + 2.
    Mesh mesh;
    for (std::uint32_t i = 0; i < 40000; ++i) {
        mesh.positions.push_back(test::random_point(5, i));
        if (i >= 2) {
            mesh.triangles.push_back({i - 2, i - 1, i});
        }
    }
    const std::vector<geometry::Vec3> before = mesh.positions;
    const auto ranges = [&] {
        Executor executor(2);
        std::vector<std::array<std::uint32_t, 2>> result;
        for (const TriangleRange& range : moved_triangles(mesh.view(), before, executor)) {
            result.push_back({range.begin, range.end});
        }
        return result;
    };
    using Ranges = std::vector<std::array<std::uint32_t, 2>>;
    EXPECT_EQ(ranges(), Ranges{});
    mesh.positions[0].x += 1.0;
    mesh.positions[10].y += 1e-300;  // is rounded away
    mesh.positions[20].z += 1.0;
    mesh.positions[21].z += 1.0;
    mesh.positions[39999].z += 1.0;
    EXPECT_EQ(ranges(), (Ranges{{0, 1}, {18, 22}, {39997, 39998}}));
    mesh.triangles.clear();
    EXPECT_EQ(ranges(), Ranges{});
}

}  // namespace
}  // namespace earshot::bvh
