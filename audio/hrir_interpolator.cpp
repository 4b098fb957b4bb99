// SPDX-License-Identifier: MIT
#include "earshot/audio/hrir_interpolator.h"

#include "earshot/audio/internal/direction_triangulation.h"
#include "earshot/audio/internal/fractional_delay.h"
#include "earshot/audio/internal/hrir_onset.h"
#include "earshot/audio/internal/signal_kernel.h"
#include "earshot/base/error.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>

namespace earshot::audio {

namespace {

struct EarResponse {
    std::vector<double> samples;
    std::optional<double> onset;  // in samples; none if silent
};

// A response, moved and scaled, as a part of a sum.
struct Term {
    const EarResponse* response;
    double weight;
    double shift;  // samples
};

// The samples of the impulse that moves a response ahead of its shift's whole samples.
constexpr std::ptrdiff_t kLead = static_cast<std::ptrdiff_t>(kDelayHalfLength) - 1;

std::ptrdiff_t begin_of(const Term& term) {
    const double whole = std::floor(term.shift);
    return static_cast<std::ptrdiff_t>(whole) - (term.shift == whole ? 0 : kLead);
}

std::ptrdiff_t end_of(const Term& term) {
    const double whole = std::floor(term.shift);
    const auto extra = term.shift == whole ? 0 : static_cast<std::ptrdiff_t>(kDelayHalfLength);
    return static_cast<std::ptrdiff_t>(whole) + extra +
           static_cast<std::ptrdiff_t>(term.response->samples.size());
}

// Adds the term to a sum whose first sample is at `begin`.
void add(const Term& term, std::ptrdiff_t begin, std::span<double> sum) {
    const std::vector<double>& samples = term.response->samples;
    const auto first = static_cast<std::size_t>(begin_of(term) - begin);
    const double fraction = term.shift - std::floor(term.shift);
    if (fraction == 0.0) {
        for (std::size_t n = 0; n < samples.size(); ++n) {
            sum[first + n] += term.weight * samples[n];
        }
        return;
    }
    std::array<double, kDelayTaps + 2 * kConvolutionMargin> taps{};
    const auto impulse = fractional_impulse(fraction);
    std::copy(impulse.begin(), impulse.end(), taps.begin() + kConvolutionMargin);
    add_convolution(term.weight,
                    samples.data(),
                    samples.size(),
                    &taps[kConvolutionMargin],
                    kDelayTaps,
                    &sum[first]);
}

std::vector<Direction> directions_of(const HrirSet& set) {
    std::vector<Direction> directions;
    for (const Hrir& measurement : set.directions) {
        directions.push_back(measurement.towards);
    }
    return directions;
}

HrirSet checked(const HrirSet& set) {
    if (set.directions.empty()) {
        throw Error("HRIR set", "there are no responses in it", "read a SOFA file that has some");
    }
    return farthest_measurements(set);
}

}  // namespace

struct HrirInterpolator::Prepared {
    explicit Prepared(const HrirSet& set)
        : sample_rate(set.sample_rate),
          centre_delay(set.centre_delay * set.sample_rate),
          triangulation(directions_of(set)) {
        std::size_t max_samples = 0;
        for (const Hrir& measurement : set.directions) {
            max_samples =
                std::max({max_samples, measurement.left.size(), measurement.right.size()});
        }
        const OnsetFinder onset_of(max_samples);
        for (const Hrir& measurement : set.directions) {
            ears[0].push_back({measurement.left, onset_of(measurement.left)});
            ears[1].push_back({measurement.right, onset_of(measurement.right)});
        }
    }

    // What an ear hears: the responses with weights, each moved to their mean onset. One response
    // alone moves by the delay of the centre only, which is exact.
    std::vector<Term> terms(std::size_t ear, const DirectionWeights& weights) const {
        std::vector<Term> result;
        double weight_sum = 0.0;
        double onset_sum = 0.0;
        for (std::size_t k = 0; k < weights.index.size(); ++k) {
            const EarResponse& response = ears[ear][weights.index[k]];
            if (weights.weight[k] > 0.0 && response.onset) {
                result.push_back({&response, weights.weight[k], -centre_delay});
                weight_sum += weights.weight[k];
                onset_sum += weights.weight[k] * *response.onset;
            }
        }
        if (result.size() > 1) {
            for (Term& term : result) {
                term.shift += onset_sum / weight_sum - *term.response->onset;
            }
        }
        return result;
    }

    double sample_rate;
    double centre_delay;  // samples
    DirectionTriangulation triangulation;
    std::array<std::vector<EarResponse>, 2> ears;  // per direction
};

HrirInterpolator::HrirInterpolator(const HrirSet& set)
    : prepared_(std::make_shared<const Prepared>(checked(set))) {}

double HrirInterpolator::sample_rate() const noexcept {
    return prepared_->sample_rate;
}

InterpolatedHrir HrirInterpolator::at(const std::array<double, 3>& towards) const {
    const DirectionWeights weights = prepared_->triangulation.weights(towards);
    const std::array<std::vector<Term>, 2> terms = {prepared_->terms(0, weights),
                                                    prepared_->terms(1, weights)};
    std::optional<std::ptrdiff_t> begin;
    std::ptrdiff_t end = 0;
    for (const auto& ear : terms) {
        for (const Term& term : ear) {
            end = begin ? std::max(end, end_of(term)) : end_of(term);
            begin = begin ? std::min(*begin, begin_of(term)) : begin_of(term);
        }
    }
    InterpolatedHrir result;
    if (!begin) {
        return result;
    }
    result.begin = *begin;
    for (std::size_t ear = 0; ear < 2; ++ear) {
        result.ears[ear].resize(static_cast<std::size_t>(end - *begin), 0.0);
        for (const Term& term : terms[ear]) {
            add(term, *begin, result.ears[ear]);
        }
    }
    return result;
}

}  // namespace earshot::audio
