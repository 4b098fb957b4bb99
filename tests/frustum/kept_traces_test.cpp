// SPDX-License-Identifier: MIT
//
// Beam trees and verdicts that are kept while a part of the scene moves. The oracle is a search
// that has never seen another instant, by frusta or over all sequences.

#include "earshot/frustum/brute_force.h"
#include "earshot/frustum/find_specular_paths.h"
#include "earshot/frustum/path_finder.h"

#include <gtest/gtest.h>

#include "frustum/moving_room.h"
#include <algorithm>
#include <memory>
#include <optional>

namespace earshot::frustum {
namespace {

using geometry::Vec3;

constexpr Surface kSurfaces[] = {
    Surface::plain, Surface::one_sided, Surface::transmissive, Surface::quiet};

/// A room by its seed: boxes that stay, and what moves.
class Stage {
public:
    explicit Stage(std::uint64_t seed) : seed_(seed) {
        size_ = {uniform(0, 0, 4, 8), uniform(0, 1, 2.5, 4), uniform(0, 2, 4, 8)};
        source = point(1);
        listeners = {point(2), point(3)};
        if (seed_ % 4 == 1) {
            // As close to what moves as it gets, and in the plane of one of its faces.
            listeners.push_back(part_origin(2) + Vec3(-1e-3, 0.1, 0.1));
            listeners.push_back(part_origin(0) + Vec3(-0.3, 0.0, -0.2));
        }
    }

    std::unique_ptr<MovingRoom> at(int step) const {
        auto room = std::make_unique<MovingRoom>();
        room->add_box(
            Vec3(0.0), {size_.x, 0, 0}, {0, size_.y, 0}, {0, 0, size_.z}, Surface::plain, true);
        for (std::uint64_t box = 0; box < 3 + seed_ % 3; ++box) {
            const double angle = seed_ % 2 == 0 ? uniform(20 + box, 3, 0, 6) : 0.0;
            room->add_box(
                point(10 + box),
                uniform(20 + box, 0, 0.1, 1.2) * Vec3(std::cos(angle), 0, std::sin(angle)),
                {0, uniform(20 + box, 1, 0.1, 1.2), 0},
                uniform(20 + box, 2, 0.1, 1.2) * Vec3(-std::sin(angle), 0, std::cos(angle)),
                surface(30 + box));
        }
        seed_ % 3 == 0 ? add_curtain(*room, step) : add_part(*room, step);
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
               size_;
    }
    Surface surface(std::uint64_t stream) const {
        return kSurfaces[random_bits(seed_, stream, 0) % std::size(kSurfaces)];
    }
    Vec3 part_origin(int step) const {
        const double t = 0.17 * step;
        const Vec3 centre = 0.4 * size_;
        return centre +
               Vec3(std::cos(3.0 * t + double(seed_ % 7)), 0.3 * std::sin(t), std::sin(3.0 * t)) *
                   (0.3 * size_);
    }

    /// A box on its way. It rests at some steps, turns at others, and leaves the room for a while.
    void add_part(MovingRoom& room, int step) const {
        const int move = step / 2 * 2;  // rests at odd steps
        const double angle = seed_ % 2 == 0 ? 0.4 * move : 0.0;
        Vec3 origin = part_origin(move);
        if (seed_ % 5 == 3 && move % 6 == 4) {
            origin.y = size_.y + 0.3;  // above the ceiling; the room's extent is another then
        }
        room.add_box(origin,
                     0.5 * Vec3(std::cos(angle), 0, std::sin(angle)),
                     {0, 0.8, 0},
                     0.4 * Vec3(-std::sin(angle), 0, std::cos(angle)),
                     surface(40));
    }

    /// A sheet of three by two quads, which are one facet, or several, or twelve triangles.
    void add_curtain(MovingRoom& room, int step) const {
        const auto at = [&](int i, int j) {
            const double bend = step % 3 == 0 ? 0.0 : 0.2 * std::sin(1.3 * i + step);
            const double twist = step % 3 == 2 ? 0.1 * j * i : 0.0;
            return Vec3(0.35 * size_.x + bend + twist + 0.05 * step, 0.8 * j, 0.2 + 0.7 * i);
        };
        for (int i = 0; i < 3; ++i) {
            for (int j = 0; j < 2; ++j) {
                room.add_quad(at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1), surface(40));
            }
        }
    }

    std::uint64_t seed_;
    Vec3 size_{0.0};
};

struct Way {
    bool forward_only;
    std::size_t listener_count;
};
constexpr Way kWays[] = {{false, 1}, {false, 1000}, {true, 1}};

/// Follows a stage through some steps; work of all, kept and fresh.
TraceStatistics follow(std::uint64_t seed, const Way& way, int order, int steps) {
    const Stage stage(seed);
    FinderOptions options{.trace = {.max_order = order},
                          .forward_only = way.forward_only,
                          .listener_count = way.listener_count,
                          .track_changes = true};
    const bool has_limits = seed % 6 == 5;
    if (has_limits) {
        options.trace.max_length = 9.0;
        options.trace.min_pressure = 0.06;
    }
    std::unique_ptr<MovingRoom> room = stage.at(0);
    PathFinder finder(room->scene_view(), options);
    SourceBeamTree source = finder.trace_source(stage.source);
    ListenerBeamTree listeners = finder.trace_listeners(stage.listeners);
    KeptVerdicts verdicts;
    TraceStatistics work;
    for (int step = 0; step < steps; ++step) {
        if (step > 0) {
            room = stage.at(step);  // and the one before is no more
            finder.move_to(room->scene_view(), options, 100.0);
            finder.update(source);
            finder.update(listeners);
            work.frusta += source.frusta() - source.kept_frusta() + listeners.frusta() -
                           listeners.kept_frusta();
            work.kept_frusta += source.kept_frusta() + listeners.kept_frusta();
        }
        const TraceResult kept = finder.connect(source, listeners, verdicts);
        const TraceResult fresh =
            find_specular_paths(room->scene_view(), stage.source, stage.listeners, options.trace);
        EXPECT_EQ(kept.paths, fresh.paths)
            << "seed " << seed << ", step " << step << ", listeners " << way.listener_count
            << ", forward " << way.forward_only;
        if (order < 3 && !has_limits) {
            const TraceResult all = find_specular_paths_brute_force(
                room->scene_view(), stage.source, stage.listeners, order);
            EXPECT_EQ(kept.paths, all.paths) << "seed " << seed << ", step " << step;
        }
        if (step > 0) {
            work += kept.statistics;
        }
        // Nothing has moved since: nothing is verified.
        const TraceResult again = finder.connect(source, listeners, verdicts);
        EXPECT_EQ(again.paths, kept.paths);
        EXPECT_EQ(again.statistics.candidates, 0U);
    }
    return work;
}

TEST(KeptTraces, PathsWhileOnePartMovesAreThoseOfAFreshSearch) {
    TraceStatistics work;
    for (std::uint64_t seed = 0; seed < 24; ++seed) {
        for (const Way& way : kWays) {
            work += follow(seed, way, 2 + static_cast<int>(seed % 2), 7);
        }
    }
    EXPECT_GT(work.kept_frusta, work.frusta);
    EXPECT_GT(work.kept_candidates, work.candidates);
    EXPECT_GT(work.paths, 1000U);
}

TEST(SlowKeptTraces, PathsInManyRoomsAreThoseOfAFreshSearch) {
    for (std::uint64_t seed = 100; seed < 140; ++seed) {
        for (const Way& way : kWays) {
            follow(seed, way, 3, 9);
            if (HasFailure()) {
                return;
            }
        }
    }
}

}  // namespace
}  // namespace earshot::frustum
