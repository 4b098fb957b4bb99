// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/filter_cache.h"
#include "earshot/audio/hrir_interpolator.h"
#include "earshot/audio/hrir_set.h"
#include "earshot/audio/impulse_response.h"
#include "earshot/audio/speech.h"
#include "earshot/base/parallel.h"
#include "earshot/propagation/pair_metrics.h"
#include "earshot/propagation/pair_result.h"
#include "earshot/propagation/pose.h"

#include <cstdint>
#include <optional>
#include <vector>

namespace earshot::propagation {

/// What the channels of a response are: the pressure at a point, the pressures at two ears (left
/// first), or the spherical harmonics of the sound field (ACN, SN3D).
enum class Channels { mono, binaural, ambisonic };

/// The form in which a listener receives sound.
struct ResponseFormat {
    Channels channels = Channels::mono;
    int ambisonic_order = 1;       ///< 0 ... audio::kMaxAmbisonicOrder
    audio::HrirSet hrir_set{};     ///< for binaural, of any sample rate
    double sample_rate = 48000.0;  ///< hertz, 1000 ... 768000
    /// Seconds; 0: long enough for the last arrival, the ringing of its filter and the late sound.
    double length = 0.0;
    std::uint64_t seed = 1;      ///< of the noise that stands for late sound
    bool report_metrics = true;  ///< beside the channels; they take time
    /// For the speech transmission index of the metrics.
    std::optional<audio::SpeechConditions> speech{};
};

/// The impulse response of one pair, the channels equally long, and its metrics,
/// of which only the pair is told unless ResponseFormat::report_metrics.
struct Response {
    std::vector<audio::ImpulseResponse> channels;
    PairMetrics metrics;
};

/// Renders the responses of many pairs in one format. What depends on the bands and the format
/// alone is prepared once, and filters and memory are kept from one response to the next. Const
/// members may be called from many threads at once.
class ResponseRenderer {
public:
    /// Throws Error if the sample rate or the ambisonic order is out of range, or if a binaural
    /// format has no head-related impulse responses.
    ResponseRenderer(const audio::Bands& bands, ResponseFormat format);

    /// Adds each path at its exact delay and late sound as noise whose energy follows the
    /// histogram of the pair (audio::late_noise). The noise is a function of the seed and of
    /// PairResult::key, so it is the same at all times of an animation and whatever other pairs
    /// there are. Throws Error as
    /// audio::Assembler::assemble. Preconditions: the pair was simulated in the bands of the
    /// renderer, and with late directions unless the format is mono.
    Response render(const PairResult& pair,
                    const Pose& listener,
                    Executor& executor = Executor::serial()) const;

private:
    class Rendering;
    audio::Bands bands_;
    ResponseFormat format_;
    audio::Assembler assembler_;
    std::optional<audio::HrirInterpolator> hrirs_;
    audio::FilterCache cache_;
};

/// ResponseRenderer::render() for one pair.
Response render_response(const audio::Bands& bands,
                         const PairResult& pair,
                         const Pose& listener,
                         const ResponseFormat& format = {},
                         Executor& executor = Executor::serial());

}  // namespace earshot::propagation
