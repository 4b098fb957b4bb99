// SPDX-License-Identifier: MIT
// The oracle compares planes at the corners of a cell: their difference is linear in between.
#include "earshot/frustum/internal/occlusion_grid.h"

#include "earshot/base/random.h"
#include "earshot/base/simd.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <string>

namespace earshot::frustum {
namespace {

constexpr double kSize = 0.25;  // of a cell

InverseDepth random_plane(std::uint64_t seed, std::uint64_t number) {
    const auto part = [&](std::uint64_t k, double limit) {
        return random_between(seed, number, k, -limit, limit);
    };
    return {.constant = 1.0 + part(0, 0.3), .slope = {part(1, 0.2), part(2, 0.2)}};
}

/// Of the first plane in front of the second, the least in a cell of the grid from (-1, -1) on.
double min_difference(const InverseDepth& front, const InverseDepth& back, int cell) {
    double smallest = 1e300;
    for (const int corner : {0, 1, 2, 3}) {
        const glm::dvec2 uv = {-1.0 + kSize * (cell % kGridSide + corner % 2),
                               -1.0 + kSize * (cell / kGridSide + corner / 2)};
        smallest = std::min(smallest, front.at(uv) - back.at(uv));
    }
    return smallest;
}

TEST(OcclusionGrid, APlaneOccludesWhereItIsCloserInTheWholeCell) {
    std::size_t closer = 0, own = 0;
    for (std::uint64_t seed = 0; seed < 2000; ++seed) {
        OcclusionGrid grid;
        grid.reset(glm::dvec2(-1.0 + 0.5 * kSize), glm::dvec2(kSize));
        const CellMask covered = RandomStream(seed, 10).bits(0) | RandomStream(seed, 10).bits(1);
        const InverseDepth occluder = random_plane(seed, 1), plane = random_plane(seed, 2);
        grid.add(7, occluder, covered);
        EXPECT_EQ(grid.occluded(), covered);
        const CellMask asked = RandomStream(seed, 11).bits(0);
        for (const std::string& target : simd_targets()) {
            override_simd_target(target);
            const CellMask found = grid.cells_occluding(3, plane, asked);
            EXPECT_EQ(grid.cells_occluding(7, plane, asked), 0U);
            EXPECT_EQ(found & ~(asked & covered), 0U);
            EXPECT_EQ(grid.cells_where_closer(occluder, plane, asked & covered), found);
            for_each_cell(asked & covered, [&](int cell) {
                const double difference = min_difference(occluder, plane, cell);
                const bool is_found = (found >> cell & 1U) != 0;
                EXPECT_TRUE(is_found ? difference > 0.0 : difference < 1e-9)
                    << seed << " " << target;
                closer += is_found ? 1 : 0;
                own += is_found ? 0 : 1;
            });
        }
    }
    override_simd_target("auto");
    EXPECT_GT(closer, 5000U);
    EXPECT_GT(own, 5000U);
}

TEST(OcclusionGrid, TheClosestPlaneOfACellIsKeptInAnyOrder) {
    for (std::uint64_t seed = 0; seed < 500; ++seed) {
        OcclusionGrid forward, backward;
        for (OcclusionGrid* grid : {&forward, &backward}) {
            grid->reset(glm::dvec2(-1.0 + 0.5 * kSize), glm::dvec2(kSize));
        }
        constexpr geometry::FacetId kPlanes = 5;
        for (geometry::FacetId i = 0; i < kPlanes; ++i) {
            const geometry::FacetId last = kPlanes - 1 - i;
            forward.add(i, random_plane(seed, i / 2), RandomStream(seed, 20).bits(i));
            backward.add(last, random_plane(seed, last / 2), RandomStream(seed, 20).bits(last));
        }
        for (geometry::FacetId i = 0; i < kPlanes; ++i) {
            EXPECT_EQ(forward.cells_occluded_by(i, kAllCells),
                      backward.cells_occluded_by(i, kAllCells));
        }
    }
}

}  // namespace
}  // namespace earshot::frustum
