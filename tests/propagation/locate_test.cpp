// SPDX-License-Identifier: MIT
// Positions from arrival times whose truth is known: times by images in a box, in closed form.
#include "earshot/propagation/locate.h"

#include "earshot/base/error.h"
#include "earshot/base/random.h"
#include "earshot/geometry/vector.h"
#include "earshot/propagation/internal/arrival_model.h"
#include "earshot/propagation/least_squares.h"
#include "earshot/propagation/room_shapes.h"

#include <gtest/gtest.h>

#include "support/random_normal.h"
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace earshot::propagation {
namespace {

using geometry::Vec3;
using test::random_normal;

const Vec3 kSize(6.0, 2.8, 4.5);

/// The walls of shoebox_room(): name, axis, and whether at its upper end.
struct BoxWall {
    const char* name;
    int axis;
    bool is_upper;
};
constexpr std::array<BoxWall, 6> kBoxWalls = {{{"floor", 1, false},
                                               {"ceiling", 1, true},
                                               {"north", 2, false},
                                               {"east", 0, true},
                                               {"south", 2, true},
                                               {"west", 0, false}}};

/// What is true, and what is stated of it.
struct Truth {
    std::vector<Vec3> sources, listeners;
    double speed = 343.0;
    std::vector<double> latencies;
    std::array<double, 6> wall_moves{};  ///< along +x, +y, +z, metres
};

Vec3 random_point(std::uint64_t seed, std::uint64_t index) {
    return {random_between(seed, 10, 3 * index, 0.7, kSize.x - 0.7),
            random_between(seed, 10, 3 * index + 1, 0.7, kSize.y - 0.7),
            random_between(seed, 10, 3 * index + 2, 0.7, kSize.z - 0.7)};
}

Truth random_truth(std::uint64_t seed, std::size_t sources, std::size_t listeners) {
    Truth truth;
    for (std::size_t i = 0; i < sources; ++i) {
        truth.sources.push_back(random_point(seed, i));
        truth.latencies.push_back(0.0);
    }
    for (std::size_t i = 0; i < listeners; ++i) {
        truth.listeners.push_back(random_point(seed, 100 + i));
    }
    return truth;
}

/// The room with sources and listeners that are stated wrongly by normal errors.
Scene stated_scene(const Truth& truth,
                   std::uint64_t seed,
                   double source_error,
                   double listener_error) {
    Scene scene = shoebox_room(kSize);
    std::uint64_t index = 0;
    const auto off = [&](const Vec3& point, double error) {
        Vec3 stated = point;
        for (int axis = 0; axis < 3; ++axis) {
            stated[axis] += error * random_normal(seed, 20, index++);
        }
        return stated;
    };
    for (const Vec3& source : truth.sources) {
        scene.sources.push_back({.name = "s", .position = off(source, source_error)});
    }
    for (const Vec3& listener : truth.listeners) {
        scene.listeners.push_back({.name = "l", .position = off(listener, listener_error)});
    }
    return scene;
}

/// The direct sound and six reflections of every pair, with normal errors.
std::vector<MeasuredArrival> arrivals_of(const Truth& truth,
                                         std::uint64_t seed,
                                         double timing_error) {
    std::vector<MeasuredArrival> arrivals;
    for (std::size_t s = 0; s < truth.sources.size(); ++s) {
        for (std::size_t l = 0; l < truth.listeners.size(); ++l) {
            const auto add = [&](const Vec3& image, std::vector<std::string> surfaces) {
                const Vec3 way = truth.listeners[l] - image;
                const double noise = timing_error * random_normal(seed, 30, arrivals.size());
                arrivals.push_back({.source = s,
                                    .listener = l,
                                    .time = std::sqrt(glm::dot(way, way)) / truth.speed +
                                            truth.latencies[s] + noise,
                                    .surfaces = std::move(surfaces)});
            };
            add(truth.sources[s], {});
            for (std::size_t w = 0; w < kBoxWalls.size(); ++w) {
                const BoxWall& wall = kBoxWalls[w];
                const double plane = (wall.is_upper ? kSize[wall.axis] : 0.0) + truth.wall_moves[w];
                Vec3 image = truth.sources[s];
                image[wall.axis] = 2.0 * plane - image[wall.axis];
                add(image, {wall.name});
            }
        }
    }
    return arrivals;
}

/// How many true values lie in intervals of 95 %, and how far they are off at most.
struct Coverage {
    int inside = 0, all = 0;
    double largest = 0.0;  ///< in standard errors

    void add(const LocatedValue& value, double truth) {
        inside += truth >= value.lower() && truth <= value.upper() ? 1 : 0;
        ++all;
        largest = std::max(largest, std::abs(truth - value.value) / value.standard_error);
    }
    void add(const LocateResult& result, const Truth& truth) {
        for (std::size_t i = 0; i < truth.sources.size(); ++i) {
            add(result.sources[i].x, truth.sources[i].x);
            add(result.sources[i].y, truth.sources[i].y);
            add(result.sources[i].z, truth.sources[i].z);
        }
        for (std::size_t i = 0; i < truth.listeners.size(); ++i) {
            add(result.listeners[i].x, truth.listeners[i].x);
            add(result.listeners[i].y, truth.listeners[i].y);
            add(result.listeners[i].z, truth.listeners[i].z);
        }
        add(result.speed_of_sound, truth.speed);
    }
    double share() const { return static_cast<double>(inside) / all; }
};

class Locate : public testing::Test {
protected:
    void SetUp() override {
        if (!least_squares_available()) {
            GTEST_SKIP() << "built without Ceres' headers";
        }
    }
};

double distance(const LocatedPoint& point, const Vec3& truth) {
    return glm::distance(point.position(), truth);
}

const LocateOptions kExactTimes = {.timing_error = 1e-6};

/// 3 sources and 5 listeners, stated to 1 cm, and the temperature to 2 K.
TEST_F(Locate, IntervalsHoldTheTruthAsOftenAsTheySay) {
    Coverage coverage;
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        Truth truth = random_truth(seed, 3, 5);
        truth.speed = speed_of_sound({.temperature_c = 20.0 + 2.0 * random_normal(seed, 40, 0)});
        const LocateOptions options;
        const LocateResult result = locate(stated_scene(truth, seed, 0.01, 0.01),
                                           arrivals_of(truth, seed, options.timing_error),
                                           options);
        EXPECT_TRUE(result.converged);
        EXPECT_LT(result.median_after, result.median_before);
        coverage.add(result, truth);
    }
    EXPECT_EQ(coverage.all, 500);
    EXPECT_GE(coverage.share(), 0.92);
    EXPECT_LE(coverage.share(), 0.98);
    EXPECT_LT(coverage.largest, 4.0);
}

/// A tenth of the times are those of something else.
TEST_F(Locate, TakesOutliersForWhatTheyAre) {
    Coverage coverage;
    double largest = 0.0;
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        Truth truth = random_truth(seed, 3, 5);
        truth.speed = speed_of_sound({});
        const LocateOptions options = {.temperature_error = 0.0};
        std::vector<MeasuredArrival> arrivals = arrivals_of(truth, seed, options.timing_error);
        for (std::size_t i = 0; i < arrivals.size(); ++i) {
            if (random(seed, 50, i) < 0.1) {
                arrivals[i].time += random_between(seed, 51, i, 0.5e-3, 5e-3);
            }
        }
        const LocateResult result =
            locate(stated_scene(truth, seed, 0.01, 0.01), arrivals, options);
        for (std::size_t i = 0; i < truth.listeners.size(); ++i) {
            for (const auto& [value, exact] :
                 {std::pair(result.listeners[i].x, truth.listeners[i].x),
                  std::pair(result.listeners[i].y, truth.listeners[i].y),
                  std::pair(result.listeners[i].z, truth.listeners[i].z)}) {
                coverage.add(value, exact);
            }
            largest = std::max(largest, distance(result.listeners[i], truth.listeners[i]));
        }
    }
    EXPECT_GE(coverage.share(), 0.92);
    EXPECT_LT(coverage.largest, 4.5);
    EXPECT_LT(largest, 0.03);
}

TEST_F(Locate, FindsTheSameWithoutNamesOfSurfaces) {
    const Truth truth = random_truth(3, 2, 4);
    const Scene scene = stated_scene(truth, 3, 0.01, 0.01);
    std::vector<MeasuredArrival> arrivals = arrivals_of(truth, 3, 0.0);
    const LocateResult labelled = locate(scene, arrivals, kExactTimes);
    for (MeasuredArrival& arrival : arrivals) {
        arrival.surfaces.reset();
    }
    std::reverse(arrivals.begin(), arrivals.end());
    const LocateResult result = locate(scene, arrivals, kExactTimes);
    EXPECT_EQ(result.matched, arrivals.size());
    EXPECT_EQ(result.specular_order, 1);
    for (std::size_t i = 0; i < truth.listeners.size(); ++i) {
        EXPECT_LT(distance(result.listeners[i], labelled.listeners[i].position()), 2e-4);
    }
}

/// What no path is near to is left out.
TEST_F(Locate, LeavesOutArrivalsThatNothingExplains) {
    const Truth truth = random_truth(4, 2, 4);
    const Scene scene = stated_scene(truth, 4, 0.01, 0.01);
    std::vector<MeasuredArrival> arrivals = arrivals_of(truth, 4, 0.0);
    arrivals.push_back({.source = 1, .listener = 2, .time = 0.09});
    arrivals.push_back(
        {.source = 1, .listener = 2, .time = 0.01, .surfaces = {{"floor", "floor"}}});
    const LocateResult result = locate(scene, arrivals, kExactTimes);
    EXPECT_EQ(result.matched, arrivals.size() - 2);
    EXPECT_FALSE(result.arrivals[arrivals.size() - 2].is_matched);
    EXPECT_FALSE(result.arrivals.back().is_matched);
    EXPECT_EQ(result.arrivals.back().weight, 0.0);
    EXPECT_EQ(result.listeners[2].arrivals, 14U);
}

/// Sources start late by up to 30 ms, walls are off by up to 2 cm.
TEST_F(Locate, FindsLatenciesAndWalls) {
    for (const bool is_labelled : {true, false}) {
        Truth truth = random_truth(5, 3, 5);
        truth.latencies = {0.030, 0.004, 0.0};
        truth.wall_moves = {0.0, 0.015, -0.01, 0.02, 0.0, 0.005};
        std::vector<MeasuredArrival> arrivals = arrivals_of(truth, 5, 1e-6);
        if (!is_labelled) {
            for (MeasuredArrival& arrival : arrivals) {
                arrival.surfaces.reset();
            }
        }
        LocateOptions options = kExactTimes;
        options.latency_error = 0.05;
        options.wall_error = 0.01;
        options.source_error = options.listener_error = 1e-4;
        const LocateResult result = locate(stated_scene(truth, 5, 1e-4, 1e-4), arrivals, options);
        EXPECT_EQ(result.matched, arrivals.size());
        for (std::size_t i = 0; i < truth.latencies.size(); ++i) {
            EXPECT_NEAR(result.latencies[i].value, truth.latencies[i], 5e-6) << i;
            EXPECT_EQ(result.latencies[i].data_share, 1.0);
        }
        ASSERT_EQ(result.walls.size(), 6U);
        for (const LocatedWall& wall : result.walls) {
            // Materials stand in the order of kBoxWalls.
            EXPECT_NEAR(
                wall.offset.value - wall.offset.stated, truth.wall_moves[wall.material], 3e-4)
                << wall.material;
            EXPECT_EQ(wall.arrivals, 15U);
        }
    }
}

/// A microphone that was put down anywhere.
TEST_F(Locate, FindsListenersOfWhichNothingIsKnown) {
    const Truth truth = random_truth(6, 3, 4);
    Scene scene = stated_scene(truth, 6, 0.0, 0.2);
    const LocateResult result = locate(scene,
                                       arrivals_of(truth, 6, 1e-6),
                                       {.source_error = 0.0,
                                        .listener_error = std::numeric_limits<double>::infinity(),
                                        .temperature_error = 10.0,
                                        .timing_error = 1e-6});
    EXPECT_TRUE(result.converged);
    EXPECT_NEAR(result.speed_of_sound.value, truth.speed, 0.05);
    EXPECT_TRUE(result.motions.empty());  // the sources are held
    for (std::size_t i = 0; i < truth.listeners.size(); ++i) {
        EXPECT_LT(distance(result.listeners[i], truth.listeners[i]), 1.5e-3);
        EXPECT_EQ(result.listeners[i].x.data_share, 1.0);
    }
    EXPECT_EQ(result.sources[0].x.standard_error, 0.0);
    EXPECT_EQ(result.sources[0].position(), result.sources[0].stated());
}

/// Direct sound alone tells no place in the room: what is stated does. A listener that was not
/// measured stays.
TEST_F(Locate, SaysWhatTheArrivalsDoNotTell) {
    const Truth truth = random_truth(7, 4, 6);
    const Scene scene = stated_scene(truth, 7, 0.01, 0.01);
    std::vector<MeasuredArrival> direct, all;
    for (const MeasuredArrival& arrival : arrivals_of(truth, 7, 0.0)) {
        if (arrival.listener != 5) {
            all.push_back(arrival);
            if (arrival.surfaces->empty()) {
                direct.push_back(arrival);
            }
        }
    }
    const LocateResult alone = locate(scene, direct, kExactTimes);
    ASSERT_EQ(alone.motions.size(), 7U);
    EXPECT_EQ(alone.motions[0].name, "translation x");
    EXPECT_EQ(alone.motions[5].name, "rotation z");
    EXPECT_EQ(alone.motions[6].name, "scale");
    for (const CommonMotion& motion : alone.motions) {
        EXPECT_FALSE(motion.is_told_by_data()) << motion.name;
    }
    EXPECT_EQ(alone.listeners[5].arrivals, 0U);
    EXPECT_EQ(alone.listeners[5].y.data_share, 0.0);
    EXPECT_NEAR(alone.listeners[5].y.standard_error, 0.01, 1e-9);
    EXPECT_NEAR(alone.listeners[5].y.value, alone.listeners[5].y.stated, 1e-4);

    const LocateResult with_walls = locate(scene, all, kExactTimes);
    for (const CommonMotion& motion : with_walls.motions) {
        EXPECT_TRUE(motion.is_told_by_data()) << motion.name;
    }
    // Walls that may move with all the rest leave it open again where the rest is.
    LocateOptions loose = kExactTimes;
    loose.wall_error = 0.01;
    const LocateResult moving = locate(scene, all, loose);
    for (std::size_t i = 0; i < moving.motions.size(); ++i) {
        const CommonMotion& motion = moving.motions[i];
        const bool is_rotation = motion.name.starts_with("rotation");
        EXPECT_EQ(motion.is_told_by_data(), is_rotation) << motion.name;
    }
}

TEST_F(Locate, PredictsArrivalsThatWereLeftOut) {
    const Truth truth = random_truth(8, 3, 6);
    const Scene scene = stated_scene(truth, 8, 0.01, 0.01);
    const std::vector<MeasuredArrival> arrivals = arrivals_of(truth, 8, 4e-5);
    const double before = locate(scene, arrivals).median_before;
    const auto errors = cross_validate_locate(scene, arrivals, 5, 1);
    ASSERT_EQ(errors.size(), arrivals.size());
    const double held_out = *median_absolute(errors);
    EXPECT_LT(held_out, 0.8 * before);
    // The times themselves are known to 0.67 standard deviations, in the median.
    EXPECT_GT(held_out, 0.5 * 4e-5);
    EXPECT_EQ(cross_validate_locate(scene, arrivals, 5, 1), errors);
    EXPECT_NE(cross_validate_locate(scene, arrivals, 5, 2), errors);
}

TEST_F(Locate, RefusesWhatItCannotUse) {
    const Truth truth = random_truth(9, 1, 1);
    const Scene scene = stated_scene(truth, 9, 0.01, 0.01);
    const auto line = [&](const std::vector<MeasuredArrival>& arrivals,
                          const LocateOptions& options) -> std::string {
        try {
            locate(scene, arrivals, options);
        } catch (const Error& error) {
            return error.line();
        }
        return "none";
    };
    const std::vector<MeasuredArrival> good = arrivals_of(truth, 9, 0.0);
    EXPECT_EQ(line(good, {}), "none");
    EXPECT_NE(line({}, {}).find("no arrivals"), std::string::npos);
    EXPECT_NE(line({{.source = 1}}, {}).find("not in the scene"), std::string::npos);
    EXPECT_NE(line({{.time = -1.0}}, {}).find("time is out of range"), std::string::npos);
    EXPECT_NE(line({{.time = 0.01, .surfaces = {{"roof"}}}}, {}).find("'roof'"), std::string::npos);
    EXPECT_NE(line({{.time = 5.0}}, {}).find("none of 1 fits"), std::string::npos);
    EXPECT_NE(line(good, {.source_error = -1.0}).find("source_error"), std::string::npos);
    EXPECT_NE(line(good, {.timing_error = 0.0}).find("timing_error"), std::string::npos);
    EXPECT_THROW(cross_validate_locate(scene, good, 1, 1), Error);
    EXPECT_THROW(cross_validate_locate(scene, good, 8, 1), Error);
}

/// One time of a listener of which nothing is known, and air that may be of any temperature: a
/// result or an Error, but nothing that is no number.
TEST_F(Locate, EndsWhereAlmostNothingIsKnown) {
    constexpr double kUnknown = std::numeric_limits<double>::infinity();
    const Truth truth = random_truth(10, 1, 1);
    const Scene scene = stated_scene(truth, 10, 0.0, 0.0);
    for (const double time : {0.0, 1e-6, 0.01, 0.5, 100.0}) {
        const std::vector<MeasuredArrival> one = {
            {.time = time, .surfaces = std::vector<std::string>{}}};
        try {
            const LocateResult result = locate(scene,
                                               one,
                                               {.source_error = kUnknown,
                                                .listener_error = kUnknown,
                                                .temperature_error = kUnknown,
                                                .latency_error = kUnknown});
            EXPECT_TRUE(geometry::is_finite(result.listeners[0].position())) << time;
            EXPECT_GT(result.speed_of_sound.value, 0.0);
            EXPECT_TRUE(std::isinf(result.listeners[0].x.standard_error));
            EXPECT_EQ(result.listeners[0].x.data_share, 0.0);
        } catch (const Error& error) {
            EXPECT_EQ(error.subject(), "arrivals") << time;
        }
    }
}

/// Analytic derivatives against differences, for paths over walls of any tilt.
TEST(ArrivalModel, DerivativesAreThoseOfTheLength) {
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        const auto vector = [&](std::uint64_t stream) {
            return Vec3(random_normal(seed, stream, 0),
                        random_normal(seed, stream, 1),
                        random_normal(seed, stream, 2));
        };
        std::vector<ReflectingWall> walls(3);
        for (std::uint64_t w = 0; w < walls.size(); ++w) {
            walls[w].plane = {glm::normalize(vector(w)), random_normal(seed, 9, w)};
        }
        ArrivalState state = {.sources = {vector(5)},
                              .listeners = {vector(6)},
                              .speed = 340.0,
                              .latencies = {0.0},
                              .wall_offsets = {0.1, -0.2, 0.3}};
        const ArrivalTerm term = {.source = 0, .listener = 0, .walls = {1, 0, 2, 0}};
        LengthGradient gradient;
        path_length(state, walls, term, &gradient);
        const auto slope = [&](double& number) {
            constexpr double kStep = 1e-6;
            const double at = number;
            number = at + kStep;
            const double above = path_length(state, walls, term);
            number = at - kStep;
            const double below = path_length(state, walls, term);
            number = at;
            return (above - below) / (2.0 * kStep);
        };
        for (int axis = 0; axis < 3; ++axis) {
            EXPECT_NEAR(gradient.source[axis], slope(state.sources[0][axis]), 1e-7) << seed;
            EXPECT_NEAR(gradient.listener[axis], slope(state.listeners[0][axis]), 1e-7) << seed;
        }
        EXPECT_NEAR(gradient.walls[0], slope(state.wall_offsets[1]), 1e-7) << seed;
        EXPECT_NEAR(gradient.walls[2], slope(state.wall_offsets[2]), 1e-7) << seed;
        EXPECT_NEAR(gradient.walls[1] + gradient.walls[3], slope(state.wall_offsets[0]), 1e-7)
            << seed;
    }
}

}  // namespace
}  // namespace earshot::propagation
