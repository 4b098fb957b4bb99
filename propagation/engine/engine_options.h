// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/hrir_set.h"
#include "earshot/base/floating_point.h"
#include "earshot/propagation/response.h"
#include "earshot/propagation/simulator.h"

#include <cstddef>
#include <cstdint>

namespace earshot::propagation {

/// How much an update may cost. Work that does not fit is dropped or deferred in this order
/// (docs/engine.md): late sound has fewer rays or virtual sources, then waits; then the paths of
/// sources are not sought again, the least important ones first, so that only their delays follow
/// the motion. What was deferred comes first in the updates that follow.
struct UpdateBudget {
    /// Of wall time; 0: no limit. What is dropped then depends on the machine.
    double milliseconds = 0.0;
    /// In units of work: a frustum, a facet sequence that is verified, a reflection of a late ray,
    /// or a virtual source that a listener tests; 0: no limit. What is dropped, and so what is
    /// heard, then depends on the scene alone.
    std::uint64_t work = 0;
};

struct EngineOptions {
    /// Of paths and late rays. `rays` counts per source and renewal of its late sound; 0: none.
    /// Some members are set by the engine: report_paths, keep_traces, late_directions.
    Options simulation{.specular_order = 3};
    /// What every listener receives. Ambisonic and binaural sound follows how the listener is
    /// turned.
    Channels channels = Channels::ambisonic;
    /// Of ambisonic sound, and of the sound field that two ears hear: 0 ... kMaxAmbisonicOrder.
    int ambisonic_order = 3;
    audio::HrirSet hrir_set{};  ///< for binaural, of any sample rate
    double sample_rate = 48000.0;
    double start_time = 0.0;  ///< seconds of the scene's animation, until another is set
    /// Samples that are rendered at once, a power of two, 32 ... 4096.
    std::size_t block = 256;
    /// Calls of render() may have any number of frames, which costs a block of latency. Else they
    /// have a multiple of `block`.
    bool any_frame_count = false;
    /// Seconds by which motion is heard later than it is published, so that sound can follow it
    /// without steps: at least the time between updates.
    double motion_delay = 0.1;
    double max_delay = 1.0;        ///< seconds; paths that take longer are left out
    std::size_t max_paths = 512;   ///< per listener, of all sources; the faintest are left out
    std::size_t max_filters = 24;  ///< that stand for the spectra of all paths
    double late_length = 0.0;      ///< seconds; 0: as long as the decay, at most 3
    /// Virtual sources that each listener tests when the late sound of a source is renewed, by
    /// CoherentLateSound; 0: all rays are traced again, by trace_late_rays(). For budgets that are
    /// small: rays are then traced only where something has moved near them, and late sound does
    /// not flicker. Sources that stay are cheapest.
    std::size_t virtual_sources = 0;
    double update_interval = 0.05;  ///< seconds from one update to the next on the engine's thread
    UpdateBudget budget{};
    std::uint64_t seed = 1;  ///< of the noise that stands for late sound
};

/// Throws Error if an option is out of range.
void validate(const EngineOptions& options);

}  // namespace earshot::propagation
