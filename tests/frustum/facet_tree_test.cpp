// SPDX-License-Identifier: MIT
#include "earshot/frustum/internal/facet_tree.h"

#include "earshot/base/random.h"
#include "earshot/base/simd.h"
#include "earshot/frustum/internal/facet_index.h"
#include "earshot/frustum/internal/frustum.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "frustum/quad_room.h"
#include <algorithm>
#include <cstddef>
#include <vector>

namespace earshot::frustum {
namespace {

using geometry::FacetId;
using geometry::Vec3;

constexpr std::size_t kWidth = FacetNode::kWidth;

Vec3 random_point(std::uint64_t seed, std::uint64_t stream, double size) {
    return {random_between(seed, stream, 0, -size, size),
            random_between(seed, stream, 1, -size, size),
            random_between(seed, stream, 2, -size, size)};
}

/// A frustum of any position, mirrored twice, so that its axes are no coordinate axes.
struct MirroredFrustum {
    explicit MirroredFrustum(std::uint64_t seed) {
        frustum = frusta_around(random_point(seed, 0, 1.0), 2, 8, 1e-9)[seed % 24];
        for (std::uint64_t i = 1; i <= 2; ++i) {
            plane.normal = glm::normalize(random_point(seed, 10 * i, 1.0));
            const Vec3 middle = at(seed, 10 * i + 1);
            plane.offset = glm::dot(plane.normal, middle);
            frustum = mirrored(frustum, plane, 0, frustum.rect);
        }
    }
    /// A point of the frustum.
    Vec3 at(std::uint64_t seed, std::uint64_t stream) const {
        const Rect& rect = frustum.rect;
        return at(random_between(seed, stream, 0, rect.lower.x, rect.upper.x),
                  random_between(seed, stream, 1, rect.lower.y, rect.upper.y),
                  random_between(seed, stream, 2, 1.0, 5.0));
    }
    Vec3 at(double u, double v, double depth) const {
        return frustum.apex + depth * (frustum.forward + u * frustum.right + v * frustum.up);
    }

    Frustum frustum;
    geometry::Plane plane;  ///< where it starts
};

void set_box(FacetNode& node, std::size_t slot, const Vec3& a, const Vec3& b) {
    for (int k = 0; k < 3; ++k) {
        node.lower[k][slot] = std::min(a[k], b[k]);
        node.upper[k][slot] = std::max(a[k], b[k]);
    }
    node.used |= 1U << slot;
}

bool starts_before(const MirroredFrustum& mirrored, const Vec3& point) {
    return mirrored.frustum.side * mirrored.plane.distance(point) >= 0.0;
}

TEST(FacetTree, EveryFacetIsInOneSlotAndBoxesHoldWhatIsBelow) {
    for (const int boxes : {0, 1, 7, 60}) {
        const RandomRoom random(static_cast<std::uint64_t>(boxes), boxes);
        const FacetIndex index(random.room.scene_view());
        const auto nodes = index.tree().nodes();
        std::vector<int> times(index.size(), 0);
        // Parents come first, so backwards the facets below a child are known.
        std::vector<std::vector<FacetId>> below(nodes.size());
        for (std::size_t i = nodes.size(); i-- > 0;) {
            for (std::size_t slot = 0; slot < kWidth; ++slot) {
                if ((nodes[i].used >> slot & 1U) == 0) {
                    continue;
                }
                const std::uint32_t child = nodes[i].child[slot];
                const bool is_facet = (child & FacetNode::kFacetFlag) != 0;
                ASSERT_TRUE(is_facet || (child > i && child < nodes.size()));
                const std::vector<FacetId> facets =
                    is_facet ? std::vector<FacetId>{child & ~FacetNode::kFacetFlag} : below[child];
                for (const FacetId facet : facets) {
                    times[facet] += is_facet ? 1 : 0;
                    below[i].push_back(facet);
                    for (std::size_t k = 0; k < 3; ++k) {
                        EXPECT_LE(nodes[i].lower[k][slot],
                                  static_cast<double>(index.box(facet).lower[k]));
                        EXPECT_GE(nodes[i].upper[k][slot],
                                  static_cast<double>(index.box(facet).upper[k]));
                    }
                }
            }
        }
        EXPECT_EQ(times, std::vector<int>(index.size(), 1)) << boxes;
        EXPECT_EQ(below.front().size(), index.size());
    }
}

TEST(FacetTree, BoxesWithAPointOfTheFrustumAreKeptAndTheirPointsLieInTheBounds) {
    std::size_t culled = 0, bounded = 0, in_cells = 0;
    for (std::uint64_t seed = 0; seed < 3000; ++seed) {
        const MirroredFrustum mirrored(seed);
        const Frustum& frustum = mirrored.frustum;
        const FrustumBoxTest test(
            frustum, BoxCull(frustum, &mirrored.plane, 1e-12).half_spaces(), 1e-12);
        FacetNode node;
        for (std::size_t slot = 0; slot < kWidth - seed % 3; ++slot) {
            const Vec3 corner = frustum.apex + random_point(seed, 30 + slot, 5.0);
            set_box(node, slot, corner, corner + random_point(seed, 40 + slot, 1.5));
        }
        for (const std::string& target : simd_targets()) {
            override_simd_target(target);
            ChildBounds bounds;
            const std::uint32_t kept = project_boxes(test, node, bounds);
            ASSERT_EQ(kept & ~node.used, 0U);
            for (std::size_t slot = 0; slot < kWidth - seed % 3; ++slot) {
                const bool is_kept = (kept >> slot & 1U) != 0;
                culled += is_kept ? 0 : 1;
                for (std::uint64_t sample = 0; sample < 30; ++sample) {
                    Vec3 p;
                    for (int k = 0; k < 3; ++k) {
                        const double at = random_between(seed, 50 + sample, 3 * slot + k, 0.0, 1.0);
                        p[k] =
                            node.lower[k][slot] + at * (node.upper[k][slot] - node.lower[k][slot]);
                    }
                    const Vec3 local = frustum.local(p);
                    const glm::dvec2 uv = {local.x / local.z, local.y / local.z};
                    const Rect& rect = frustum.rect;
                    if (!is_kept) {
                        ASSERT_FALSE(starts_before(mirrored, p) && local.z > 0.0 &&
                                     uv.x > rect.lower.x && uv.x < rect.upper.x &&
                                     uv.y > rect.lower.y && uv.y < rect.upper.y)
                            << "seed " << seed << " " << target;
                    } else if (bounds.min_depth[slot] > 1e-3) {
                        ++bounded;
                        EXPECT_GE(local.z, bounds.min_depth[slot] - 1e-12);
                        for (int k = 0; k < 2; ++k) {
                            EXPECT_GE(uv[k], bounds.lower[k][slot] - 1e-9) << "seed " << seed;
                            EXPECT_LE(uv[k], bounds.upper[k][slot] + 1e-9) << "seed " << seed;
                        }
                        const glm::dvec2 cell =
                            1.0 * frustum.cells * (uv - rect.lower) / (rect.upper - rect.lower);
                        if (cell.x > 0.0 && cell.x < frustum.cells && cell.y > 0.0 &&
                            cell.y < frustum.cells) {
                            const int bit =
                                kGridSide * static_cast<int>(cell.y) + static_cast<int>(cell.x);
                            ++in_cells;
                            EXPECT_EQ(bounds.cells[slot] >> bit & 1U, 1U) << "seed " << seed;
                        }
                    }
                }
            }
        }
    }
    override_simd_target("auto");
    EXPECT_GT(culled, 5000U);
    EXPECT_GT(bounded, 50000U);
    EXPECT_GT(in_cells, 5000U);
}

// Points in the sides of a frustum, which rounding puts on either side of them.
TEST(FacetTree, TheMarginKeepsWhatRoundingMovesOutside) {
    std::size_t lost_without = 0;
    for (std::uint64_t seed = 0; seed < 2000; ++seed) {
        const MirroredFrustum mirrored(seed);
        const Frustum& frustum = mirrored.frustum;
        FacetNode node;
        for (std::size_t slot = 0; slot < kWidth; ++slot) {
            const Rect& rect = frustum.rect;
            const double across = random_between(seed, 70, slot, rect.lower.x, rect.upper.x);
            const double depth = random_between(seed, 71, slot, 20.0, 30.0);
            const Vec3 p =
                slot % 2 == 0
                    ? mirrored.at(slot % 4 == 0 ? rect.lower.x : rect.upper.x,
                                  0.5 * (rect.lower.y + rect.upper.y),
                                  depth)
                    : mirrored.at(across, slot % 4 == 1 ? rect.lower.y : rect.upper.y, depth);
            set_box(node, slot, p, p);
        }
        ChildBounds bounds;
        const auto kept = [&](double margin) {
            return project_boxes(
                {frustum, BoxCull(frustum, &mirrored.plane, margin).half_spaces(), margin},
                node,
                bounds);
        };
        std::uint32_t behind = 0;  // the facet where the frustum starts
        for (std::size_t slot = 0; slot < kWidth; ++slot) {
            const Vec3 p = {node.lower[0][slot], node.lower[1][slot], node.lower[2][slot]};
            behind |= starts_before(mirrored, p) ? 0 : 1U << slot;
        }
        EXPECT_EQ(kept(kRounding * 100.0) | behind, 0xffU) << "seed " << seed;
        lost_without += (kept(0.0) | behind) != 0xffU ? 1 : 0;
    }
    EXPECT_GT(lost_without, 500U);
}

}  // namespace
}  // namespace earshot::frustum
