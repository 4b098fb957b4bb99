// SPDX-License-Identifier: MIT
#include "earshot/frustum/internal/visible_facets.h"

#include "earshot/frustum/internal/primary_facets.h"
#include "earshot/frustum/path_finder.h"
#include "earshot/frustum/path_verifier.h"

#include <gtest/gtest.h>

#include "frustum/quad_room.h"
#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <vector>

namespace earshot::frustum {
namespace {

using geometry::FacetId;
using geometry::Vec3;

// The facet that a ray meets first at t > 0 (in multiples of `direction`), by trying every triangle
// with the textbook formula; nothing where two hits lie too close together to tell.
std::optional<FacetId> first_facet(const SceneView& s, const Vec3& origin, const Vec3& direction) {
    double nearest = 1e30;
    std::optional<FacetId> first;
    for (std::size_t i = 0; i < s.mesh().triangles.size(); ++i) {
        const auto& triangle = s.mesh().triangles[i];
        const Vec3& a = s.mesh().positions[triangle[0]];
        const Vec3 ab = s.mesh().positions[triangle[1]] - a;
        const Vec3 ac = s.mesh().positions[triangle[2]] - a;
        const Vec3 p = glm::cross(direction, ac);
        const double determinant = glm::dot(ab, p);
        const Vec3 offset = origin - a;
        const double u = glm::dot(offset, p) / determinant;
        const Vec3 q = glm::cross(offset, ab);
        const double v = glm::dot(direction, q) / determinant;
        const double t = glm::dot(ac, q) / determinant;
        if (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 1e-9 && t < nearest) {
            nearest = t;
            first = s.facets.of_triangle[i];
        }
    }
    return first;
}

TEST(VisibleFacets, EveryFirstHitOfARayIsFound) {
    int rays = 0;
    for (std::uint64_t seed = 0; seed < 40; ++seed) {
        const RandomRoom random(seed, static_cast<int>(seed % 9));
        const SceneView scene_view = random.room.scene_view();
        const FacetIndex index(scene_view);
        const PathVerifier verifier(scene_view);
        VisibleFacets search(index, Mode::complete, verifier.contact_radius(), 20.0);
        for (const Frustum& frustum : frusta_around(random.source, 2, 8, 1e-12)) {
            search.search(frustum);
            std::set<FacetId> found;
            for (const VisibleFacet& visible : search.found()) {
                found.insert(visible.facet);
            }
            for (std::uint64_t ray = 0; ray < 40; ++ray, ++rays) {
                const double u =
                    random_between(seed, 900 + ray, 0, frustum.rect.lower.x, frustum.rect.upper.x);
                const double v =
                    random_between(seed, 900 + ray, 1, frustum.rect.lower.y, frustum.rect.upper.y);
                const Vec3 direction = frustum.forward + u * frustum.right + v * frustum.up;
                const auto facet = first_facet(scene_view, random.source, direction);
                if (facet) {
                    ASSERT_EQ(found.count(*facet), 1U) << "seed " << seed << " ray " << ray;
                }
            }
        }
    }
    EXPECT_GT(rays, 30000);
}

/// A room with many small boxes, so that frusta are searched in pieces.
struct CrowdedRoom {
    explicit CrowdedRoom(std::uint64_t seed, int boxes) {
        const auto dice = [&](int box, std::uint64_t i, double low, double high) {
            return random_between(seed, 700 + static_cast<std::uint64_t>(box), i, low, high);
        };
        room.add_box({-5, -2, -4}, {10, 0, 0}, {0, 4, 0}, {0, 0, 8}, true);
        for (int box = 0; box < boxes; ++box) {
            const Vec3 corner = {
                dice(box, 0, -4.9, 4.2), dice(box, 1, -1.9, 1.2), dice(box, 2, -3.9, 3.2)};
            if (glm::length(corner) < 1.2) {
                continue;  // air around the source
            }
            const double angle = box % 2 == 0 ? 0.0 : dice(box, 3, 0.0, 6.0);
            const double size = dice(box, 4, 0.1, 0.6);
            room.add_box(corner,
                         size * Vec3(std::cos(angle), 0, std::sin(angle)),
                         dice(box, 5, 0.1, 0.6) * Vec3(0, 1, 0),
                         dice(box, 6, 0.1, 0.6) * Vec3(-std::sin(angle), 0, std::cos(angle)));
        }
        room.finish();
    }
    QuadRoom room;
};

TEST(PrimaryFacets, EveryFirstHitOfARayIsFoundInTheWholeFrustum) {
    std::size_t whole = 0, in_pieces = 0;
    for (std::uint64_t seed = 0; seed < 4; ++seed) {
        const CrowdedRoom crowded(seed, 300);
        const SceneView scene_view = crowded.room.scene_view();
        const FacetIndex index(scene_view);
        const PathVerifier verifier(scene_view);
        const Vec3 source = 0.3 * Vec3(random_between(seed, 1, 0, -1.0, 1.0), 0.1, 0.2);
        const auto frusta = frusta_around(source, 1, 8, 1e-12);
        const int pieces = 4 << (seed % 3);
        const auto make_search = [&] {
            return VisibleFacets(index, Mode::complete, verifier.contact_radius(), 20.0);
        };
        const auto visible = find_primary_facets(frusta, pieces, make_search, Executor::serial());
        VisibleFacets search = make_search();
        for (std::size_t i = 0; i < frusta.size(); ++i) {
            search.search(frusta[i]);
            whole += search.found().size();
            in_pieces += visible[i].size();
            for (std::uint64_t ray = 0; ray < 100; ++ray) {
                const auto dice = [&](std::uint64_t k) {
                    const double at = random_between(seed, 900 + 100 * i + ray, k, -1.0, 1.0);
                    return ray % 4 == k ? std::round(at * pieces) / pieces : at;  // in a border
                };
                const Vec3 direction =
                    frusta[i].forward + dice(0) * frusta[i].right + dice(1) * frusta[i].up;
                const auto facet = first_facet(scene_view, source, direction);
                if (!facet) {
                    continue;
                }
                const auto found = std::find_if(
                    visible[i].begin(), visible[i].end(), [&](const VisibleFacet& candidate) {
                        return candidate.facet == *facet;
                    });
                ASSERT_NE(found, visible[i].end()) << "seed " << seed << " ray " << ray;
                EXPECT_TRUE(may_pass(frusta[i], *found, source + 30.0 * direction, 1e-12))
                    << "seed " << seed << " ray " << ray;
            }
        }
    }
    EXPECT_LT(in_pieces, whole * 9 / 10);
}

TEST(PrimaryFacets, PathsAreThoseOfWholeFrusta) {
    const CrowdedRoom crowded(9, 220);
    const SceneView scene_view = crowded.room.scene_view();
    const std::vector<Vec3> listeners = {{0.4, 0.3, -0.2}, {-0.3, -0.5, 0.1}};
    const auto find = [&](bool forward_only, int resolution) {
        const PathFinder finder(
            scene_view,
            {.trace = {.max_order = 3, .resolution = resolution}, .forward_only = forward_only});
        return finder.find(Vec3(0.1, -0.2, 0.15), finder.trace_listeners(listeners));
    };
    const TraceResult expected = find(true, 8);
    EXPECT_GT(expected.paths.size(), 50U);
    const TraceResult found = find(false, 0);
    ASSERT_EQ(found.paths.size(), expected.paths.size());
    for (std::size_t i = 0; i < found.paths.size(); ++i) {
        EXPECT_EQ(found.paths[i].triangles, expected.paths[i].triangles);
        EXPECT_EQ(found.paths[i].length, expected.paths[i].length);
    }
}

TEST(VisibleFacets, AWallHidesWhatStandsBehindIt) {
    QuadRoom room;
    room.add_quad({-9, -9, 5}, {-9, 9, 5}, {9, 9, 5}, {9, -9, 5});  // 0: a large wall
    room.add_quad({-1, -1, 7}, {-1, 1, 7}, {1, 1, 7}, {1, -1, 7});  // 1: behind it
    room.add_quad({-1, -1, 3}, {-1, 1, 3}, {1, 1, 3}, {1, -1, 3});  // 2: before it
    room.finish();
    const SceneView scene_view = room.scene_view();
    const FacetIndex index(scene_view);
    VisibleFacets search(index, Mode::complete, 1e-3, 10.0);
    std::set<FacetId> found;
    for (const Frustum& frustum : frusta_around(Vec3(0.0), 1, 8, 1e-12)) {
        search.search(frustum);
        for (const VisibleFacet& visible : search.found()) {
            found.insert(visible.facet);
        }
        if (frustum.forward.z > 0.5) {
            EXPECT_TRUE(search.may_arrive_at({0, 0, 2}));
            EXPECT_TRUE(search.may_arrive_at({3, 3, 4.9}));
            EXPECT_FALSE(search.may_arrive_at({0, 0, 6}));
        }
    }
    EXPECT_EQ(found, (std::set<FacetId>{0, 2}));
}

TEST(VisibleFacets, AReflectedFrustumIsAsWideAsTheFacetAllows) {
    QuadRoom room;
    room.add_quad({-1, -1, 4}, {-1, 1, 4}, {1, 1, 4}, {1, -1, 4});
    room.finish();
    const SceneView scene_view = room.scene_view();
    const FacetIndex index(scene_view);
    VisibleFacets search(index, Mode::complete, 1e-3, 10.0);
    const auto frusta = frusta_around(Vec3(0.0), 1, 8, 1e-12);
    search.search(frusta[4]);  // towards +z
    ASSERT_EQ(search.found().size(), 1U);
    const Frustum child = search.reflect(search.found().front());
    EXPECT_NEAR(glm::distance(child.apex, Vec3(0, 0, 8)), 0.0, 1e-12);
    EXPECT_NEAR(child.rect.lower.x, -0.25, 1e-5);
    EXPECT_NEAR(child.rect.upper.y, 0.25, 1e-5);
    // Asked of the parent and of the child itself, the answers agree.
    const VisibleFacet mirror = search.found().front();
    EXPECT_TRUE(search.may_reflect_to(mirror, {0, 0, 1}));
    EXPECT_TRUE(search.may_reflect_to(mirror, {1.49, 0, 2.01}));
    EXPECT_FALSE(search.may_reflect_to(mirror, {4, 0, 1.98}));
    EXPECT_FALSE(search.may_reflect_to(mirror, {0, 0, 5}));
    search.search(child);
    EXPECT_TRUE(search.may_arrive_at({0, 0, 1}));
    EXPECT_TRUE(search.may_arrive_at({1.49, 0, 2.01}));   // just inside the mirrored pyramid
    EXPECT_FALSE(search.may_arrive_at({1.52, 0, 1.98}));  // just outside
    EXPECT_FALSE(search.may_arrive_at({0, 0, 5}));        // behind the mirror
}

}  // namespace
}  // namespace earshot::frustum
