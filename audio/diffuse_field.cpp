// SPDX-License-Identifier: MIT
#include "earshot/audio/diffuse_field.h"

#include "earshot/audio/internal/direction_triangulation.h"
#include "earshot/audio/internal/fft.h"
#include "earshot/audio/internal/hrir_onset.h"
#include "earshot/audio/internal/minimum_phase.h"
#include "earshot/base/error.h"
#include "earshot/base/math.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <span>

namespace earshot::audio {

namespace {

using Complex = std::complex<double>;

// Magnitudes are 0 dB up to the first frequency and the measured ones from an octave above it on.
// Excess phases, whose errors reach higher, are left out up to the second, and as measured from an
// octave above it on.
constexpr double kHeadlessHz = 150.0;
constexpr double kNoExcessPhaseHz = 250.0;

// The equalisation raises no frequency by more than this over its mean from 200 Hz to 10 kHz: what
// the loudspeaker does not play near half the sample rate is noise.
constexpr double kMaxBoostDb = 18.0;

// A magnitude further below a response's largest is taken to be this far below (-100 dB).
constexpr double kMagnitudeFloor = 1e-5;

// Seconds over which cepstra and responses may ring before they fold onto themselves.
constexpr double kTransformLength = 0.15;

// The last quarter of the responses fades out.
constexpr double kFade = 0.25;

// 0 up to a frequency, 1 from an octave above it on, the halves of a cosine between.
double octave_fade(double hz, double begin_hz) {
    if (hz <= begin_hz) {
        return 0.0;
    }
    const double octaves = std::min(1.0, math::log2(hz / begin_hz));
    return 0.5 - 0.5 * math::cos(math::kPi * octaves);
}

class Equaliser {
public:
    explicit Equaliser(const HrirSet& set) : set_(set), max_samples_(0), fft_(4), onset_of_(0) {
        for (const Hrir& m : set.directions) {
            max_samples_ = std::max({max_samples_, m.left.size(), m.right.size()});
        }
        const double room = kTransformLength * set.sample_rate;
        fft_ = RealFft(power_of_two_from(
            std::max(2 * max_samples_, static_cast<std::size_t>(std::ceil(room)))));
        onset_of_ = OnsetFinder(max_samples_);
        log_gain_ = equalisation();
        for (std::size_t k = 0; k < fft_.bins(); ++k) {
            magnitude_fade_.push_back(octave_fade(hz(k), kHeadlessHz));
            phase_fade_.push_back(octave_fade(hz(k), kNoExcessPhaseHz));
        }
    }

    std::vector<double> operator()(const std::vector<double>& response) const;

private:
    double hz(std::size_t k) const {
        return static_cast<double>(k) * set_.sample_rate / static_cast<double>(fft_.size());
    }

    std::vector<Complex> spectrum_of(const std::vector<double>& response) const {
        std::vector<double> signal(fft_.size(), 0.0);
        std::copy(response.begin(), response.end(), signal.begin());
        std::vector<Complex> spectrum(fft_.bins());
        fft_.forward(signal, spectrum);
        return spectrum;
    }

    std::vector<double> diffuse_field_power() const;
    std::vector<double> smoothed(std::span<const double> power) const;
    std::vector<double> equalisation() const;

    const HrirSet& set_;
    std::size_t max_samples_;
    RealFft fft_;
    OnsetFinder onset_of_;
    std::vector<double> log_gain_;  // per bin, natural logarithm
    std::vector<double> magnitude_fade_;
    std::vector<double> phase_fade_;
};

// Mean over the sphere and both ears.
std::vector<double> Equaliser::diffuse_field_power() const {
    std::vector<Direction> directions;
    for (const Hrir& measurement : set_.directions) {
        directions.push_back(measurement.towards);
    }
    const std::vector<double> shares = DirectionTriangulation(directions).sphere_shares();
    std::vector<double> power(fft_.bins(), 0.0);
    for (std::size_t i = 0; i < set_.directions.size(); ++i) {
        for (const auto* ear : {&set_.directions[i].left, &set_.directions[i].right}) {
            const std::vector<Complex> spectrum = spectrum_of(*ear);
            for (std::size_t k = 0; k < power.size(); ++k) {
                power[k] += 0.5 * shares[i] * std::norm(spectrum[k]);
            }
        }
    }
    return power;
}

// Mean over a third of an octave about each frequency.
std::vector<double> Equaliser::smoothed(std::span<const double> power) const {
    std::vector<double> sum(power.size() + 1, 0.0);
    for (std::size_t k = 0; k < power.size(); ++k) {
        sum[k + 1] = sum[k] + power[k];
    }
    const double half_width = math::pow(2.0, 1.0 / 6.0);
    std::vector<double> result(power.size());
    for (std::size_t k = 0; k < power.size(); ++k) {
        const auto middle = static_cast<double>(k);
        const auto first = static_cast<std::size_t>(std::round(middle / half_width));
        const std::size_t last =
            std::min(static_cast<std::size_t>(std::round(middle * half_width)), power.size() - 1);
        result[k] = (sum[last + 1] - sum[first]) / static_cast<double>(last + 1 - first);
    }
    return result;
}

// Logarithm of the gain per bin that makes the diffuse-field response flat.
std::vector<double> Equaliser::equalisation() const {
    const std::vector<double> power = smoothed(diffuse_field_power());
    const double max_power = *std::max_element(power.begin(), power.end());
    if (max_power == 0.0) {
        throw Error("HRIR set", "all responses are silent", "export it again");
    }
    std::vector<double> log_gain(power.size());
    double weight_sum = 0.0;
    double mean = 0.0;  // over the logarithm of the frequency
    for (std::size_t k = 0; k < power.size(); ++k) {
        const double floor = kMagnitudeFloor * kMagnitudeFloor * max_power;
        log_gain[k] = -0.5 * math::log(std::max(power[k], floor));
        if (hz(k) > 200.0 && hz(k) < 10000.0) {
            mean += log_gain[k] / hz(k);
            weight_sum += 1.0 / hz(k);
        }
    }
    mean /= weight_sum;
    const double limit = mean + kMaxBoostDb / 20.0 * math::log(10.0);
    for (std::size_t k = 0; k < power.size(); ++k) {
        // Lower frequencies count for the phase above them only; their magnitude is replaced.
        if (hz(k) > 1000.0) {
            log_gain[k] = std::min(log_gain[k], limit);
        }
    }
    return log_gain;
}

std::vector<double> Equaliser::operator()(const std::vector<double>& response) const {
    const auto onset = onset_of_(response);
    if (!onset) {
        return response;
    }
    std::vector<Complex> spectrum = spectrum_of(response);
    double largest = 0.0;
    for (const Complex& value : spectrum) {
        largest = std::max(largest, std::sqrt(std::norm(value)));
    }
    std::vector<Complex> measured(fft_.bins());
    std::vector<Complex> wanted(fft_.bins());
    for (std::size_t k = 0; k < fft_.bins(); ++k) {
        measured[k] =
            math::log(std::max(std::sqrt(std::norm(spectrum[k])), kMagnitudeFloor * largest));
        wanted[k] = magnitude_fade_[k] * (measured[k] + log_gain_[k]);
    }
    const std::vector<double> measured_phase = minimum_phase(fft_, measured);
    const std::vector<double> wanted_phase = minimum_phase(fft_, wanted);
    for (std::size_t k = 0; k < fft_.bins(); ++k) {
        // What the measured phase has beyond that of minimum phase and of the onset's delay.
        const double delay_phase =
            2.0 * math::kPi * *onset * static_cast<double>(k) / static_cast<double>(fft_.size());
        const double excess =
            math::atan2(spectrum[k].imag(), spectrum[k].real()) - measured_phase[k] + delay_phase;
        const double wrapped = excess - 2.0 * math::kPi * std::round(excess / (2.0 * math::kPi));
        const double phase = wanted_phase[k] + phase_fade_[k] * wrapped - delay_phase;
        const double magnitude = math::exp(wanted[k].real());
        spectrum[k] = {magnitude * math::cos(phase), magnitude * math::sin(phase)};
    }
    std::vector<double> samples(fft_.size());
    fft_.inverse(spectrum, samples);
    samples.resize(static_cast<std::size_t>(kEqualisedLength * set_.sample_rate + 0.5));
    const double fade_length = kFade * static_cast<double>(samples.size());
    for (std::size_t n = 0; n < samples.size(); ++n) {
        const double left = static_cast<double>(samples.size() - n) - 0.5;
        if (left < fade_length) {
            samples[n] *= 0.5 - 0.5 * math::cos(math::kPi * left / fade_length);
        }
    }
    return samples;
}

}  // namespace

HrirSet diffuse_field_equalised(const HrirSet& set) {
    HrirSet result = farthest_measurements(set);
    if (result.directions.empty()) {
        throw Error("HRIR set", "there are no responses in it", "read a SOFA file that has some");
    }
    result.centre_delay = common_delay(result);
    const HrirSet measured = result;
    const Equaliser equalise(measured);
    for (Hrir& direction : result.directions) {
        direction.left = equalise(direction.left);
        direction.right = equalise(direction.right);
    }
    return result;
}

}  // namespace earshot::audio
