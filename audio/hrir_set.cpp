// SPDX-License-Identifier: MIT
#include "earshot/audio/hrir_set.h"

#include "earshot/audio/internal/hrir_onset.h"
#include "earshot/base/assert.h"
#include "earshot/base/math.h"

#include <algorithm>
#include <iterator>

namespace earshot::audio {

namespace {

// Measurements at distances down to this factor of the largest count as one distance.
constexpr double kSameDistance = 0.9;

// The radius of a head over the speed of sound, where the directions of a set do not tell it.
constexpr double kUsualRadiusSeconds = 0.0875 / 343.2;

// The delay at an ear re the head's centre in units of the radius over the speed of sound, from the
// cosine of the angle between the directions of the source and of the ear.
double spherical_head_delay(double cosine) {
    return cosine >= 0.0 ? -cosine : math::acos(std::max(-1.0, cosine)) - math::kPi / 2.0;
}

}  // namespace

HrirSet farthest_measurements(const HrirSet& set) {
    double largest = 0.0;
    for (const Hrir& measurement : set.directions) {
        largest = std::max(largest, measurement.distance);
    }
    HrirSet result{.sample_rate = set.sample_rate, .directions{}, .centre_delay = set.centre_delay};
    std::copy_if(set.directions.begin(),
                 set.directions.end(),
                 std::back_inserter(result.directions),
                 [&](const Hrir& m) { return m.distance >= kSameDistance * largest; });
    return result;
}

std::size_t closest_direction(const HrirSet& set, const std::array<double, 3>& towards) {
    EARSHOT_ASSERT(!set.directions.empty());
    std::size_t nearest = 0;
    double largest = -2.0;
    for (std::size_t i = 0; i < set.directions.size(); ++i) {
        const auto& [x, y, z] = set.directions[i].towards;
        const double cosine = x * towards[0] + y * towards[1] + z * towards[2];
        if (cosine > largest) {
            largest = cosine;
            nearest = i;
        }
    }
    return nearest;
}

double common_delay(const HrirSet& set) {
    const HrirSet far = farthest_measurements(set);
    std::size_t max_samples = 0;
    for (const Hrir& measurement : far.directions) {
        max_samples = std::max({max_samples, measurement.left.size(), measurement.right.size()});
    }
    // Least squares for onset = delay + radius * model: sums of the normal equations.
    const OnsetFinder onset_of(max_samples);
    double count = 0.0;
    double model_sum = 0.0;
    double onset_sum = 0.0;
    double square_sum = 0.0;
    double product_sum = 0.0;
    const auto add = [&](const std::vector<double>& response, double cosine) {
        if (const auto onset = onset_of(response)) {
            const double model = spherical_head_delay(cosine);
            count += 1.0;
            model_sum += model;
            onset_sum += *onset;
            square_sum += model * model;
            product_sum += model * *onset;
        }
    };
    for (const Hrir& measurement : far.directions) {
        add(measurement.left, measurement.towards[1]);
        add(measurement.right, -measurement.towards[1]);
    }
    if (count == 0.0) {
        return 0.0;
    }
    const double mean_model = model_sum / count;
    const double mean_onset = onset_sum / count;
    const double variance = square_sum / count - mean_model * mean_model;
    // Directions that all lie in front or behind do not tell the radius.
    constexpr double kMinVariance = 0.01;
    const double radius = variance > kMinVariance
                              ? (product_sum / count - mean_model * mean_onset) / variance
                              : kUsualRadiusSeconds * far.sample_rate;
    return (mean_onset - radius * mean_model) / far.sample_rate;
}

}  // namespace earshot::audio
