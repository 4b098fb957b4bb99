// SPDX-License-Identifier: MIT
//
// Connections that are kept while many parts of the scene move, come in the way, and leave. The
// oracle is a search that has never seen another instant.

#include "earshot/frustum/internal/kept_connections.h"

#include "earshot/frustum/brute_force.h"
#include "earshot/frustum/find_specular_paths.h"
#include "earshot/frustum/path_finder.h"

#include <gtest/gtest.h>

#include "frustum/moving_room.h"
#include <array>
#include <memory>

namespace earshot::frustum {
namespace {

using geometry::Vec3;

constexpr Vec3 kSize = {7.0, 3.0, 6.0};
constexpr Surface kSurfaces[] = {
    Surface::plain, Surface::one_sided, Surface::transmissive, Surface::quiet};

/// A room of boxes, each of which rests, walks, turns, jumps between source and listener, or stands
/// in a corner behind all others.
class Crowd {
public:
    Crowd(std::uint64_t seed, std::uint64_t boxes, double share_that_moves)
        : seed_(seed), boxes_(boxes), share_(share_that_moves) {
        source = point(1);
        // Two of them in one place.
        listeners = {point(2), point(3), point(2)};
    }

    std::unique_ptr<MovingRoom> at(std::uint64_t step) const {
        auto room = std::make_unique<MovingRoom>();
        room->add_box(
            Vec3(0.0), {kSize.x, 0, 0}, {0, kSize.y, 0}, {0, 0, kSize.z}, Surface::plain, true);
        for (std::uint64_t box = 0; box < boxes_; ++box) {
            // The last step at which it moved tells where it is.
            std::uint64_t moved = step;
            while (moved > 0 && random_between(seed_, 100 + box, moved, 0.0, 1.0) >= share_) {
                --moved;
            }
            add_box(*room, box, moved);
        }
        room->finish();
        return room;
    }

    Vec3 source{0.0};
    std::vector<Vec3> listeners;

private:
    double uniform(std::uint64_t stream, std::uint64_t i, double low, double high) const {
        return random_between(seed_, stream, i, low, high);
    }
    Vec3 point(std::uint64_t stream) const {
        return Vec3(uniform(stream, 10, 0.05, 0.95),
                    uniform(stream, 11, 0.05, 0.9),
                    uniform(stream, 12, 0.05, 0.95)) *
               kSize;
    }

    void add_box(MovingRoom& room, std::uint64_t box, std::uint64_t step) const {
        const std::uint64_t stream = 1000 + 50 * step + box;
        const double width = uniform(20 + box, 0, 0.1, 0.9);
        const double depth = uniform(20 + box, 1, 0.1, 0.9);
        const double height = uniform(20 + box, 2, 0.2, 1.5);
        Vec3 origin = point(stream);
        double angle = 0.0;
        switch (random_bits(seed_, stream, 0) % 4) {
            case 0:
                angle = uniform(stream, 1, 0.0, 6.0);
                break;
            case 1:
                origin = 0.5 * (source + listeners[box % 2]) - 0.5 * Vec3(width, height, depth);
                break;
            case 2:
                origin = Vec3(0.02 + 0.01 * double(box), 0.02, 0.02);
                break;
            default:
                break;
        }
        room.add_box(origin,
                     width * Vec3(std::cos(angle), 0, std::sin(angle)),
                     {0, height, 0},
                     depth * Vec3(-std::sin(angle), 0, std::cos(angle)),
                     kSurfaces[random_bits(seed_, 40 + box, 0) % std::size(kSurfaces)]);
    }

    std::uint64_t seed_;
    std::uint64_t boxes_;
    double share_;
};

/// Of all steps.
struct Work {
    std::size_t connections = 0, kept_connections = 0, paths = 0;
};

Work follow(const Crowd& crowd, int order, std::size_t listener_count, std::uint64_t steps) {
    const FinderOptions options{
        .trace = {.max_order = order}, .listener_count = listener_count, .track_changes = true};
    std::unique_ptr<MovingRoom> room = crowd.at(0);
    PathFinder finder(room->scene_view(), options);
    SourceBeamTree source = finder.trace_source(crowd.source);
    ListenerBeamTree listeners = finder.trace_listeners(crowd.listeners);
    KeptVerdicts verdicts;
    finder.connect(source, listeners, verdicts);
    EXPECT_EQ(verdicts.kept_connections(), 0U);
    Work work;
    for (std::uint64_t step = 1; step < steps; ++step) {
        room = crowd.at(step);
        finder.move_to(room->scene_view(), options, 100.0);
        finder.update(source);
        finder.update(listeners);
        const TraceResult kept = finder.connect(source, listeners, verdicts);
        const TraceResult fresh =
            find_specular_paths(room->scene_view(), crowd.source, crowd.listeners, options.trace);
        EXPECT_EQ(kept.paths, fresh.paths) << "step " << step;
        if (order < 3) {
            EXPECT_EQ(kept.paths,
                      find_specular_paths_brute_force(
                          room->scene_view(), crowd.source, crowd.listeners, order)
                          .paths)
                << "step " << step;
        }
        work.connections += verdicts.connections();
        work.kept_connections += verdicts.kept_connections();
        work.paths += kept.paths.size();
        // Nothing has moved since.
        EXPECT_EQ(finder.connect(source, listeners, verdicts).paths, kept.paths);
        EXPECT_EQ(verdicts.kept_connections(), verdicts.connections());
    }
    return work;
}

TEST(Connections, AreFoundByTheVisibleFacet) {
    Connections first, all;
    first.add(std::array<std::uint32_t, 2>{7, 5}, 1);
    first.add({}, 0);
    all.add(std::array<std::uint32_t, 1>{3}, 1);
    all.append(first);
    ASSERT_EQ(all.of(0).size(), 1U);
    EXPECT_EQ(all.of(0)[0], 3U);
    ASSERT_EQ(all.of(1).size(), 2U);
    EXPECT_EQ(all.of(1)[0], 7U);
    EXPECT_EQ(all.of(1)[1], 5U);
    EXPECT_TRUE(all.of(2).empty());
    EXPECT_EQ(all.size(), 3U);
    EXPECT_EQ(all.kept(), 2U);
}

TEST(KeptConnections, PathsWhileManyPartsMoveAreThoseOfAFreshSearch) {
    std::size_t paths = 0;
    for (std::uint64_t seed = 0; seed < 8; ++seed) {
        const Crowd crowd(seed, 6, seed % 2 == 0 ? 0.2 : 0.7);
        for (const std::size_t listener_count : {std::size_t{1}, std::size_t{1000}}) {
            SCOPED_TRACE(seed);
            paths += follow(crowd, 2 + static_cast<int>(seed % 3), listener_count, 8).paths;
        }
    }
    EXPECT_GT(paths, 1000U);
}

TEST(KeptConnections, MostAreTakenOverWhereFewPartsMove) {
    const Work work = follow(Crowd(31, 10, 0.05), 3, 1, 12);
    EXPECT_GT(work.connections, 1000U);
    EXPECT_GT(10 * work.kept_connections, 7 * work.connections);
}

TEST(KeptConnections, OfAnEmitterThatHasMovedNoneIsTakenOver) {
    const Crowd crowd(5, 4, 0.3);
    const FinderOptions options{.trace = {.max_order = 3}, .track_changes = true};
    std::unique_ptr<MovingRoom> room = crowd.at(0);
    PathFinder finder(room->scene_view(), options);
    SourceBeamTree source = finder.trace_source(crowd.source);
    ListenerBeamTree listeners = finder.trace_listeners(crowd.listeners);
    KeptVerdicts verdicts;
    finder.connect(source, listeners, verdicts);
    std::vector<Vec3> places = crowd.listeners;
    places[1] += Vec3(0.01, 0.0, 0.02);
    listeners = finder.trace_listeners(places);
    EXPECT_EQ(finder.connect(source, listeners, verdicts).paths,
              find_specular_paths(room->scene_view(), crowd.source, places, options.trace).paths);
    EXPECT_EQ(verdicts.kept_connections(), 0U);
    EXPECT_GT(verdicts.connections(), 0U);
}

TEST(SlowKeptConnections, PathsInManyCrowdsAreThoseOfAFreshSearch) {
    for (std::uint64_t seed = 100; seed < 130; ++seed) {
        for (const std::size_t listener_count : {std::size_t{1}, std::size_t{1000}}) {
            SCOPED_TRACE(seed);
            follow(Crowd(seed, 8, 0.1 * double(seed % 10)), 3 + int(seed % 2), listener_count, 20);
            if (HasFailure()) {
                return;
            }
        }
    }
}

}  // namespace
}  // namespace earshot::frustum
