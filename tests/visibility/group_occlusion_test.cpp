// SPDX-License-Identifier: MIT
#include "earshot/visibility/group_occlusion.h"

#include "earshot/visibility/coherent_line_of_sight.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "line_of_sight_scenes.h"
#include "support/dice.h"
#include <algorithm>
#include <cmath>
#include <vector>

namespace earshot::visibility {
namespace {

using geometry::Mesh;
using geometry::Segment;
using geometry::TriangleId;
using geometry::Vec3;
using support::Dice;

Vec3 place_in(Dice& dice, double half_side) {
    const double x = dice.between(-half_side, half_side);
    const double y = dice.between(-half_side, half_side);
    return {x, y, dice.between(-half_side, half_side)};
}

/// Adds a wall of two triangles.
void add_wall(Mesh& mesh, const Vec3& corner, const Vec3& u, const Vec3& v) {
    const auto first = static_cast<geometry::VertexId>(mesh.positions.size());
    for (const Vec3& point : {corner, corner + u, corner + u + v, corner + v}) {
        mesh.positions.push_back(point);
    }
    mesh.triangles.push_back({first, first + 1, first + 2});
    mesh.triangles.push_back({first, first + 2, first + 3});
}

/// Walls of two triangles, and small triangles.
Mesh random_walls(Dice& dice) {
    Mesh mesh;
    const int walls = 2 + dice.below(6);
    for (int wall = 0; wall < walls; ++wall) {
        const Vec3 corner = place_in(dice, 3.0);
        const Vec3 u = place_in(dice, 3.0), v = place_in(dice, 3.0);
        add_wall(mesh, corner, u, v);
    }
    for (int i = dice.below(20); i > 0; --i) {
        const auto first = static_cast<geometry::VertexId>(mesh.positions.size());
        const Vec3 corner = place_in(dice, 3.0);
        for (int k = 0; k < 3; ++k) {
            mesh.positions.push_back(corner + place_in(dice, 0.2));
        }
        mesh.triangles.push_back({first, first + 1, first + 2});
    }
    return mesh;
}

/// A scene in which viewers walk and turn, halt and jump, points and walls move at times.
class MovingCase {
public:
    explicit MovingCase(std::uint64_t seed) : dice_(seed), mesh(random_walls(dice_)) {
        for (int i = 0; i < 2; ++i) {
            viewers.push_back(place_in(dice_, 3.0));
            steps_.push_back(place_in(dice_, 0.05));
        }
        for (int i = 0; i < 200; ++i) {
            points.push_back(place_in(dice_, 3.0));
        }
        // Some share a place.
        std::fill_n(points.begin() + 20, 12, points[20]);
        points_drift_ = dice_.chance(0.3);
        mesh_moves_ = dice_.chance(0.5);
    }

    void advance() {
        for (std::size_t i = 0; i < viewers.size(); ++i) {
            if (dice_.chance(0.05)) {
                steps_[i] = dice_.chance(0.3) ? Vec3(0.0) : place_in(dice_, 0.05);
            }
            viewers[i] = dice_.chance(0.02) ? place_in(dice_, 3.0) : viewers[i] + steps_[i];
        }
        if (points_drift_) {
            for (std::size_t i = 0; i < points.size() / 4; ++i) {
                points[i] += place_in(dice_, 0.02);
            }
        }
        if (mesh_moves_ && dice_.chance(0.3)) {
            const std::size_t first =
                static_cast<std::size_t>(dice_.below(static_cast<int>(mesh.positions.size() / 4)));
            const Vec3 step = place_in(dice_, dice_.chance(0.2) ? 2.0 : 0.1);
            for (std::size_t k = 0; k < 4; ++k) {
                mesh.positions[4 * first + k] += step;
            }
        }
    }

private:
    Dice dice_;
    std::vector<Vec3> steps_;
    bool points_drift_ = false, mesh_moves_ = false;

public:
    Mesh mesh;
    std::vector<Vec3> viewers, points;
};

/// Every pair of every frame against all triangles, one by one. Returns how many were decided in
/// groups.
std::uint64_t check_frames(std::uint64_t seed, int frames) {
    MovingCase scene(seed);
    ExclusionMask excluded;
    if (seed % 3 == 0) {
        excluded.add(1);
    }
    GroupOcclusion groups(scene.mesh.view(), excluded);
    bvh::DeformableBvh tree(scene.mesh.view());
    std::vector<std::uint8_t> visible(scene.points.size());
    std::uint64_t decided = 0;
    for (int frame = 0; frame < frames; ++frame) {
        const Mesh before = scene.mesh;
        if (frame > 0) {
            scene.advance();
        }
        const auto moved = bvh::moved_flags(scene.mesh.view(), before.positions);
        GroupOcclusion::Motion motion;
        for (std::size_t i = 0; i < moved.size(); ++i) {
            for (const Mesh* mesh : {&before, static_cast<const Mesh*>(&scene.mesh)}) {
                if (moved[i] != 0) {
                    const auto [a, b, c] = geometry::corners(*mesh, i);
                    motion.box.include(geometry::triangle_box(a, b, c));
                    motion.triangles = moved;
                }
            }
        }
        tree.update(scene.mesh.view());
        const bvh::MeshBvh bvh = tree.view();
        groups.begin_frame(bvh, motion, scene.viewers, scene.points);
        for (std::size_t viewer = 0; viewer < scene.viewers.size(); ++viewer) {
            groups.visible(viewer, visible);
            for (std::size_t i = 0; i < scene.points.size(); ++i) {
                const bool expected =
                    visible_by_brute_force(scene.mesh.view(),
                                           {scene.viewers[viewer], scene.points[i]},
                                           [&](TriangleId id) { return excluded.contains(id); });
                if ((visible[i] != 0) != expected) {
                    ADD_FAILURE() << "seed " << seed << ", frame " << frame << ", point " << i;
                    return decided;
                }
            }
        }
        decided += groups.statistics().decided;
    }
    return decided;
}

TEST(GroupOcclusion, EqualsSingleTestsInEveryFrame) {
    std::uint64_t decided = 0;
    for (std::uint64_t seed = 1; seed <= 24; ++seed) {
        decided += check_frames(seed, 60);
    }
    // More than one pair in four.
    EXPECT_GT(4 * decided, 24U * 60U * 2U * 200U);
}

TEST(GroupOcclusion, EqualsSingleTestsInEveryFrameSlow) {
    for (std::uint64_t seed = 100; seed < 250; ++seed) {
        check_frames(seed, 80);
    }
}

/// Rays of single tests that remember the last occluder of each pair.
class SingleTests {
public:
    explicit SingleTests(std::size_t points) : last_(points, kNoBlocker) {}

    void ask(const bvh::MeshBvh& bvh, const Vec3& viewer, const std::vector<Vec3>& points) {
        for (std::size_t i = 0; i < points.size(); ++i) {
            const Segment segment{viewer, points[i]};
            if (last_[i] != kNoBlocker && blocks(bvh.mesh(), last_[i], segment)) {
                continue;
            }
            ++rays;
            const auto blocker = first_blocker(bvh, segment);
            last_[i] = blocker ? blocker->triangle : kNoBlocker;
        }
    }

    std::uint64_t rays = 0;

private:
    std::vector<TriangleId> last_;
};

// 10,000 listeners in a hall and a source that walks: a fifth of the rays, of searches and of
// traversals by shafts together.
TEST(GroupOcclusion, CastsAFifthOfTheRaysOfSingleTests) {
    const Mesh mesh = scene_mesh("concert_hall");
    const bvh::DeformableBvh tree(mesh.view());
    const bvh::MeshBvh bvh = tree.view();
    Dice dice(5);
    std::vector<Vec3> points;
    for (int i = 0; i < 10000; ++i) {
        const double x = dice.between(-10.0, 10.0);
        const double y = dice.between(0.0, 16.0);
        points.emplace_back(x, y, dice.between(0.0, 42.0));
    }
    GroupOcclusion groups(mesh.view(), {});
    SingleTests single(points.size());
    std::vector<std::uint8_t> visible(points.size());
    std::uint64_t work = 0;
    for (int step = 0; step < 100; ++step) {
        // 1.4 m/s, 20 steps a second, across the stage and along the hall.
        const Vec3 viewer = step < 50 ? Vec3(-1.75 + 0.07 * step, 3.0, 8.0)
                                      : Vec3(1.75, 3.0, 8.0 + 0.07 * (step - 50));
        groups.begin_frame(bvh, {}, {&viewer, 1}, points);
        groups.visible(0, visible);
        single.ask(bvh, viewer, points);
        const GroupOcclusionStatistics& of_frame = groups.statistics();
        work += of_frame.rays + of_frame.searches + of_frame.shafts;
        if (step % 10 == 0) {
            std::vector<Segment> segments;
            for (const Vec3& point : points) {
                segments.push_back({viewer, point});
            }
            EXPECT_EQ(visible, earshot::visibility::visible(bvh, segments));
        }
    }
    EXPECT_LE(5 * work, single.rays);
}

// Where all proofs end in one frame and many are in vain, those that cost little are found first.
TEST(GroupOcclusion, CastsFewerRaysAmongClutterWhereTheViewerTurns) {
    Dice dice(4);
    Mesh mesh;
    for (int wall = 0; wall < 8; ++wall) {
        const Vec3 corner = place_in(dice, 6.0);
        const Vec3 along = place_in(dice, 3.0);
        add_wall(mesh, {corner.x, -1.5, corner.z}, {along.x, 0.0, along.z}, {0.0, 3.0, 0.0});
    }
    const auto place = [&] {
        const Vec3 p = place_in(dice, 8.0);
        return Vec3(p.x, p.y * (1.5 / 8.0), p.z);
    };
    for (int i = 0; i < 20; ++i) {
        const Vec3 corner = place();
        const Vec3 u = place_in(dice, 0.1);
        add_wall(mesh, corner, u, place_in(dice, 0.1));
    }
    std::vector<Vec3> points(4000);
    std::generate(points.begin(), points.end(), place);
    const bvh::DeformableBvh tree(mesh.view());
    GroupOcclusion groups(mesh.view(), {});
    SingleTests single(points.size());
    std::vector<std::uint8_t> visible(points.size());
    std::uint64_t work = 0;
    Vec3 viewer(0.1, 0.0, 0.2);
    for (int step = 0; step < 120; ++step) {
        const double angle = 2.4 * (step / 30);
        viewer += 0.07 * Vec3(std::cos(angle), 0.0, std::sin(angle));
        groups.begin_frame(tree.view(), {}, {&viewer, 1}, points);
        groups.visible(0, visible);
        single.ask(tree.view(), viewer, points);
        const GroupOcclusionStatistics& of_frame = groups.statistics();
        work += of_frame.rays + of_frame.searches + of_frame.shafts;
    }
    EXPECT_LE(4 * work, single.rays);
}

// Nothing is known of the way of a viewer that jumps, and no proof would hold.
TEST(GroupOcclusion, AsksAllInABatchForAViewerThatJumps) {
    Dice dice(7);
    const Mesh mesh = random_walls(dice);
    const bvh::DeformableBvh tree(mesh.view());
    std::vector<Vec3> points;
    for (int i = 0; i < 500; ++i) {
        points.push_back(place_in(dice, 3.0));
    }
    GroupOcclusion groups(mesh.view(), {});
    std::vector<std::uint8_t> visible(points.size());
    for (int frame = 0; frame < 20; ++frame) {
        const Vec3 viewer = place_in(dice, 3.0);
        groups.begin_frame(tree.view(), {}, {&viewer, 1}, points);
        groups.visible(0, visible);
        EXPECT_EQ(groups.statistics(), GroupOcclusionStatistics{.rays = points.size()}) << frame;
    }
}

// Matrices of many columns or many rows are decided in groups, by any number of threads.
TEST(GroupOcclusion, ServesMatricesOfMovingScenes) {
    Executor two(2);
    const auto scene = io::load_scene(test::source_file("scenes/door.gltf")).scene;
    Dice dice(9);
    std::vector<Vec3> few, many;
    for (int i = 0; i < 5; ++i) {
        few.emplace_back(dice.between(0.5, 9.5), 1.5, dice.between(0.5, 3.5));
    }
    for (int i = 0; i < 400; ++i) {
        many.emplace_back(dice.between(0.0, 10.0), dice.between(0.0, 3.0), dice.between(0.0, 4.0));
    }
    std::vector<Vec3> positions = scene.mesh.positions_at(0.0);
    const geometry::MeshView first{positions, scene.mesh.triangles()};
    CoherentLineOfSight wide(first), tall(first);
    for (int frame = 0; frame < 30; ++frame) {
        positions = scene.mesh.positions_at(0.05 * std::max(0, frame - 5));
        const geometry::MeshView mesh{positions, scene.mesh.triangles()};
        if (frame > 15) {
            few[2] += Vec3(0.03, 0.0, 0.01);
        }
        const std::vector<std::uint8_t>& rows = wide.matrix(mesh, {few, many}, two);
        const std::vector<std::uint8_t>& columns = tall.matrix(mesh, {many, few});
        const auto tree = wide_tree_of(mesh);
        const bvh::MeshBvh bvh(tree, mesh);
        for (std::size_t i = 0; i < few.size(); ++i) {
            for (std::size_t k = 0; k < many.size(); ++k) {
                const std::uint8_t expected = visible(bvh, Segment{few[i], many[k]}) ? 1 : 0;
                ASSERT_EQ(rows[i * many.size() + k], expected) << frame;
                ASSERT_EQ(columns[k * few.size() + i], expected) << frame;
            }
        }
    }
}

}  // namespace
}  // namespace earshot::visibility
