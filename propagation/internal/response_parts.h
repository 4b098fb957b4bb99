// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/filter_cache.h"
#include "earshot/audio/hrir_interpolator.h"
#include "earshot/audio/spatial.h"
#include "earshot/propagation/pose.h"
#include "earshot/propagation/response.h"

#include <cstdint>
#include <optional>
#include <vector>

namespace earshot::propagation {

audio::Orientation orientation_of(const Pose& pose);

/// Throws Error if the ambisonic order is out of range.
ResponseFormat checked_format(ResponseFormat format);

/// The head-related impulse responses of a binaural format at the sample rate of the response.
std::optional<audio::HrirInterpolator> prepared_hrirs(const ResponseFormat& format);

/// What late sound is made with, beside the histogram.
struct LateFormat {
    const audio::Bands& bands;
    const ResponseFormat& format;
    Channels channels = Channels::mono;  ///< those of the format, or one in place of two ears
    const std::optional<audio::HrirInterpolator>& hrirs;  ///< of a binaural format
    const audio::FilterCache& cache;
    std::uint64_t seed = 1;
};

/// The late sound of a response, per channel.
std::vector<std::vector<double>> late_channels(const LateFormat& late,
                                               const audio::EnergyHistogram& histogram,
                                               const audio::Orientation& orientation);

}  // namespace earshot::propagation
