// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/floating_point.h"
#include "earshot/base/parallel.h"
#include "earshot/geometry/types.h"
#include "earshot/propagation/engine/engine_options.h"
#include "earshot/propagation/engine/engine_statistics.h"
#include "earshot/propagation/pose.h"
#include "earshot/propagation/scene.h"

#include <cstddef>
#include <memory>

namespace earshot::propagation {

/// The sound of a scene in real time (docs/engine.md; Lauterbach 2010, section 6.1.5). Three kinds
/// of threads meet here and never wait for each other:
///
/// * One control thread tells where sources, listeners and the scene are: place_source(),
///   place_listener(), set_scene_time(), then publish(). Of what is published the newest counts.
/// * One update thread, that of start() or the caller of update(), finds the paths for the newest
///   state and hands them to the sound.
/// * One audio thread calls render(), and nothing else of the engine but turn_listener(),
///   channels(), latency() and frames_rendered(): these take no lock, allocate no memory and make
///   no system call. Memory is freed on the update thread alone.
///
/// turn_listener(), statistics() and frames_rendered() may be called from any thread. All calls
/// may come from one thread, too: publish(), update() and render() in turn render into a file, and
/// without UpdateBudget::milliseconds the samples have the same bits each time.
///
/// A state is valid at the frame that is rendered next when it is published, and heard
/// EngineOptions::motion_delay later. Between states every path is a delay that changes as a cubic,
/// at the level of its length: what is heard is p(t) = s(t_e) / r, t = t_e + r / c. Paths that
/// begin or end fade from one state to the next. If updates are late, delays go on at their rates
/// for as long as the last state lasted, then come to rest.
class Engine {
public:
    /// The scene's sources and listeners are the engine's; the scene is not needed after this.
    /// Finds the first paths. Throws Error as validate(EngineOptions), Simulator and
    /// ResponseRenderer, or if there is no source or no listener. `executor` runs updates and must
    /// outlive the engine.
    explicit Engine(const Scene& scene,
                    const EngineOptions& options = {},
                    Executor& executor = Executor::serial());
    ~Engine();
    Engine(const Engine&) = delete;
    Engine& operator=(const Engine&) = delete;

    // Control thread.

    /// Where a source is and looks, in place of where the scene has it. What it is above is as near
    /// to the scene's +Y as that allows.
    void place_source(std::size_t source, const Pose& pose);
    /// Where a listener is; turn_listener() besides.
    void place_listener(std::size_t listener, const Pose& pose);
    /// The time of the scene's animation, seconds.
    void set_scene_time(double time);
    /// Makes what was set since the last call valid. Never waits.
    void publish() noexcept;

    // Any thread.

    /// How a listener is turned, from the next block on: head tracking goes straight to the sound.
    /// The position of `pose` counts for nothing. Sound turns evenly over a block.
    void turn_listener(std::size_t listener, const Pose& pose) noexcept;

    // Update thread.

    /// Takes the newest state, finds paths within the budget and hands them to the sound. Throws
    /// Error if a point on a surface has no side (Simulator::run); the paths before stay.
    /// Precondition: start() has not been called.
    void update();
    /// Starts the engine's update thread, which updates every EngineOptions::update_interval, or as
    /// often as it can. Errors are told by statistics().
    void start();
    /// Ends it. Also done by the destructor.
    void stop();

    // Audio thread.

    /// Renders `frames` of every channel of every listener: outputs[listener * channels() +
    /// channel] from inputs[source], where null is silence, both in linear pressure re the source's
    /// at 1 m. `frames` is a multiple of EngineOptions::block unless any_frame_count is set; else
    /// the outputs are silent.
    void render(const float* const* inputs, float* const* outputs, std::size_t frames) noexcept;
    /// Samples by which everything is heard late, besides the delays of paths.
    std::size_t latency() const noexcept;
    /// Frames so far.
    std::uint64_t frames_rendered() const noexcept;

    std::size_t sources() const noexcept;
    std::size_t listeners() const noexcept;
    std::size_t channels() const noexcept;  ///< of each listener
    double sample_rate() const noexcept;
    const EngineOptions& options() const noexcept;

    EngineStatistics statistics() const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace earshot::propagation
