// SPDX-License-Identifier: MIT
#include "earshot/propagation/engine/engine.h"

#include "earshot/audio/convolve.h"
#include "earshot/base/error.h"
#include "earshot/base/random.h"
#include "earshot/io/default_hrir_set.h"
#include "earshot/propagation/response.h"

#include <gtest/gtest.h>

#include "moving_part.h"
#include "support/moving_images.h"
#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <numbers>
#include <thread>
#include <utility>
#include <vector>

namespace earshot::propagation {
namespace {

using geometry::Vec3;

constexpr double kRate = 48000.0;
constexpr double kFrequency = 1000.0;
constexpr std::size_t kBlock = 256;
const Vec3 kListener = test::PassingSource().listener;

Scene box(double absorption) {
    return test::PassingSource().scene(absorption);
}

std::vector<float> tone(std::size_t samples, double frequency = kFrequency) {
    std::vector<float> signal;
    for (std::size_t n = 0; n < samples; ++n) {
        const double t = static_cast<double>(n) / kRate;
        signal.push_back(static_cast<float>(std::sin(2.0 * std::numbers::pi * frequency * t)));
    }
    return signal;
}

/// Noise below about a quarter of the sample rate.
std::vector<float> soft_noise(std::size_t samples) {
    std::vector<double> noise(samples);
    for (std::size_t n = 0; n < samples; ++n) {
        noise[n] = random(3, 0, n) - 0.5;
    }
    std::vector<double> taps;
    constexpr double kHalf = 40.0;
    for (double t = -kHalf; t <= kHalf; t += 1.0) {
        const double window = 0.5 + 0.5 * std::cos(std::numbers::pi * t / (kHalf + 1.0));
        const double angle = 0.5 * std::numbers::pi * t;
        taps.push_back(0.5 * window * (t == 0.0 ? 1.0 : std::sin(angle) / angle));
    }
    const std::vector<double> soft = audio::convolve_directly(noise, taps);
    return {soft.begin(), soft.begin() + static_cast<std::ptrdiff_t>(samples)};
}

using Signals = std::vector<std::vector<float>>;

/// Feeds all sources with one signal, and calls before(frame) ahead of every `step` frames.
template <typename Before>
Signals play(Engine& engine,
             const std::vector<float>& signal,
             std::size_t step,
             const Before& before) {
    const std::size_t outputs = engine.listeners() * engine.channels();
    Signals heard(outputs, std::vector<float>(signal.size(), 0.0F));
    std::vector<float*> out(outputs);
    for (std::size_t n = 0; n + step <= signal.size(); n += step) {
        before(n);
        const std::vector<const float*> in(engine.sources(), &signal[n]);
        for (std::size_t channel = 0; channel < outputs; ++channel) {
            out[channel] = &heard[channel][n];
        }
        engine.render(in.data(), out.data(), step);
    }
    return heard;
}

EngineOptions mono(int order) {
    EngineOptions options;
    options.simulation.specular_order = order;
    options.simulation.air_absorption = false;
    options.channels = Channels::mono;
    return options;
}

// All that is heard, against the sum over images that move, sample by sample: whatever differs, in
// frequency, in level or as a line of its own. What is left is the cubic between updates, whose
// error grows with the fourth power of their distance.
TEST(Engine, HearsTheMovingImages) {
    struct Case {
        double speed = 0.0;
        std::size_t step = 0;  // frames between updates
        double bound = 0.0;    // re the direct sound
    };
    for (const Case& pass :
         {Case{1.0, 2048, 1e-4}, Case{10.0, 2048, 1e-3}, Case{30.0, 512, 1e-3}}) {
        EngineOptions options = mono(2);
        options.motion_delay = static_cast<double>(pass.step) / kRate;
        Engine engine(box(0.19), options);
        const test::PassingSource source{.speed = pass.speed};
        const auto heard = play(engine, tone(43008), pass.step, [&](std::size_t frame) {
            engine.place_source(0, {.position = source.place(static_cast<double>(frame) / kRate)});
            engine.publish();
            engine.update();
        });
        const double level = 1.0 / 3.0;
        const double late = static_cast<double>(engine.latency()) / kRate;
        for (std::size_t n = 19200; n < 42000; n += 7) {
            const double t = static_cast<double>(n) / kRate;
            double expected = 0.0;
            const double moved = t - options.motion_delay;
            for (const auto& image : source.images(moved, 2, 0.9)) {
                const double delay = moved - image.emission;
                expected += image.pressure *
                            std::sin(2.0 * std::numbers::pi * kFrequency * (t - late - delay));
            }
            ASSERT_NEAR(heard[0][n], expected, pass.bound * level)
                << pass.speed << " m/s, " << t << " s";
        }
        EXPECT_EQ(engine.statistics().paths, 25U);
        EXPECT_EQ(engine.statistics().late_snapshots, 0U);
    }
}

double energy(const std::vector<double>& samples) {
    double sum = 0.0;
    for (const double sample : samples) {
        sum += sample * sample;
    }
    return sum;
}

Scene coloured_box() {
    Scene scene = box(0.19);
    scene.materials[0].absorption = EnergyCoefficient({{125.0, 0.1}, {8000.0, 0.6}});
    scene.materials[1].absorption = EnergyCoefficient({{125.0, 0.5}, {1000.0, 0.1}, {4000.0, 0.3}});
    return scene;
}

// Where nothing moves, what is heard is the signal through the response that is rendered offline.
TEST(Engine, IsTheOfflineRendererWhereNothingMoves) {
    const Scene scene = coloured_box();
    EngineOptions options;
    options.simulation.specular_order = 2;
    options.ambisonic_order = 2;
    Pose turned = pose_towards(kListener, {0.3, 0.2, -0.5}, {0.1, 1.0, 0.2});
    Engine engine(scene, options);
    engine.turn_listener(0, turned);
    const std::vector<float> signal = soft_noise(24576);
    const Signals heard = play(engine, signal, kBlock, [](std::size_t) {});

    Simulator simulator(scene, {.specular_order = 2});
    const ResponseFormat format = {
        .channels = Channels::ambisonic, .ambisonic_order = 2, .report_metrics = false};
    const Response response =
        render_response(audio::Bands::octaves(), simulator.run().front(), turned, format);
    const std::vector<double> dry(signal.begin(), signal.end());
    for (std::size_t channel = 0; channel < 9; ++channel) {
        const std::vector<double> expected =
            audio::convolve(dry, response.channels[channel].samples);
        std::vector<double> right, wrong;
        for (std::size_t n = 12000; n < 24000; ++n) {
            right.push_back(expected[n]);
            wrong.push_back(heard[channel][n + engine.latency()] - expected[n]);
        }
        EXPECT_LT(10.0 * std::log10(energy(wrong) / energy(right)), -55.0) << channel;
    }
    EXPECT_LT(engine.statistics().max_filter_error, 2e-3);
}

constexpr std::size_t kWindow = 32768;

/// The level of a line, windowed by Blackman and Harris, in decibels re a steady tone of amplitude
/// 1.
double level_at(const std::vector<float>& signal, std::size_t begin, double frequency) {
    double re = 0.0, im = 0.0;
    for (std::size_t n = 0; n < kWindow; ++n) {
        const double u = 2.0 * std::numbers::pi * static_cast<double>(n) / kWindow;
        const double window = 0.35875 - 0.48829 * std::cos(u) + 0.14128 * std::cos(2.0 * u) -
                              0.01168 * std::cos(3.0 * u);
        const double angle = 2.0 * std::numbers::pi * frequency * static_cast<double>(n) / kRate;
        re += window * signal[begin + n] * std::cos(angle);
        im += window * signal[begin + n] * std::sin(angle);
    }
    return 10.0 * std::log10(re * re + im * im) - 20.0 * std::log10(0.35875 * kWindow / 2.0);
}

// A source that comes and goes, of which every fifth update is missing: no line away from its tone.
TEST(Engine, DoesNotClick) {
    for (const double frequency : {1000.0, 15000.0}) {
        EngineOptions options = mono(0);
        options.motion_delay = 1024.0 / kRate;
        Engine engine(box(0.19), options);
        const auto heard = play(engine, tone(40960, frequency), 1024, [&](std::size_t frame) {
            const double t = static_cast<double>(frame) / kRate;
            engine.place_source(0, {.position = {15.0, 2.0, 13.0 + std::sin(3.0 * t)}});
            engine.publish();
            if (frame % 5120 != 4096) {
                engine.update();
            }
        });
        const double own = -20.0 * std::log10(std::hypot(5.0, 4.0));
        double loudest = -300.0;
        for (double line = 200.0; line < 24000.0; line += 97.0) {
            if (std::abs(line - frequency) > 0.02 * frequency + 60.0) {
                loudest = std::max(loudest, level_at(heard[0], 8192, line) - own);
            }
        }
        EXPECT_LT(loudest, -80.0) << frequency;
    }
}

Scene crowd() {
    Scene scene = coloured_box();
    for (std::size_t i = 1; i < 4; ++i) {
        scene.sources.push_back({.name = "s" + std::to_string(i),
                                 .node = -1,
                                 .position = {4.0 + static_cast<double>(7 * i), 2.0, 20.0}});
    }
    scene.listeners.push_back({.name = "m", .node = -1, .position = {30.0, 3.0, 8.0}});
    for (Material& material : scene.materials) {
        material.scattering = EnergyCoefficient(0.3);
    }
    return scene;
}

Signals walk(const UpdateBudget& budget,
             Executor& executor,
             EngineStatistics& statistics,
             std::size_t virtual_sources = 0) {
    EngineOptions options;
    options.virtual_sources = virtual_sources;
    options.simulation.specular_order = 2;
    options.simulation.rays = 1000;
    options.late_length = 0.5;
    options.ambisonic_order = 1;
    options.budget = budget;
    Engine engine(crowd(), options, executor);
    Signals heard = play(engine, soft_noise(20480), 2048, [&](std::size_t frame) {
        const double t = static_cast<double>(frame) / kRate;
        for (std::size_t source = 0; source < 4; ++source) {
            engine.place_source(
                source, {.position = {5.0 + 7.0 * static_cast<double>(source), 2.0, 13.0 + t}});
        }
        engine.publish();
        engine.update();
    });
    statistics = engine.statistics();
    return heard;
}

TEST(Engine, HasTheSameBitsWithABudgetOfWork) {
    Executor two(2);
    EngineStatistics statistics;
    const UpdateBudget budget{.work = 3000};
    const Signals first = walk(budget, Executor::serial(), statistics);
    EXPECT_GT(statistics.deferred_late + statistics.reduced_late, 0U);
    EXPECT_EQ(walk(budget, Executor::serial(), statistics), first);
    EXPECT_EQ(walk(budget, two, statistics), first);
    EXPECT_NE(walk({}, two, statistics), first);
    EXPECT_EQ(statistics.deferred_late + statistics.reduced_late + statistics.deferred_sources, 0U);
}

TEST(Engine, HasTheSameBitsWithABudgetOfWorkForVirtualSources) {
    Executor two(2);
    EngineStatistics statistics;
    const UpdateBudget budget{.work = 20000};
    const Signals first = walk(budget, Executor::serial(), statistics, 256);
    EXPECT_GT(statistics.deferred_late + statistics.reduced_late, 0U);
    EXPECT_EQ(walk(budget, two, statistics, 256), first);
    EXPECT_NE(walk({}, two, statistics, 256), first);
    EXPECT_EQ(statistics.deferred_late + statistics.reduced_late + statistics.deferred_sources, 0U);
}

TEST(Engine, TracesNoRaysAgainForASourceThatStays) {
    // Of the update at the start, and of one after a listener has moved.
    const auto work = [](std::size_t rays) {
        EngineOptions options = mono(0);
        options.simulation.rays = rays;
        options.virtual_sources = 100;
        Engine engine(crowd(), options);
        const std::uint64_t first = engine.statistics().work;
        engine.place_listener(0, {.position = {21.0, 2.0, 10.5}});
        engine.publish();
        engine.update();
        return std::pair(first, engine.statistics().work);
    };
    const auto with_late_sound = work(200);
    const auto early = work(0);
    // The tests of four sources and two listeners, and the legs of 800 rays at least; then the
    // tests of one source.
    EXPECT_GT(with_late_sound.first, early.first + 800 + 800);
    EXPECT_EQ(with_late_sound.second, early.second + 200);
}

TEST(Engine, DefersTheFaintestSourcesLast) {
    EngineStatistics statistics;
    walk({.work = 1}, Executor::serial(), statistics);
    // One source an update; its late sound is traced when it is too old only.
    EXPECT_EQ(statistics.updates, 11U);
    EXPECT_EQ(statistics.deferred_sources, 33U);
}

// The energy that comes late, against that of the histogram which offline rendering takes.
void expect_late_sound(double scattering, std::size_t virtual_sources) {
    Scene scene = box(0.3);
    for (Material& material : scene.materials) {
        material.scattering = EnergyCoefficient(scattering);
    }
    EngineOptions options = mono(0);
    options.simulation.rays = virtual_sources > 0 ? 2000 : 20000;
    options.virtual_sources = virtual_sources;
    Engine engine(scene, options);
    std::vector<float> click(48128, 0.0F);
    click[4096] = 1.0F;
    const Signals heard = play(engine, click, kBlock, [](std::size_t) {});
    Simulator simulator(scene, {.specular_order = 0, .air_absorption = false, .rays = 20000});
    const PairResult pair = simulator.run().front();
    for (const double begin : {0.1, 0.2, 0.4}) {
        double expected = 0.0, found = 0.0;
        const auto first = static_cast<std::size_t>(begin / pair.late.bin);
        for (std::size_t bin = first; bin < first + 100; ++bin) {
            // The level of white noise is the mean over frequency: the highest band has half of it.
            for (std::size_t band = 0; band < 10; ++band) {
                const double share =
                    std::pow(0.5, band == 0 ? 9.0 : 10.0 - static_cast<double>(band));
                expected += share * pair.late.energy[bin][band];
            }
        }
        const auto sample = 4096 + static_cast<std::size_t>(begin * kRate);
        for (std::size_t n = sample; n < sample + 4800; ++n) {
            found += heard[0][n] * heard[0][n];
        }
        EXPECT_NEAR(10.0 * std::log10(found / expected), 0.0, 0.5) << begin;
    }
}

TEST(Engine, HearsTheLateSoundOfTheRays) {
    expect_late_sound(0.5, 0);
}

TEST(Engine, HearsTheLateSoundOfVirtualSources) {
    expect_late_sound(1.0, 4000);
}

// A plate that rises by 2 m in a second: at half a second it is where one that stays is.
TEST(Engine, BeginsAtATimeOfTheAnimation) {
    const auto heard_over = [](double height, bool moves, double start) {
        SceneWithMovingPart scene(box(0.19), Vec3(80.0), Vec3(81.0));
        scene.add_box({15.0, height, 9.0}, {25.0, height + 0.2, 15.0}, 0, moves);
        scene.add_box(Vec3(80.2), Vec3(80.4), 0, true);  // far outside
        EngineOptions options = mono(1);
        options.start_time = start;
        Engine engine(scene.finish(straight_way({0.0, 2.0, 0.0})), options);
        return play(engine, soft_noise(16384), kBlock, [](std::size_t) {}).front();
    };
    const auto level_of_difference = [](const std::vector<float>& a, const std::vector<float>& b) {
        std::vector<double> wrong, right;
        for (std::size_t n = 0; n < a.size(); ++n) {
            wrong.push_back(a[n] - b[n]);
            right.push_back(b[n]);
        }
        return 10.0 * std::log10(energy(wrong) / energy(right));
    };
    const std::vector<float> expected = heard_over(1.2, false, 0.0);
    EXPECT_LT(level_of_difference(heard_over(0.2, true, 0.5), expected), -80.0);
    EXPECT_GT(level_of_difference(heard_over(0.2, true, 0.0), expected), -30.0);
    EngineOptions options = mono(0);
    options.start_time = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(Engine(box(0.19), options), Error);
}

/// Of the first four channels from 0.1 to 0.3 s: the mean of W times each, and of its square, re
/// that of W.
template <typename Channel>
std::array<std::array<double, 4>, 2> covariances(const std::vector<Channel>& channels,
                                                 std::size_t click) {
    std::array<std::array<double, 4>, 2> sums{};
    const auto from = click + static_cast<std::size_t>(0.1 * kRate);
    for (std::size_t n = from; n < from + static_cast<std::size_t>(0.2 * kRate); ++n) {
        for (std::size_t channel = 0; channel < 4; ++channel) {
            const double sample = channels[channel][n];
            sums[0][channel] += channels[0][n] * sample;
            sums[1][channel] += sample * sample;
        }
    }
    const double whole = sums[1][0];
    for (auto& row : sums) {
        for (double& sum : row) {
            sum /= whole;
        }
    }
    return sums;
}

// Beside an opening all late sound comes from the other side, -X, which is left: of a diffuse half
// space the mean cosine is 1/2 and its square 1/3. And all are those of offline rendering.
TEST(Engine, HearsFromWhereLateSoundComes) {
    Scene scene = box(0.1);
    for (Material& material : scene.materials) {
        material.scattering = EnergyCoefficient(1.0);
    }
    scene.materials[3].absorption = EnergyCoefficient(1.0);  // east
    scene.listeners[0].position = {39.8, 5.0, 14.0};
    const Options early_and_late{.specular_order = 0, .rays = 20000, .late_directions = true};
    const ResponseFormat format = {
        .channels = Channels::ambisonic, .ambisonic_order = 1, .report_metrics = false};
    Simulator simulator(scene, early_and_late);
    const Response offline = render_response(audio::Bands::octaves(),
                                             simulator.run().front(),
                                             scene.pose_at(scene.listeners[0], 0.0),
                                             format);
    std::vector<std::vector<double>> responses;
    for (const audio::ImpulseResponse& response : offline.channels) {
        responses.push_back(response.samples);
    }
    const auto expected = covariances(responses, 0);
    std::vector<float> click(32768, 0.0F);
    click[4096] = 1.0F;
    for (const std::size_t virtual_sources : {std::size_t{0}, std::size_t{4000}}) {
        EngineOptions options;
        options.simulation = early_and_late;
        options.virtual_sources = virtual_sources;
        options.ambisonic_order = 1;
        Engine engine(scene, options);
        const auto found =
            covariances(play(engine, click, kBlock, [](std::size_t) {}), 4096 + engine.latency());
        EXPECT_NEAR(found[0][1], 0.5, 0.15);
        EXPECT_NEAR(found[1][1], 1.0 / 3.0, 0.15);
        for (std::size_t channel = 1; channel < 4; ++channel) {
            EXPECT_NEAR(found[0][channel], expected[0][channel], 0.07) << channel;
            EXPECT_NEAR(found[1][channel], expected[1][channel], 0.07) << channel;
        }
    }
}

TEST(Engine, TurnsBinauralSoundWithTheHead) {
    EngineOptions options;
    options.simulation.specular_order = 0;
    options.channels = Channels::binaural;
    options.hrir_set = io::default_hrir_set();
    Scene scene = box(0.19);
    scene.sources[0].position = kListener + Vec3(3.0, 0.0, 0.0);  // at the right
    const auto ears = [&](const Vec3& front) {
        Engine engine(scene, options);
        engine.turn_listener(0, pose_towards({}, front, {0.0, 1.0, 0.0}));
        const Signals heard = play(engine, soft_noise(16384), kBlock, [](std::size_t) {});
        std::array<double, 2> level{};
        for (std::size_t ear = 0; ear < 2; ++ear) {
            level[ear] = 10.0 * std::log10(energy({heard[ear].begin() + 8192, heard[ear].end()}));
        }
        return level;
    };
    const auto right = ears({0.0, 0.0, -1.0});
    EXPECT_GT(right[1] - right[0], 5.0);
    const auto left = ears({0.0, 0.0, 1.0});
    EXPECT_GT(left[0] - left[1], 5.0);
    const auto ahead = ears({1.0, 0.0, 0.0});
    EXPECT_NEAR(ahead[0] - ahead[1], 0.0, 1.0);
}

TEST(Engine, TakesAnyNumberOfFrames) {
    EngineOptions options = mono(1);
    Engine exact(box(0.19), options);
    options.any_frame_count = true;
    Engine any(box(0.19), options);
    EXPECT_EQ(any.latency(), exact.latency() + kBlock);
    const std::vector<float> signal = soft_noise(8192 + 256);
    const Signals expected = play(exact, signal, kBlock, [](std::size_t) {});
    std::vector<float> heard(signal.size());
    std::size_t n = 0;
    for (const std::size_t frames : {1U, 255U, 100U, 441U, 512U, 63U, 1000U, 2000U}) {
        const float* in = &signal[n];
        float* out = &heard[n];
        any.render(&in, &out, frames);
        n += frames;
    }
    for (std::size_t k = kBlock; k < n; ++k) {
        ASSERT_EQ(heard[k], expected[0][k - kBlock]) << k;
    }
    std::vector<float> silence(100, 1.0F);
    float* out = silence.data();
    exact.render(nullptr, &out, 100);
    EXPECT_EQ(silence, std::vector<float>(100, 0.0F));
    EXPECT_EQ(exact.statistics().refused_calls, 1U);
}

TEST(Engine, RendersWhileItIsUpdated) {
    EngineOptions options = mono(2);
    options.update_interval = 0.001;
    options.simulation.rays = 500;
    options.late_length = 0.2;
    Engine engine(crowd(), options);
    engine.start();
    std::atomic<bool> is_over{false};
    std::thread control([&] {
        for (int k = 0; !is_over; ++k) {
            engine.place_source(0, {.position = {15.0, 2.0, 13.0 + 0.001 * (k % 1000)}});
            engine.place_listener(1, {.position = {30.0, 3.0 + 0.001 * (k % 1000), 8.0}});
            engine.publish();
            engine.turn_listener(0,
                                 pose_towards({}, {1.0, 0.01 * (k % 100), 0.0}, {0.0, 1.0, 0.0}));
            std::this_thread::yield();
        }
    });
    const Signals heard = play(engine, soft_noise(96256), kBlock, [&](std::size_t frame) {
        // Until an update has come that this thread has not seen yet, now and then.
        const std::uint64_t before = engine.statistics().updates;
        while (frame % 8192 == 0 && engine.statistics().updates == before) {
            std::this_thread::yield();
        }
    });
    is_over = true;
    control.join();
    engine.stop();
    const EngineStatistics statistics = engine.statistics();
    EXPECT_GT(statistics.updates, 10U);
    EXPECT_EQ(statistics.failed_updates, 0U) << statistics.last_failure;
    EXPECT_EQ(statistics.blocks, 96256U / kBlock);
    for (const std::vector<float>& channel : heard) {
        EXPECT_TRUE(std::all_of(channel.begin(), channel.end(), [](float sample) {
            return std::isfinite(sample) && std::abs(sample) < 2.0F;
        }));
    }
    EXPECT_GT(energy({heard[1].begin() + 48000, heard[1].end()}), 0.0);
}

TEST(Engine, FadesWhereASourceJumps) {
    EngineOptions options = mono(0);
    options.motion_delay = 1024.0 / kRate;
    Engine engine(box(0.19), options);
    const auto heard = play(engine, tone(30720), 1024, [&](std::size_t frame) {
        engine.place_source(0, {.position = {frame < 15360 ? 15.0 : 30.0, 2.0, 13.0}});
        engine.publish();
        engine.update();
    });
    // The steepest rise of the sum of two tones of 1 kHz.
    const double limit = 2.0 * std::numbers::pi * kFrequency / kRate * (1.0 / 5.83 + 1.0 / 10.4);
    for (std::size_t n = 4096; n < 30719; ++n) {
        ASSERT_LT(std::abs(heard[0][n + 1] - heard[0][n]), limit) << n;
    }
}

TEST(Engine, RefusesWhatMakesNoSense) {
    Scene scene = box(0.19);
    EngineOptions options;
    options.block = 100;
    EXPECT_THROW(Engine(scene, options), Error);
    options = {};
    options.channels = Channels::binaural;
    EXPECT_THROW(Engine(scene, options), Error);
    options = {};
    options.ambisonic_order = 9;
    EXPECT_THROW(Engine(scene, options), Error);
    scene.listeners.clear();
    EXPECT_THROW(Engine(scene, {}), Error);
}

}  // namespace
}  // namespace earshot::propagation
