// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/energy_histogram.h"
#include "earshot/audio/internal/energy_course.h"
#include "earshot/audio/internal/modulation.h"
#include "earshot/audio/room_metrics.h"

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace earshot::audio {

/// What the speech transmission index of a course is computed from.
struct SpeechCourse {
    std::array<ModulationSums, kSpeechBands> octaves{};
    std::optional<SpeechConditions> conditions{};
};

/// The bands that an octave of speech is the mean of: itself, or three thirds.
struct OctaveBands {
    std::size_t first = 0;
    std::size_t count = 0;
};
OctaveBands bands_of_speech_octave(const Bands& bands, std::size_t octave);

/// Standard errors of `values` by the jackknife (Efron and Tibshirani 1993, chapter 11): the
/// metrics are evaluated with each replicate left out of the mean of the late energy. `bin`: of the
/// histogram, seconds; `speech` without a value has no error. A metric that has no value has no
/// error, nor has any with fewer than two replicates.
MetricValues metric_errors(const Bands& bands,
                           const MetricValues& values,
                           const EnergyCourse& course,
                           const std::optional<SpeechCourse>& speech,
                           const HistogramReplicates& replicates,
                           double bin);

}  // namespace earshot::audio
