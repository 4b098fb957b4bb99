// SPDX-License-Identifier: MIT
#include "earshot/io/default_hrir_set.h"
#include "earshot/propagation/engine/engine.h"
#include "earshot/propagation/room_shapes.h"

#include <gtest/gtest.h>

#include "interposed_calls.h"
#include "system_call_filter.h"
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <mutex>
#include <new>
#include <sys/syscall.h>
#include <thread>
#include <unistd.h>
#include <vector>

namespace earshot::test {
namespace {

using geometry::Vec3;
using propagation::Engine;
using propagation::EngineOptions;

/// What a thread did that an audio thread must not do.
struct Faults {
    bool has_filter = false;
    WatchedCalls calls{};
    RefusedCalls refused{};
};

/// Calls work() on a thread of its own that may neither allocate nor lock nor enter the kernel.
Faults run_as_audio_thread(const std::function<void()>& work) {
    Faults faults;
    clear_refused_calls();
    std::thread thread([&] {
        void* volatile block = std::malloc(16);  // the first of a thread enters the kernel
        std::free(block);
        // The threads of a sanitizer make calls of their own.
        faults.has_filter = CallWatch::is_available() && refuse_system_calls();
        {
            const CallWatch watch;
            work();
        }
        faults.calls = CallWatch::calls();
        if (faults.has_filter) {
            end_thread();
        }
    });
    thread.join();
    faults.refused = refused_calls();
    return faults;
}

void expect_no_faults(const Faults& faults) {
    EXPECT_EQ(faults.calls.count, 0) << "the first to " << faults.calls.first << "()";
    EXPECT_EQ(faults.refused.count, 0)
        << "the first of system call " << faults.refused.first << " (asm/unistd_64.h)";
}

// A test that finds nothing must be one that can: each kind of fault, on purpose.
TEST(AudioThread, IsWatched) {
    std::mutex mutex;
    mutex.lock();  // finds the C library's function
    mutex.unlock();
    static void* volatile block = nullptr;
    const Faults of_nothing = run_as_audio_thread([] {});
    if (!CallWatch::is_available() || !of_nothing.has_filter) {
        GTEST_SKIP() << "a sanitizer has its own malloc(), or the kernel no seccomp filters";
    }
    expect_no_faults(of_nothing);

    const Faults of_allocation = run_as_audio_thread([] {
        block = std::malloc(16);
        std::free(block);
    });
    EXPECT_EQ(of_allocation.calls.count, 2);
    EXPECT_STREQ(of_allocation.calls.first, "malloc");

    const Faults of_new = run_as_audio_thread([] { ::operator delete(::operator new(16)); });
    EXPECT_EQ(of_new.calls.count, 2);

    const Faults of_lock = run_as_audio_thread([&] { const std::lock_guard lock(mutex); });
    EXPECT_EQ(of_lock.calls.count, 1);
    EXPECT_STREQ(of_lock.calls.first, "pthread_mutex_lock");

    const Faults of_system_call = run_as_audio_thread([] { syscall(SYS_getppid); });
    EXPECT_EQ(of_system_call.refused.count, 1);
    EXPECT_EQ(of_system_call.refused.first, SYS_getppid);
}

propagation::Scene room() {
    propagation::Scene scene = propagation::shoebox_room(Vec3(12.0, 4.0, 9.0));
    for (propagation::Material& material : scene.materials) {
        material.absorption = propagation::EnergyCoefficient(0.2);
        material.scattering = propagation::EnergyCoefficient(0.1);
    }
    scene.sources = {{.name = "a", .node = -1, .position = {2.0, 1.5, 2.0}},
                     {.name = "b", .node = -1, .position = {9.0, 1.5, 6.0}}};
    scene.listeners = {{.name = "l", .node = -1, .position = {6.0, 1.6, 4.0}},
                       {.name = "m", .node = -1, .position = {4.0, 1.6, 7.0}}};
    return scene;
}

EngineOptions options_for(propagation::Channels channels) {
    EngineOptions options;
    options.channels = channels;
    options.simulation.specular_order = 2;
    options.simulation.rays = 500;
    options.late_length = 0.5;
    options.update_interval = 0.01;
    if (channels == propagation::Channels::binaural) {
        options.hrir_set = io::default_hrir_set();
    }
    return options;
}

/// One block after the other, with a head that turns, until all is told to end.
class Callback {
public:
    explicit Callback(Engine& engine)
        : engine_(engine),
          frames_(engine.options().block),
          input_(frames_, 0.25F),
          output_(engine.listeners() * engine.channels() * frames_) {
        inputs_.assign(engine.sources(), input_.data());
        for (std::size_t i = 0; i < engine.listeners() * engine.channels(); ++i) {
            outputs_.push_back(&output_[i * frames_]);
        }
    }

    void run_until_told() noexcept {
        for (std::uint64_t block = 0; !is_told.load(); ++block) {
            const double yaw = 1e-3 * static_cast<double>(block % 6000);
            const Vec3 front(std::sin(yaw), 0.0, -std::cos(yaw));
            engine_.turn_listener(block % engine_.listeners(),
                                  propagation::pose_towards(Vec3(0.0), front, Vec3(0.0, 1.0, 0.0)));
            engine_.render(inputs_.data(), outputs_.data(), frames_);
            for (const float sample : output_) {
                has_sound = has_sound || sample != 0.0F;
                is_finite = is_finite && std::isfinite(sample);
            }
        }
    }

    std::atomic<bool> is_told{false};
    bool has_sound = false, is_finite = true;

private:
    Engine& engine_;
    std::size_t frames_;
    std::vector<float> input_, output_;
    std::vector<const float*> inputs_;
    std::vector<float*> outputs_;
};

class AudioThreadOf : public testing::TestWithParam<propagation::Channels> {};

// Blocks are rendered while sources walk and the update thread hands over what it finds, until that
// has happened often enough.
TEST_P(AudioThreadOf, NeitherAllocatesNorLocksNorEntersTheKernel) {
    constexpr std::uint64_t kUpdates = 30;
    Engine engine(room(), options_for(GetParam()));
    Callback callback(engine);
    std::jthread control([&](const std::stop_token& stop) {
        for (int step = 0; !stop.stop_requested(); ++step) {
            const double x = 2.0 + 0.01 * (step % 700);
            engine.place_source(0, {.position = Vec3(x, 1.5, 2.0)});
            engine.place_listener(1, {.position = Vec3(4.0, 1.6, 7.0 - 0.5 * x)});
            engine.publish();
            const auto done = engine.statistics();
            if (done.updates >= kUpdates || done.failed_updates > 0) {
                callback.is_told = true;
            }
            std::this_thread::sleep_for(std::chrono::milliseconds(2));
        }
    });
    engine.start();
    const Faults faults = run_as_audio_thread([&] { callback.run_until_told(); });
    control.request_stop();
    control.join();
    engine.stop();

    if (CallWatch::is_available() && faults.has_filter) {
        expect_no_faults(faults);
    }
    const propagation::EngineStatistics done = engine.statistics();
    EXPECT_GE(done.updates, kUpdates);
    EXPECT_EQ(done.failed_updates, 0U) << done.last_failure;
    EXPECT_EQ(done.refused_calls, 0U);
    EXPECT_TRUE(callback.has_sound);
    EXPECT_TRUE(callback.is_finite);
}

INSTANTIATE_TEST_SUITE_P(Channels,
                         AudioThreadOf,
                         testing::Values(propagation::Channels::mono,
                                         propagation::Channels::binaural,
                                         propagation::Channels::ambisonic));

}  // namespace
}  // namespace earshot::test
