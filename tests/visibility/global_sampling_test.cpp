// SPDX-License-Identifier: MIT
#include "earshot/visibility/global_sampling.h"

#include "earshot/base/error.h"

#include <gtest/gtest.h>

#include "support/meshes.h"
#include "visibility/screens.h"
#include <algorithm>
#include <numeric>

namespace earshot::visibility {
namespace {

using geometry::Mesh;
using geometry::Vec3;
using test::tree_of;

constexpr std::size_t kBatch = 2048;

/// Two closed rooms side by side along x that share no wall, each about its own centre.
Mesh two_rooms() {
    Mesh mesh = test::cube(4, 2.0);
    const Mesh other = mesh;
    const auto first = static_cast<geometry::VertexId>(mesh.positions.size());
    for (const Vec3& position : other.positions) {
        mesh.positions.push_back(position + Vec3(5.0, 0.0, 0.0));
    }
    for (const auto& [a, b, c] : other.triangles) {
        mesh.triangles.push_back({a + first, b + first, c + first});
    }
    return mesh;
}

std::vector<ObjectId> up_to(ObjectId end, ObjectId begin = 0) {
    std::vector<ObjectId> ids(end - begin);
    std::iota(ids.begin(), ids.end(), begin);
    return ids;
}

TEST(GlobalSampling, AllOfAConvexRoomIsVisibleFromItsCells) {
    const Mesh room = test::cube(4, 2.0);
    const ViewCells cells = ViewCells::grid({Vec3(-1.9), Vec3(1.9)}, {3, 3, 3});
    const GlobalPvs view = sample_cells({tree_of(room), room.view()},
                                        Objects::triangles(room.triangles.size()),
                                        cells,
                                        {.max_rays = 400'000, .samples_per_batch = kBatch});
    for (const auto& visible : view.visible) {
        EXPECT_EQ(visible, up_to(static_cast<ObjectId>(room.triangles.size())));
    }
}

TEST(GlobalSampling, SealedRoomsAreNeverMutuallyVisible) {
    const Mesh mesh = two_rooms();
    const auto half = static_cast<ObjectId>(mesh.triangles.size() / 2);
    // Two columns of cells in each room and one between them.
    const ViewCells cells = ViewCells::grid({{-1.5, -1.5, -1.5}, {6.5, 1.5, 1.5}}, {8, 1, 1})
                                .merged({0, 0, 0, 1, 1, 2, 2, 2});
    const GlobalPvs view = sample_cells({tree_of(mesh), mesh.view()},
                                        Objects::triangles(mesh.triangles.size()),
                                        cells,
                                        {.max_rays = 1'000'000, .samples_per_batch = kBatch});
    EXPECT_EQ(view.visible[0], up_to(half));
    EXPECT_EQ(view.visible[2], up_to(2 * half, half));
}

TEST(GlobalSampling, MoreRaysOnlyAdd) {
    const Mesh mesh = test::triangle_soup(3, 1000);
    const Objects objects = Objects::groups(mesh.view(), 4);
    const ViewCells cells = ViewCells::grid({Vec3(-1.0), Vec3(1.0)}, {4, 4, 4});
    const auto tree = tree_of(mesh);
    GlobalPvs last;
    for (std::uint64_t batches = 1; batches < 64; batches *= 4) {
        GlobalPvs view =
            sample_cells({tree, mesh.view()},
                         objects,
                         cells,
                         {.max_rays = 2 * batches * kBatch, .samples_per_batch = kBatch});
        EXPECT_EQ(view.rays, 2 * batches * kBatch);
        for (std::size_t cell = 0; batches > 1 && cell < cells.size(); ++cell) {
            ASSERT_TRUE(std::includes(view.visible[cell].begin(),
                                      view.visible[cell].end(),
                                      last.visible[cell].begin(),
                                      last.visible[cell].end()));
        }
        std::uint64_t entries = 0;
        for (const auto& visible : view.visible) {
            entries += visible.size();
        }
        EXPECT_EQ(view.curve.back().entries, entries);
        last = std::move(view);
    }
}

TEST(GlobalSampling, IsTheSameForAnyExecutorAndTree) {
    const Mesh mesh = test::triangle_soup(4, 1500);
    const Objects objects = Objects::triangles(mesh.triangles.size());
    const ViewCells cells = ViewCells::grid({Vec3(-1.0), Vec3(1.0)}, {3, 2, 4});
    const GlobalSamplingOptions options = {.max_rays = 100'000, .samples_per_batch = kBatch};
    const GlobalPvs once = sample_cells({tree_of(mesh), mesh.view()}, objects, cells, options);
    for (const int threads : {1, 2, 8}) {
        for (const bvh::Builder builder : {bvh::Builder::quality, bvh::Builder::lbvh}) {
            Executor executor(threads);
            const GlobalPvs again = sample_cells(
                {tree_of(mesh, builder), mesh.view()}, objects, cells, options, executor);
            EXPECT_EQ(again.visible, once.visible);
            for (std::size_t distribution = 0; distribution < kSampleDistributions;
                 ++distribution) {
                EXPECT_EQ(again.counts[distribution].samples, once.counts[distribution].samples);
                EXPECT_EQ(again.counts[distribution].contribution,
                          once.counts[distribution].contribution);
            }
        }
    }
}

TEST(GlobalSampling, MutationsFindObjectsThatViewSpaceDirectionsMiss) {
    const Mesh mesh = test::sphere(4, 1.0, {0.0, 0.0, -8.0});
    const Objects objects = Objects::triangles(mesh.triangles.size());
    const ViewCells cells = ViewCells::grid({Vec3(-0.5), Vec3(0.5)}, {2, 2, 2});
    GlobalSamplingOptions options = {.max_rays = 200'000, .samples_per_batch = kBatch};
    const auto tree = tree_of(mesh);
    const auto all = sample_cells({tree, mesh.view()}, objects, cells, options);
    options.distributions = {true, false, false, false, false};
    const auto plain = sample_cells({tree, mesh.view()}, objects, cells, options);
    EXPECT_GT(all.curve.back().entries, 3 * plain.curve.back().entries);
}

TEST(GlobalSampling, EndsWhenNothingGrows) {
    const Mesh room = test::cube(1, 2.0);
    const GlobalPvs view = sample_cells({tree_of(room), room.view()},
                                        Objects::triangles(room.triangles.size()),
                                        ViewCells({Vec3(-1.0), Vec3(1.0)}),
                                        {.window = 20'000, .max_growth = 0});
    EXPECT_LT(view.rays, 1'000'000U);
    EXPECT_EQ(view.visible[0].size(), room.triangles.size());
}

TEST(GlobalSampling, HandlesEmptyMeshesAndRefusesTooManyBits) {
    const ViewCells one({Vec3(-1.0), Vec3(1.0)});
    const GlobalPvs view = sample_cells({bvh::WideTree(), {}}, Objects::triangles(0), one);
    ASSERT_EQ(view.visible.size(), 1U);
    EXPECT_TRUE(view.visible[0].empty());
    const Mesh mesh = test::triangle_soup(4, 3000);
    EXPECT_THROW(sample_cells({tree_of(mesh), mesh.view()},
                              Objects::triangles(3000),
                              ViewCells::grid(one.region(), {1U << 12U, 1U << 12U, 1})),
                 Error);
    EXPECT_THROW(
        sample_cells(
            {tree_of(mesh), mesh.view()}, Objects::triangles(3000), one, {.distributions = {}}),
        Error);
}

}  // namespace
}  // namespace earshot::visibility
