// SPDX-License-Identifier: MIT
// The paths of boxes by the lattice of their images against those that frusta find, bit for bit.
#include "earshot/frustum/brute_force.h"
#include "earshot/frustum/path_finder.h"

#include <gtest/gtest.h>

#include "frustum/meshed_scene.h"
#include "support/box_meshes.h"
#include <cmath>
#include <string>

namespace earshot::frustum {
namespace {

using geometry::Vec3;
using support::box_mesh;
using support::BoxShape;
using support::Dice;
using support::point_in;
using support::random_box;
using support::random_turn;

TraceResult find(const SceneView& scene,
                 const Vec3& source,
                 const std::vector<Vec3>& listeners,
                 TraceOptions options,
                 bool box_lattice) {
    options.box_lattice = box_lattice;
    const PathFinder finder(scene, {.trace = options});
    EXPECT_EQ(finder.is_box(), box_lattice);
    return finder.find(place_pairs(scene, source, listeners));
}

// Returns how many paths there are.
std::size_t expect_equal(const SceneView& scene,
                         const Vec3& source,
                         const std::vector<Vec3>& listeners,
                         const TraceOptions& options) {
    const auto frusta = find(scene, source, listeners, options, false);
    const auto lattice = find(scene, source, listeners, options, true);
    EXPECT_EQ(lattice.paths.size(), frusta.paths.size());
    EXPECT_EQ(lattice.paths, frusta.paths);
    return lattice.paths.size();
}

std::vector<Vec3> random_points(const BoxShape& shape, Dice& dice, int count) {
    std::vector<Vec3> points;
    for (int i = 0; i < count; ++i) {
        points.push_back(point_in(
            shape, {dice.between(0.02, 0.98), dice.between(0.02, 0.98), dice.between(0.02, 0.98)}));
    }
    return points;
}

std::size_t images_up_to(int order) {
    const auto n = static_cast<std::size_t>(order);
    return (2 * n + 1) * (2 * n * n + 2 * n + 3) / 3;
}

void expect_equal_in_random_boxes(std::uint64_t first, std::uint64_t end) {
    for (std::uint64_t seed = first; seed < end; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        Dice dice(seed);
        const BoxShape shape = random_box(seed, dice);
        const MeshedScene scene(box_mesh(shape, dice));
        const std::vector<Vec3> points = random_points(shape, dice, 3);
        for (int order = 0; order <= 6; ++order) {
            const std::size_t paths = expect_equal(
                scene.scene_view(), points[0], {points[1], points[2]}, {.max_order = order});
            if (shape.turn == glm::dmat3(1.0)) {
                EXPECT_EQ(paths, 2 * images_up_to(order));
            }
        }
    }
}

TEST(BoxLattice, GivesThePathsThatFrustaFind) {
    expect_equal_in_random_boxes(0, 6);
}

TEST(SlowBoxLattice, GivesThePathsThatFrustaFindInManyBoxes) {
    expect_equal_in_random_boxes(6, 100);
}

// Every wall from every other, in the order of sequences: shares neither the lattice nor frusta.
TEST(BoxLattice, GivesThePathsOfEverySequence) {
    for (std::uint64_t seed = 200; seed < 206; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        Dice dice(seed);
        const BoxShape shape = random_box(seed, dice);
        const MeshedScene scene(box_mesh(shape, dice));
        const std::vector<Vec3> points = random_points(shape, dice, 3);
        const std::vector<Vec3> listeners = {points[1], points[2]};
        EXPECT_EQ(
            find(scene.scene_view(), points[0], listeners, {.max_order = 4}, true).paths,
            find_specular_paths_brute_force(scene.scene_view(), points[0], listeners, 4).paths);
    }
}

// Lines between points in the middle of a room pass edges and corners exactly, where several orders
// of the walls make one path.
TEST(BoxLattice, DecidesEdgesAndCornersAsFrustaDo) {
    for (const bool is_turned : {false, true}) {
        for (const bool rounds : {false, true}) {
            SCOPED_TRACE(std::string(is_turned ? "turned" : "straight") +
                         (rounds ? ", rounded" : ""));
            Dice dice(17);
            BoxShape shape;
            shape.size = {8.0, 3.5, 6.0};
            shape.turn = is_turned ? random_turn(dice) : glm::dmat3(1.0);
            shape.rounds_to_float = rounds;
            const MeshedScene scene(box_mesh(shape, dice));
            const auto at = [&](double x, double y, double z) {
                return point_in(shape, {x, y, z});
            };
            for (const Vec3& source : {at(0.5, 0.5, 0.5), at(0.25, 0.5, 0.75)}) {
                expect_equal(scene.scene_view(),
                             source,
                             {at(0.5, 0.5, 0.5),
                              at(0.75, 0.5, 0.5),
                              at(0.25, 0.25, 0.25),
                              at(0.75, 0.75, 0.25),
                              at(0.125, 0.25, 0.5)},
                             {.max_order = 5});
            }
        }
    }
}

// Four edges and more in one path, up to three corners: many combinations of orders.
TEST(SlowBoxLattice, DecidesManyEdgesInOnePathAsFrustaDo) {
    for (const bool is_turned : {false, true}) {
        Dice dice(23);
        BoxShape shape;
        shape.size = {8.0, 3.5, 6.0};
        shape.corner = {1.0, -2.0, 0.5};
        shape.turn = is_turned ? random_turn(dice) : glm::dmat3(1.0);
        shape.cuts = {{{0.3}, {}, {0.6}}};
        const MeshedScene scene(box_mesh(shape, dice));
        for (const Vec3& source : {Vec3(0.5), Vec3(0.25, 0.75, 0.5)}) {
            for (const Vec3& listener : {Vec3(0.5), Vec3(0.25, 0.5, 0.5), Vec3(0.3, 0.5, 0.7)}) {
                expect_equal(scene.scene_view(),
                             point_in(shape, source),
                             {point_in(shape, listener)},
                             {.max_order = is_turned ? 7 : 9});
            }
        }
    }
}

// The line from an image passes an edge of the lattice by less than rounding, by less than the
// tolerance of files, and by more.
TEST(BoxLattice, DecidesNearEdgesAsFrustaDo) {
    for (std::uint64_t seed = 300; seed < 312; ++seed) {
        Dice dice(seed);
        const BoxShape shape = random_box(seed, dice);
        const MeshedScene scene(box_mesh(shape, dice));
        for (const double miss : {0.0, 1e-13, 1e-11, 1e-9, 1e-7, 1e-6, 4e-6, 2e-5, 1e-3}) {
            SCOPED_TRACE("seed " + std::to_string(seed) + ", miss " + std::to_string(miss));
            // In the plane of x and z: from the listener past the corner, and on to an image in
            // the cell beyond.
            const Vec3& size = shape.size;
            const Vec3 listener = {
                size.x * dice.between(0.3, 0.9), size.y * 0.4, size.z * dice.between(0.3, 0.9)};
            const Vec3 corner = {miss, size.y * 0.5, 0.0};
            const double on =
                dice.between(0.1, 0.9) * std::min(size.x / listener.x, size.z / listener.z);
            const Vec3 image = corner + on * (corner - listener);
            const Vec3 source = {-image.x, image.y, -image.z};
            const auto in_scene = [&](const Vec3& point) {
                return shape.corner + shape.turn * point;
            };
            expect_equal(
                scene.scene_view(), in_scene(source), {in_scene(listener)}, {.max_order = 4});
        }
    }
}

// Close to walls, on them, in edges and outside.
TEST(BoxLattice, DecidesPointsAtWallsAsFrustaDo) {
    for (std::uint64_t seed = 400; seed < 404; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        Dice dice(seed);
        BoxShape shape = random_box(seed, dice);
        const MeshedScene scene(box_mesh(shape, dice));
        std::vector<Vec3> points;
        for (const double height : {-0.5, 0.0, 1e-9, 1e-5, 1e-3}) {
            points.push_back(point_in(shape, {0.4, 0.0, 0.3}) +
                             shape.turn * Vec3(0.0, height, 0.0));
            points.push_back(point_in(shape, {0.0, 0.0, 0.7}) +
                             shape.turn * Vec3(height, height, 0.0));
        }
        points.push_back(point_in(shape, {0.3, 0.6, 0.45}));
        for (const Vec3& source :
             {point_in(shape, {0.7, 0.35, 0.6}), point_in(shape, {1.0, 0.4, 0.9})}) {
            expect_equal(scene.scene_view(), source, points, {.max_order = 4});
        }
    }
}

TEST(BoxLattice, KeepsLimitsAsFrustaDo) {
    Dice dice(5);
    const BoxShape shape = random_box(1, dice);
    const MeshedScene scene(box_mesh(shape, dice));
    const std::vector<Vec3> points = random_points(shape, dice, 2);
    const std::vector<double> factors = {0.9, 0.8, 0.7, 0.95, 0.6, 0.85};
    SceneView view = scene.scene_view();
    view.max_pressure_factor = factors;
    expect_equal(view, points[0], {points[1]}, {.max_order = 6, .max_length = 20.0});
    expect_equal(view, points[0], {points[1]}, {.max_order = 6, .min_pressure = 0.03});
    // The longest path itself is within the limit.
    const auto all = find(view, points[0], {points[1]}, {.max_order = 5}, true).paths;
    const double longest = all.back().length;
    EXPECT_EQ(find(view, points[0], {points[1]}, {.max_order = 5, .max_length = longest}, true)
                  .paths.size(),
              all.size());
    EXPECT_EQ(find(view,
                   points[0],
                   {points[1]},
                   {.max_order = 5, .max_length = std::nextafter(longest, 0.0)},
                   true)
                  .paths.size(),
              all.size() - 1);
}

TEST(BoxLattice, KeptTracesAndManyListenersGiveTheSame) {
    Dice dice(6);
    const BoxShape shape = random_box(3, dice);
    const MeshedScene scene(box_mesh(shape, dice));
    const std::vector<Vec3> points = random_points(shape, dice, 100);
    const PathFinder finder(scene.scene_view(), {.trace = {.max_order = 3}});
    const auto listeners = finder.trace_listeners(points);
    const auto found = finder.find(points[0], listeners);
    EXPECT_EQ(found.statistics.frusta, 0U);
    EXPECT_EQ(finder.connect(finder.trace_source(points[0]), listeners).paths, found.paths);
    Executor executor(3);
    EXPECT_EQ(finder.find(points[0], listeners, {}, executor).paths, found.paths);
    // Facets that may be first are a matter for frusta.
    const std::vector<std::uint8_t> every(6, 1);
    EXPECT_EQ(finder.find(points[0], listeners, every).paths, found.paths);
}

// Paths told without their points: in straight boxes, also where several have one length.
void expect_equal_arrivals(const SceneView& scene,
                           const Vec3& source,
                           const Vec3& listener,
                           const TraceOptions& options) {
    const PathFinder finder(scene, {.trace = options});
    const auto paths =
        finder.find(source, finder.trace_listeners(std::vector<Vec3>{listener})).paths;
    auto arrivals = finder.find_arrivals(source, listener);
    ASSERT_TRUE(arrivals.has_value());
    ASSERT_EQ(arrivals->lengths().size(), paths.size());
    for (std::size_t i = 0; i < paths.size(); ++i) {
        const SpecularPath& path = paths[i];
        EXPECT_EQ(arrivals->lengths()[i], path.length) << i;
        const PathArrival arrival = arrivals->at(i, true);
        EXPECT_EQ(arrival.order, path.triangles.size());
        EXPECT_EQ(arrival.last_point, path.points[path.points.size() - 2]) << i;
        ASSERT_EQ(arrival.facets.size(), path.triangles.size());
        for (std::size_t k = 0; k < path.triangles.size(); ++k) {
            EXPECT_EQ(arrival.facets[k], scene.facets.of_triangle[path.triangles[k]]);
        }
        EXPECT_EQ(arrivals->at(i, false).last_point, arrival.last_point);
    }
}

TEST(BoxArrivals, AreThePathsWithoutTheirPoints) {
    const std::vector<double> factors = {0.9, 0.8, 0.7, 0.95, 0.6, 0.85};
    for (std::uint64_t seed = 500; seed < 510; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        Dice dice(seed);
        BoxShape shape = random_box(seed, dice);
        shape.turn = glm::dmat3(1.0);
        const MeshedScene scene(box_mesh(shape, dice));
        SceneView view = scene.scene_view();
        view.max_pressure_factor = factors;
        for (const Vec3& listener : random_points(shape, dice, 2)) {
            const Vec3 source = random_points(shape, dice, 1).front();
            for (const int order : {0, 1, 2, 7, 12}) {
                expect_equal_arrivals(view, source, listener, {.max_order = order});
            }
            expect_equal_arrivals(view, source, listener, {.max_order = 9, .max_length = 25.0});
            expect_equal_arrivals(view, source, listener, {.max_order = 6, .min_pressure = 0.02});
        }
        const Vec3 middle = point_in(shape, Vec3(0.5));
        expect_equal_arrivals(view, middle, middle, {.max_order = 5});
        expect_equal_arrivals(view, middle, point_in(shape, {0.25, 0.5, 0.5}), {.max_order = 6});
        expect_equal_arrivals(view, point_in(shape, {0.7, 1e-5, 0.2}), middle, {.max_order = 6});
    }
}

TEST(BoxArrivals, AreNotToldOfTurnedBoxesAndPointsOutside) {
    Dice dice(9);
    BoxShape shape = random_box(3, dice);
    const MeshedScene turned(box_mesh(shape, dice));
    const std::vector<Vec3> points = random_points(shape, dice, 2);
    EXPECT_TRUE(PathFinder(turned.scene_view()).is_box());
    EXPECT_FALSE(PathFinder(turned.scene_view()).find_arrivals(points[0], points[1]));
    shape.turn = glm::dmat3(1.0);
    const MeshedScene straight(box_mesh(shape, dice));
    const PathFinder finder(straight.scene_view(), {.max_radius = 100.0});
    EXPECT_FALSE(finder.find_arrivals(point_in(shape, Vec3(0.5)), point_in(shape, Vec3(1.5))));
}

bool is_box(const SceneView& scene) {
    return PathFinder(scene).is_box();
}

struct Room {
    Dice dice{1};
    geometry::Mesh mesh;
    Room() {
        BoxShape shape;
        shape.size = {8.0, 3.0, 6.0};
        mesh = box_mesh(shape, dice);
    }
    void add(const std::array<Vec3, 4>& corners) {
        const auto first = static_cast<geometry::VertexId>(mesh.positions.size());
        mesh.positions.insert(mesh.positions.end(), corners.begin(), corners.end());
        mesh.triangles.push_back({first, first + 1, first + 2});
        mesh.triangles.push_back({first, first + 2, first + 3});
    }
    bool is_box() const { return frustum::is_box(MeshedScene(mesh).scene_view()); }
};

TEST(BoxRoom, ARoomWithAnythingElseInItIsNone) {
    EXPECT_TRUE(Room().is_box());
    Room table;
    table.add({Vec3(2, 0.7, 2), Vec3(3, 0.7, 2), Vec3(3, 0.7, 3), Vec3(2, 0.7, 3)});
    EXPECT_FALSE(table.is_box());
    Room poster;
    poster.add({Vec3(2, 1, 0), Vec3(3, 1, 0), Vec3(3, 2, 0), Vec3(2, 2, 0)});
    EXPECT_FALSE(poster.is_box());
    Room doubled;
    doubled.add({Vec3(0, 0, 0), Vec3(0, 3, 0), Vec3(0, 3, 6), Vec3(0, 0, 6)});
    doubled.mesh.triangles.back() = {24, 25, 27};  // along the other diagonal
    doubled.mesh.triangles.push_back({25, 26, 27});
    EXPECT_FALSE(doubled.is_box());
}

TEST(BoxRoom, ARoomWithAnOpenWallIsNone) {
    Room open;
    open.mesh.triangles.pop_back();
    EXPECT_FALSE(open.is_box());
    // Six walls, but one stands in the room.
    Room screen;
    screen.mesh.triangles.resize(screen.mesh.triangles.size() - 2);
    screen.add({Vec3(0, 0, 4), Vec3(8, 0, 4), Vec3(8, 3, 4), Vec3(0, 3, 4)});
    EXPECT_FALSE(screen.is_box());
    // A door ajar: a wall with a hole, and the door.
    Room door;
    door.mesh.triangles.resize(door.mesh.triangles.size() - 2);
    door.add({Vec3(0, 0, 6), Vec3(7, 0, 6), Vec3(7, 3, 6), Vec3(0, 3, 6)});
    door.add({Vec3(7, 0, 6), Vec3(7.9, 0, 5.9), Vec3(7.9, 3, 5.9), Vec3(7, 3, 6)});
    EXPECT_FALSE(door.is_box());
}

TEST(BoxRoom, WallsMustBeWholeAndReflectInside) {
    Room room;
    std::vector<std::uint32_t> labels(room.mesh.triangles.size(), 0);
    labels[3] = 1;
    EXPECT_FALSE(is_box(MeshedScene(room.mesh, labels).scene_view()));
    labels[2] = 1;  // the other half of the wall
    EXPECT_TRUE(is_box(MeshedScene(room.mesh, labels).scene_view()));

    const MeshedScene scene(room.mesh);
    SceneView view = scene.scene_view();
    std::vector<std::uint8_t> flags(6, 0);
    view.transmissive = flags;
    EXPECT_TRUE(is_box(view));
    flags[2] = 1;
    EXPECT_FALSE(is_box(view));
    view.transmissive = {};
    const std::vector<std::uint8_t> one_sided(6, 1);
    view.one_sided = one_sided;
    EXPECT_TRUE(is_box(view));
    for (geometry::Triangle& triangle : room.mesh.triangles) {
        std::swap(triangle[0], triangle[1]);
    }
    const MeshedScene reversed(room.mesh);
    SceneView from_outside = reversed.scene_view();
    EXPECT_TRUE(is_box(from_outside));
    from_outside.one_sided = one_sided;
    EXPECT_FALSE(is_box(from_outside));
}

TEST(BoxRoom, ALeaningWallMakesNone) {
    for (const double lean : {1e-3, 0.1}) {
        Room room;
        for (Vec3& point : room.mesh.positions) {
            point.x += point.x > 4.0 ? lean * point.y : 0.0;
        }
        EXPECT_FALSE(room.is_box());
    }
}

}  // namespace
}  // namespace earshot::frustum
