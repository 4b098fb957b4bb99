// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/filter_basis.h"
#include "earshot/audio/harmonic_hrirs.h"
#include "earshot/audio/harmonic_rotation.h"
#include "earshot/audio/partitioned_filter.h"
#include "earshot/audio/source_lines.h"
#include "earshot/audio/tail_convolver.h"
#include "earshot/propagation/engine/engine_options.h"
#include "earshot/propagation/engine/internal/listener_voices.h"
#include "earshot/propagation/engine/internal/load_histogram.h"
#include "earshot/propagation/engine/internal/snapshot.h"

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace earshot::propagation {

/// How much there is of everything.
struct RenderSize {
    std::size_t sources = 0, listeners = 0;
    std::size_t harmonics = 1;  ///< channels of the sound field
    std::size_t outputs = 1;    ///< channels of a listener
    std::size_t tail_channels = 1;
    std::size_t tail_length = 0;  ///< samples; 0: no late sound
};

/// The audio side of an engine. Its constructor prepares everything; the rest belongs to the audio
/// thread but for the atomic members.
class AudioRenderer {
public:
    AudioRenderer(const EngineOptions& options,
                  const RenderSize& size,
                  const audio::FilterBasis& basis,
                  double speed_of_sound,
                  SnapshotExchange& exchange);
    ~AudioRenderer();
    AudioRenderer(const AudioRenderer&) = delete;
    AudioRenderer& operator=(const AudioRenderer&) = delete;

    /// As Engine::render().
    void render(const float* const* inputs, float* const* outputs, std::size_t frames) noexcept;
    std::size_t latency() const noexcept;

    /// Per listener, see pack_rotation().
    std::vector<std::atomic<std::uint64_t>>& rotations() noexcept { return rotations_; }
    std::uint64_t frames() const noexcept { return frames_.load(std::memory_order_relaxed); }
    const LoadHistogram& load() const noexcept { return load_; }
    std::uint64_t late_snapshots() const noexcept { return late_snapshots_.load(); }
    std::uint64_t refused_calls() const noexcept { return refused_calls_.load(); }

private:
    static constexpr std::size_t kMaxPending = 4;

    struct Listener {
        ListenerVoices voices;
        std::optional<audio::TailConvolver> tail{};
        std::optional<audio::MatrixConvolver> ears{};
        std::vector<float> rotation_from, rotation_to;
        std::uint64_t rotation = 0;
        bool is_turning = false;
        bool is_new = true;
    };

    void copy_in(const float* const* inputs,
                 std::size_t from,
                 std::size_t to,
                 std::size_t count) noexcept;
    void copy_out(float* const* outputs,
                  std::size_t from,
                  std::size_t to,
                  std::size_t count) const noexcept;
    void render_block() noexcept;
    void take_snapshots() noexcept;
    void begin_segment() noexcept;
    void begin_snapshot(Snapshot* snapshot) noexcept;
    void change_tails() noexcept;
    void release(Snapshot* snapshot) noexcept;
    void render_listener(std::size_t index) noexcept;
    void turn(Listener& listener, std::uint64_t rotation) noexcept;

    std::size_t block_;
    std::int64_t motion_delay_, catch_up_;  // frames
    bool any_frame_count_;
    Channels channels_;
    RenderSize size_;
    SnapshotExchange& exchange_;

    std::vector<audio::SourceLines> lines_;
    audio::ArrivalMixer mixer_;
    audio::HarmonicRotation rotation_;
    std::vector<audio::PartitionedFilter> ear_filters_;
    std::size_t ear_latency_ = 0;
    std::vector<Listener> listeners_;
    std::vector<std::atomic<std::uint64_t>> rotations_;

    // Snapshots: those to come, that on the way to which the voices are, and those whose tails
    // sound.
    std::array<Snapshot*, kMaxPending> pending_{};
    std::size_t pending_count_ = 0;
    Snapshot* current_ = nullptr;
    Snapshot* tails_ = nullptr;
    Snapshot* last_tails_ = nullptr;
    Segment segment_;
    std::size_t holds_ = 0;  // segments since the last snapshot
    std::int64_t now_ = 0;   // the first frame of the next block

    std::size_t filled_ = 0;  // of a block, with any frame count
    std::vector<float> in_, out_, field_, turned_;
    LoadHistogram load_;
    std::atomic<std::uint64_t> frames_{0}, late_snapshots_{0}, refused_calls_{0};
};

}  // namespace earshot::propagation
