// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/energy_histogram.h"
#include "earshot/audio/internal/energy_course.h"
#include "earshot/audio/room_metrics.h"

#include <optional>
#include <span>

namespace earshot::audio {

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
