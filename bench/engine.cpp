// SPDX-License-Identifier: MIT
//
// bench_engine SCENE [SECONDS [ORDER [RAYS [SOURCES [THREADS]]]]]: a scene in real time. Sources
// walk, a listener walks and turns the head, updates run on one thread and a callback every 256
// samples on another. Told are the updates per second, how long they took, and the callback's time
// of its thread's processor as a share of the block's duration.

#include "earshot/propagation/engine/engine.h"

#include "earshot/base/error.h"
#include "earshot/base/math.h"
#include "earshot/base/random.h"
#include "earshot/io/default_hrir_set.h"
#include "earshot/io/scene_file.h"

#include "harness.h"
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <string>
#include <thread>
#include <vector>

namespace {

namespace math = earshot::math;
using earshot::geometry::Vec3;
using earshot::propagation::Engine;
using earshot::propagation::EngineOptions;
using earshot::propagation::EngineStatistics;
using earshot::propagation::Pose;
using earshot::propagation::Scene;

double thread_seconds() {
    timespec time{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/// As many sources as asked for, half a metre apart where the scene has fewer, and one listener.
Scene with_sources(Scene scene, std::size_t sources) {
    for (std::size_t i = 0; scene.sources.size() < sources; ++i) {
        earshot::propagation::Emitter source = scene.sources[i];
        source.name += std::to_string(scene.sources.size());
        source.position = scene.position_at(source, 0.0) + Vec3(0.5, 0.0, 0.3);
        source.node = -1;
        scene.sources.push_back(source);
    }
    scene.sources.resize(sources);
    scene.listeners.resize(1);
    return scene;
}

/// A circle of 0.3 m about where the emitter is, once in four seconds.
Vec3 walk(const Vec3& centre, double time, std::size_t number) {
    const double angle = 0.5 * math::kPi * time + static_cast<double>(number);
    return centre + 0.3 * Vec3(math::cos(angle), 0.0, math::sin(angle));
}

class Playing {
public:
    Playing(const Scene& scene, const EngineOptions& options, earshot::Executor& executor)
        : scene_(scene), engine_(scene, options, executor), block_(options.block) {
        for (std::size_t n = 0; n < 48000; ++n) {
            noise_.push_back(static_cast<float>(earshot::random(1, 0, n) - 0.5));
        }
        outputs_.resize(engine_.channels(), std::vector<float>(block_));
    }

    void play(double seconds) {
        using Clock = std::chrono::steady_clock;
        const auto period = std::chrono::duration_cast<Clock::duration>(
            std::chrono::duration<double>(static_cast<double>(block_) / engine_.sample_rate()));
        engine_.start();
        const Clock::time_point begin = Clock::now();
        Clock::time_point next = begin;
        while (Clock::now() - begin < std::chrono::duration<double>(seconds)) {
            call_back();
            next += period;
            if (next > Clock::now()) {
                std::this_thread::sleep_until(next);
            } else {
                ++overruns_;
                next = Clock::now();
            }
        }
        clock_ = std::chrono::duration<double>(Clock::now() - begin).count();
        engine_.stop();
    }

    void print() const {
        const EngineStatistics statistics = engine_.statistics();
        std::vector<double> sorted = times_;
        std::sort(sorted.begin(), sorted.end());
        const double duration = static_cast<double>(block_) / engine_.sample_rate();
        const auto share = [&](double quantile) {
            const auto place =
                static_cast<std::size_t>(quantile * static_cast<double>(sorted.size() - 1));
            return 100.0 * sorted[place] / duration;
        };
        std::printf("paths               %zu, late frames %zu\n",
                    statistics.paths,
                    static_cast<std::size_t>(engine_.latency()));
        std::printf("updates             %.1f a second, median %.1f ms, worst %.1f ms\n",
                    static_cast<double>(statistics.updates) / clock_,
                    statistics.median_update_milliseconds,
                    statistics.max_update_milliseconds);
        std::printf("late snapshots      %zu, failed %zu %s\n",
                    static_cast<std::size_t>(statistics.late_snapshots),
                    static_cast<std::size_t>(statistics.failed_updates),
                    statistics.last_failure.c_str());
        std::printf("callbacks           %zu, %zu began late\n", sorted.size(), overruns_);
        std::printf(
            "share of the block  median %.1f %%, 99 %% %.1f %%, 99.9 %% %.1f %%, worst %.1f %%\n",
            share(0.5),
            share(0.99),
            share(0.999),
            share(1.0));
    }

private:
    void call_back() {
        const double time = static_cast<double>(engine_.frames_rendered()) / engine_.sample_rate();
        // Control, 60 times a second or so, and the head at every block; not measured.
        if (count_ % 3 == 0) {
            for (std::size_t source = 0; source < engine_.sources(); ++source) {
                const Vec3 at = scene_.position_at(scene_.sources[source], 0.0);
                engine_.place_source(source, {.position = walk(at, time, source)});
            }
            const Vec3 at = scene_.position_at(scene_.listeners[0], 0.0);
            engine_.place_listener(0, {.position = walk(at, 0.5 * time, 0)});
            engine_.publish();
        }
        const Vec3 front(math::sin(time), 0.0, -math::cos(time));
        engine_.turn_listener(0, earshot::propagation::pose_towards({}, front, {0.0, 1.0, 0.0}));
        std::vector<const float*> in;
        for (std::size_t source = 0; source < engine_.sources(); ++source) {
            in.push_back(&noise_[(count_ * block_ + source * 5000) % (noise_.size() - block_)]);
        }
        std::vector<float*> out;
        for (std::vector<float>& channel : outputs_) {
            out.push_back(channel.data());
        }
        const double before = thread_seconds();
        engine_.render(in.data(), out.data(), block_);
        times_.push_back(thread_seconds() - before);
        ++count_;
    }

    Scene scene_;
    Engine engine_;
    std::size_t block_;
    std::vector<float> noise_;
    std::vector<std::vector<float>> outputs_;
    std::vector<double> times_;
    std::size_t count_ = 0, overruns_ = 0;
    double clock_ = 1.0;
};

int run(int argc, char** argv) {
    if (argc < 2) {
        std::fprintf(stderr,
                     "usage: bench_engine SCENE [SECONDS [ORDER [RAYS [SOURCES [THREADS]]]]]\n");
        return 2;
    }
    const auto number = [&](int place, double otherwise) {
        return argc > place ? std::atof(argv[place]) : otherwise;
    };
    const Scene scene = with_sources(earshot::io::load_scene(argv[1]).scene,
                                     static_cast<std::size_t>(number(5, 4.0)));
    EngineOptions options;
    options.channels = earshot::propagation::Channels::binaural;
    options.hrir_set = earshot::io::default_hrir_set();
    options.simulation.specular_order = static_cast<int>(number(3, 3.0));
    options.simulation.rays = static_cast<std::size_t>(number(4, 1000.0));
    earshot::Executor executor(static_cast<int>(number(6, 2.0)));
    Playing playing(scene, options, executor);
    playing.play(number(2, 20.0));
    playing.print();
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    return bench::run_main("bench_engine", argc, argv, run);
}
