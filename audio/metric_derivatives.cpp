// SPDX-License-Identifier: MIT
#include "earshot/audio/metric_derivatives.h"

#include "earshot/audio/energy_metrics.h"
#include "earshot/audio/internal/decay_curve.h"
#include "earshot/audio/internal/decay_kernel.h"
#include "earshot/audio/internal/energy_course.h"
#include "earshot/audio/internal/metrics_reader.h"
#include "earshot/audio/internal/speech_gradient.h"
#include "earshot/base/math.h"

#include <algorithm>
#include <cmath>

namespace earshot::audio {

namespace {

// An instant is in the range of a reverberation time or not, so that a time jumps when the level of
// an instant passes an end of the range. What jumps within half of this of an end, decibels, counts
// as if it came evenly: the derivative is the mean over a change that moves the ends by as much. It
// takes in some ten steps of a dense decay, and tells the trend where a decay falls in coarse
// steps.
constexpr double kEndWidthDb = 1.0;

/// Sums over levels that give the slope of the line through any part of a decay at once.
class LevelSums {
public:
    LevelSums() = default;
    /// Levels in nepers of energy, of any reference.
    explicit LevelSums(std::span<const double> levels)
        : levels_(levels.size() + 1), moments_(levels.size() + 1) {
        for (std::size_t n = 0; n < levels.size(); ++n) {
            levels_[n + 1] = levels_[n] + levels[n];
            moments_[n + 1] = moments_[n] + static_cast<double>(n) * levels[n];
        }
    }

    /// Of the line by least squares: the sum of (n - middle) level[n], over the spread of n.
    double slope(std::size_t begin, std::size_t end) const {
        const auto count = static_cast<double>(end - begin);
        const double middle = static_cast<double>(begin) + 0.5 * (count - 1.0);
        const double moment = moments_[end] - moments_[begin];
        return (moment - middle * (levels_[end] - levels_[begin])) / spread(count);
    }
    static double spread(double count) { return count * (count * count - 1.0) / 12.0; }

private:
    std::vector<double> levels_, moments_;  // of the instants before each
};

/// The gradients of the metrics of one band by its energy per instant.
class BandGradient {
public:
    BandGradient(std::span<const double> energy, std::size_t onset, double sample_rate)
        : onset_(onset), sample_rate_(sample_rate), remaining_(energy.size()) {
        double sum = 0.0;
        for (std::size_t n = energy.size(); n-- > 0;) {
            sum += energy[n];
            remaining_[n] = sum;
        }
        const std::size_t end = first_below(-kT30.to_db - kEndWidthDb / 2.0);
        std::vector<double> levels(end - onset);
        for (std::size_t n = onset; n < end; ++n) {
            levels[n - onset] = remaining_[n] / remaining_.front();
        }
        natural_logs(levels, levels);
        level_sums_ = LevelSums(levels);
    }

    std::vector<double> of_time(const DecayRange& range, double time) const;
    std::vector<double> of_clarity(double limit) const;
    std::vector<double> of_definition(double limit) const;
    std::vector<double> of_centre(double centre) const;
    std::vector<double> of_strength() const;

private:
    /// The first instant after the onset at which less than that is still to come.
    std::size_t first_below(double level_db) const {
        const double limit = remaining_.front() * math::pow10(level_db / 10.0);
        const auto begin = remaining_.begin() + static_cast<std::ptrdiff_t>(onset_);
        const auto found = std::partition_point(
            begin, remaining_.end(), [&](double remaining) { return remaining >= limit; });
        return std::min(static_cast<std::size_t>(found - remaining_.begin()),
                        remaining_.size() - 1);
    }
    /// Slope of the line through the levels of instants from the onset on, nepers per instant.
    double slope(std::size_t begin, std::size_t end) const {
        return level_sums_.slope(begin - onset_, end - onset_);
    }
    /// The instants whose levels are next to an end of a range.
    Instants next_to(int below_db) const {
        return {first_below(-below_db + kEndWidthDb / 2.0),
                first_below(-below_db - kEndWidthDb / 2.0)};
    }
    /// The first instant of the energy from a limit on; the last, if there is none.
    std::size_t limit_instant(double limit) const {
        return std::min(onset_ + static_cast<std::size_t>(std::llround(limit * sample_rate_)),
                        remaining_.size() - 1);
    }
    /// Turns derivatives by the energies still to come into such by the energies: an energy is
    /// still to come at all instants up to its own.
    static std::vector<double> by_energy(std::vector<double> by_remaining) {
        double sum = 0.0;
        for (double& number : by_remaining) {
            sum += number;
            number = sum;
        }
        return by_remaining;
    }

    std::size_t onset_;
    double sample_rate_;
    std::vector<double> remaining_;  // energy from each instant on
    LevelSums level_sums_;           // from the onset to the lowest end of a range
};

// The line through the levels by least squares: an instant's level counts with its lever, and the
// slope changes when an instant enters or leaves the range.
std::vector<double> BandGradient::of_time(const DecayRange& range, double time) const {
    std::vector<double> by_remaining(remaining_.size());
    const std::size_t begin = range.from_db == 0 ? onset_ : first_below(-range.from_db);
    const std::size_t end = first_below(-range.to_db);
    if (end < begin + 2) {
        return by_remaining;
    }
    // time = -60 / slope, decibels per second.
    const double by_slope = kDbPerLogEnergy * time * time / 60.0 * sample_rate_;
    const auto count = static_cast<double>(end - begin);
    const double middle = static_cast<double>(begin) + 0.5 * (count - 1.0);
    for (std::size_t n = begin; n < end; ++n) {
        const double lever = static_cast<double>(n) - middle;
        by_remaining[n] += by_slope * lever / LevelSums::spread(count) / remaining_[n];
    }
    // An instant whose level rises enters at the lower end and leaves at the upper one. The level
    // is that re the whole.
    const double by_jump = by_slope * kDbPerLogEnergy / kEndWidthDb;
    const auto add_jump = [&](std::size_t instant, double change_of_slope) {
        by_remaining[instant] += by_jump * change_of_slope / remaining_[instant];
        by_remaining.front() -= by_jump * change_of_slope / remaining_.front();
    };
    const Instants lower = next_to(range.to_db);
    for (std::size_t n = std::max(lower.begin, begin + 2); n < lower.end; ++n) {
        add_jump(n, slope(begin, n + 1) - slope(begin, n));
    }
    if (range.from_db > 0) {
        const Instants upper = next_to(range.from_db);
        for (std::size_t n = upper.begin; n < std::min(upper.end, end - 2); ++n) {
            add_jump(n, slope(n + 1, end) - slope(n, end));
        }
    }
    return by_energy(std::move(by_remaining));
}

std::vector<double> BandGradient::of_clarity(double limit) const {
    std::vector<double> by_remaining(remaining_.size());
    const std::size_t instant = limit_instant(limit);
    const double late = remaining_[instant];
    const double early = remaining_.front() - late;
    by_remaining.front() += kDbPerLogEnergy / early;
    by_remaining[instant] -= kDbPerLogEnergy * (1.0 / early + 1.0 / late);
    return by_energy(std::move(by_remaining));
}

std::vector<double> BandGradient::of_definition(double limit) const {
    std::vector<double> by_remaining(remaining_.size());
    const std::size_t instant = limit_instant(limit);
    const double all = remaining_.front();
    by_remaining.front() += remaining_[instant] / (all * all);
    by_remaining[instant] -= 1.0 / all;
    return by_energy(std::move(by_remaining));
}

std::vector<double> BandGradient::of_centre(double centre) const {
    std::vector<double> gradient(remaining_.size());
    for (std::size_t n = 0; n < gradient.size(); ++n) {
        const double time = (static_cast<double>(n) - static_cast<double>(onset_)) / sample_rate_;
        gradient[n] = (time - centre) / remaining_.front();
    }
    return gradient;
}

std::vector<double> BandGradient::of_strength() const {
    return std::vector<double>(remaining_.size(), kDbPerLogEnergy / remaining_.front());
}

std::vector<double> gradient_of(const BandGradient& band, std::size_t kind, double value) {
    const auto metric = kBandMetricKinds[kind].value;
    if (metric == &BandMetrics::early_decay_time) {
        return band.of_time(kEarlyDecay, value);
    }
    if (metric == &BandMetrics::reverberation_time_t20) {
        return band.of_time(kT20, value);
    }
    if (metric == &BandMetrics::reverberation_time_t30) {
        return band.of_time(kT30, value);
    }
    if (metric == &BandMetrics::clarity_c50_db) {
        return band.of_clarity(kSpeechLimit);
    }
    if (metric == &BandMetrics::clarity_c80_db) {
        return band.of_clarity(kMusicLimit);
    }
    if (metric == &BandMetrics::definition_d50) {
        return band.of_definition(kSpeechLimit);
    }
    return metric == &BandMetrics::centre_time ? band.of_centre(value) : band.of_strength();
}

/// Where on the grid the energies of arrivals and bins are.
class Places {
public:
    Places(std::span<const Arrival> arrivals,
           const EnergyHistogram& late,
           double sample_rate,
           std::size_t instants) {
        for (const Arrival& arrival : arrivals) {
            arrivals_.push_back(static_cast<std::size_t>(arrival.delay * sample_rate));
        }
        for (std::size_t n = 0; n < late.energy.size(); ++n) {
            const Instants bin = instants_of_bin(late, n, sample_rate);
            bins_.push_back({bin.begin, std::min(bin.end, instants)});
        }
    }

    /// Reads a gradient per step of `samples` instants: column `column` of `gradient`.
    template <typename Gradient>
    void read(std::span<const double> by_step,
              std::size_t samples,
              std::size_t column,
              Gradient& gradient) const {
        gradient.arrivals.resize(arrivals_.size());
        gradient.bins.resize(bins_.size());
        for (std::size_t i = 0; i < arrivals_.size(); ++i) {
            gradient.arrivals[i][column] += by_step[arrivals_[i] / samples];
        }
        for (std::size_t n = 0; n < bins_.size(); ++n) {
            double sum = 0.0;
            for (std::size_t instant = bins_[n].begin; instant < bins_[n].end; ++instant) {
                sum += by_step[instant / samples];
            }
            gradient.bins[n][column] += sum / static_cast<double>(bins_[n].end - bins_[n].begin);
        }
    }

private:
    std::vector<std::size_t> arrivals_;
    std::vector<Instants> bins_;
};

template <std::size_t kCount>
void add_product(std::span<const std::array<double, kCount>> gradient,
                 std::span<const double> rates,
                 std::array<double, kCount>& sums) {
    for (std::size_t i = 0; i < std::min(gradient.size(), rates.size()); ++i) {
        for (std::size_t k = 0; k < kCount; ++k) {
            sums[k] += gradient[i][k] * rates[i];
        }
    }
}

}  // namespace

MetricDerivatives::MetricDerivatives(const Bands& bands,
                                     std::span<const Arrival> arrivals,
                                     const EnergyHistogram& late,
                                     const std::optional<SpeechConditions>& speech)
    : metrics_(energy_metrics(bands, arrivals, late, {.speech = speech})),
      onset_(bands.count()),
      gradients_(bands.count()),
      of_index_(bands.count()) {
    if (arrivals.empty() && late.energy.empty()) {
        return;
    }
    const EnergyCourse course = energy_course(bands, arrivals, late);
    const std::size_t instants = course.energy.front().size();
    const Places places(arrivals, late, course.sample_rate, instants);
    for (std::size_t band = 0; band < bands.count(); ++band) {
        if (!(course.energy[band][course.onset[band]] > 0.0)) {
            continue;
        }
        onset_[band] = static_cast<double>(course.onset[band]) / course.sample_rate;
        const BandGradient gradient(course.energy[band], course.onset[band], course.sample_rate);
        for (std::size_t kind = 0; kind < kKinds; ++kind) {
            if (const auto& value = metrics_.bands[band].*kBandMetricKinds[kind].value) {
                places.read(gradient_of(gradient, kind, *value), 1, kind, gradients_[band]);
            }
        }
    }
    if (!metrics_.speech_transmission_index) {
        return;
    }
    const std::size_t samples = samples_per_step(course.sample_rate);
    const auto by_step = speech_gradient(*speech_course(bands, course, speech),
                                         instants / samples + 1,
                                         static_cast<double>(samples) / course.sample_rate);
    for (std::size_t octave = 0; octave < kSpeechBands; ++octave) {
        const OctaveBands parts = bands_of_speech_octave(bands, octave);
        // An octave is the mean of its parts.
        std::vector<double> by_part = by_step[octave];
        for (double& number : by_part) {
            number /= static_cast<double>(parts.count);
        }
        for (std::size_t i = 0; i < parts.count; ++i) {
            places.read(by_part, samples, 0, of_index_[parts.first + i]);
        }
    }
}

BandMetrics MetricDerivatives::of_band(std::size_t band, const EnergyRates& rates) const {
    std::array<double, kKinds> sums{};
    add_product<kKinds>(gradients_[band].arrivals, rates.arrivals, sums);
    add_product<kKinds>(gradients_[band].bins, rates.bins, sums);
    BandMetrics derivatives;
    for (std::size_t kind = 0; kind < kKinds; ++kind) {
        const auto metric = kBandMetricKinds[kind].value;
        if (metrics_.bands[band].*metric) {
            derivatives.*metric = sums[kind];
        }
    }
    return derivatives;
}

std::optional<double> MetricDerivatives::of_speech(std::size_t band,
                                                   const EnergyRates& rates) const {
    if (!metrics_.speech_transmission_index) {
        return std::nullopt;
    }
    std::array<double, 1> sum{};
    add_product<1>(of_index_[band].arrivals, rates.arrivals, sum);
    add_product<1>(of_index_[band].bins, rates.bins, sum);
    return sum[0];
}

}  // namespace earshot::audio
