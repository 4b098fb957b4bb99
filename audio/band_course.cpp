// SPDX-License-Identifier: MIT
#include "earshot/audio/internal/band_course.h"

#include <algorithm>
#include <span>
#include <utility>

namespace earshot::audio {

namespace {

constexpr double kRingingCells = 3.0;    // times 1 / bandwidth, after which little rings
constexpr std::size_t kMaxRinging = 20;  // at most this part of a response is left out for it

}  // namespace

BandCourse band_course(std::vector<double> squared,
                       std::size_t lead,
                       double bandwidth_hz,
                       const ImpulseResponse& response,
                       std::size_t onset,
                       bool ends_in_noise) {
    BandCourse course{.squared = std::move(squared), .onset = lead + onset, .noise = {}};
    if (!ends_in_noise) {
        return course;
    }
    // The recording's end is a step, which rings.
    const auto ringing =
        static_cast<std::size_t>(kRingingCells / bandwidth_hz * response.sample_rate);
    const std::size_t end = lead + response.samples.size() -
                            std::min(ringing, (response.samples.size() - onset) / kMaxRinging);
    course.noise = find_noise_floor({.squared = std::span(course.squared).first(end),
                                     .onset = course.onset,
                                     .sample_rate = response.sample_rate,
                                     .bandwidth_hz = bandwidth_hz});
    if (course.noise.energy > 0.0) {
        course.squared.resize(std::max(course.noise.cross_point, course.onset + 1));
        if (course.noise.peak_to_noise_db >= kMinPeakToNoiseDb) {
            for (std::size_t n = lead; n < course.squared.size(); ++n) {
                course.squared[n] -= course.noise.energy;
            }
        }
    }
    return course;
}

}  // namespace earshot::audio
