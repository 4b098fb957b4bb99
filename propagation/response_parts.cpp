// SPDX-License-Identifier: MIT
#include "earshot/propagation/internal/response_parts.h"

#include "earshot/audio/late_noise.h"
#include "earshot/base/error.h"

#include <array>
#include <string>
#include <utility>

namespace earshot::propagation {

audio::Orientation orientation_of(const Pose& pose) {
    const auto components = [](const geometry::Vec3& v) {
        return std::array<double, 3>{v.x, v.y, v.z};
    };
    return {
        .front = components(pose.front), .left = components(pose.left), .up = components(pose.up)};
}

ResponseFormat checked_format(ResponseFormat format) {
    if (format.channels == Channels::ambisonic &&
        (format.ambisonic_order < 0 || format.ambisonic_order > audio::kMaxAmbisonicOrder)) {
        throw Error("ambisonic order",
                    "must lie in 0 ... " + std::to_string(audio::kMaxAmbisonicOrder) + ", not " +
                        std::to_string(format.ambisonic_order));
    }
    return format;
}

std::optional<audio::HrirInterpolator> prepared_hrirs(const ResponseFormat& format) {
    if (format.channels != Channels::binaural) {
        return std::nullopt;
    }
    return audio::HrirInterpolator(
        audio::resampled(audio::farthest_measurements(format.hrir_set), format.sample_rate));
}

std::vector<std::vector<double>> late_channels(const LateFormat& late,
                                               const audio::EnergyHistogram& histogram,
                                               const audio::Orientation& orientation) {
    const ResponseFormat& format = late.format;
    switch (late.channels) {
        case Channels::mono:
            break;
        case Channels::ambisonic:
            return audio::ambisonic_late_noise(late.bands,
                                               histogram,
                                               format.sample_rate,
                                               late.seed,
                                               format.ambisonic_order,
                                               orientation,
                                               late.cache);
        case Channels::binaural: {
            auto ears = audio::binaural_late_noise(
                late.bands, histogram, *late.hrirs, late.seed, orientation, late.cache);
            return {std::move(ears[0]), std::move(ears[1])};
        }
    }
    return {audio::late_noise(late.bands, histogram, format.sample_rate, late.seed, late.cache)};
}

}  // namespace earshot::propagation
