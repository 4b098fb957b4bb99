// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/bands.h"
#include "earshot/audio/filter_cache.h"
#include "earshot/audio/impulse_response.h"
#include "earshot/audio/metric_note.h"

#include <cstddef>
#include <optional>
#include <vector>

namespace earshot::audio {

/// Per band; empty where the response does not support it.
struct LateralMetrics {
    std::vector<std::optional<double>> lateral_fraction;  ///< LF (J_LF)
    std::vector<MetricNote> notes;                        ///< why a value is empty
};

/// Early lateral energy fraction: energy of the figure-of-eight from 5 to 80 ms after the direct
/// sound over that of the pressure until 80 ms (ISO 3382-1:2009, A.2.4), from channels 0 and 1 of
/// an ambisonic response (ACN, SN3D). In low bands the filter's ringing carries direct sound past 5
/// ms. `onset`: a sample; looked for where it is not given.
/// Precondition: both have one sample rate and size.
LateralMetrics lateral_metrics(const Bands& bands,
                               const ImpulseResponse& pressure,
                               const ImpulseResponse& figure_of_eight,
                               std::optional<std::size_t> onset = {});
/// The same with filters that are kept.
LateralMetrics lateral_metrics(const Bands& bands,
                               const ImpulseResponse& pressure,
                               const ImpulseResponse& figure_of_eight,
                               std::optional<std::size_t> onset,
                               const FilterCache& cache);

/// Per band; empty where the response does not support it.
struct BinauralMetrics {
    std::vector<std::optional<double>> iacc_early;  ///< of the first 80 ms
    std::vector<std::optional<double>> iacc_late;   ///< from 80 ms on
    std::vector<std::optional<double>> iacc;        ///< of the whole response
    std::vector<MetricNote> notes;                  ///< why a value is empty
};

/// Interaural cross-correlation coefficients: the largest magnitude of the normalised correlation
/// of the ears within 1 ms either way (ISO 3382-1:2009, annex B), at whole samples. Times count
/// from the earlier ear's direct sound. Precondition: both have one sample rate and size.
BinauralMetrics binaural_metrics(const Bands& bands,
                                 const ImpulseResponse& left,
                                 const ImpulseResponse& right);
/// The same with filters that are kept.
BinauralMetrics binaural_metrics(const Bands& bands,
                                 const ImpulseResponse& left,
                                 const ImpulseResponse& right,
                                 const FilterCache& cache);

}  // namespace earshot::audio
