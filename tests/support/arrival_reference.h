// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/impulse_response.h"

#include <complex>
#include <cstddef>
#include <span>
#include <vector>

namespace earshot::support {

/// The sum of separately filtered arrivals by its definition, with libm and a transform of its own:
/// it shares no code with `audio` but the struct of an arrival. Slow.
class ArrivalReference {
public:
    /// `centres_hz`: of the bands below half the sample rate; `filter_size`: a power of two.
    ArrivalReference(std::vector<double> centres_hz, double sample_rate, std::size_t filter_size);

    /// The filter and the delay's fraction, from 63 samples ahead of the arrival's whole sample on:
    /// filter_size + 127 samples of a linear convolution. Precondition: some pressure in use is not
    /// 0.
    std::vector<double> piece(const audio::Arrival& arrival) const;

    /// gains[i] times each arrival, `size` samples. Precondition: no delay is under 63 samples but
    /// whole ones.
    std::vector<double> sum(std::span<const audio::Arrival> arrivals,
                            std::span<const double> gains,
                            std::size_t size) const;

private:
    std::vector<double> filter(const audio::Arrival& arrival) const;

    std::vector<double> centres_hz_;
    double sample_rate_;
    std::size_t size_;
    std::vector<std::vector<double>> hat_of_band_, phase_of_band_;  // at the bins of size_
    std::vector<std::complex<double>> roots_;
};

/// How far `found` is from `expected`, in decibels.
struct ResponseError {
    double energy_db = 0.0;  ///< of the difference over that of `expected`
    double peak_db = 0.0;    ///< the same of the largest magnitudes
};
ResponseError response_error(std::span<const double> found, std::span<const double> expected);

}  // namespace earshot::support
