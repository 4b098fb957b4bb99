// SPDX-License-Identifier: MIT
#include "earshot/audio/internal/metric_errors.h"

#include "earshot/audio/internal/decay_curve.h"
#include "earshot/audio/internal/decay_kernel.h"
#include "earshot/audio/internal/metrics_reader.h"
#include "earshot/audio/internal/modulation_kernel.h"
#include "earshot/audio/speech_levels.h"
#include "earshot/base/math.h"
#include "earshot/base/standard_error.h"

#include <algorithm>
#include <cmath>

namespace earshot::audio {

namespace {

constexpr double kTurn = 2.0 * math::kPi;

/// How much each interval of the late energy differs where one replicate is left out of the mean.
class Deviations {
public:
    Deviations(const HistogramReplicates& replicates, double bin, std::size_t bands)
        : replicates_(replicates), bin_(bin), mean_(intervals()) {
        const auto count = static_cast<double>(replicates.energy.size());
        for (const std::vector<Spectrum>& energy : replicates.energy) {
            for (std::size_t k = 0; k < intervals(); ++k) {
                for (std::size_t band = 0; band < bands; ++band) {
                    mean_[k][band] += energy[k][band] / count;
                }
            }
        }
    }

    std::size_t count() const { return replicates_.energy.size(); }
    std::size_t intervals() const { return replicates_.first_bin.size() - 1; }
    double begin(std::size_t k) const {
        return bin_ * static_cast<double>(replicates_.first_bin[k]);
    }
    double middle(std::size_t k) const { return 0.5 * (begin(k) + begin(k + 1)); }
    double length(std::size_t k) const { return begin(k + 1) - begin(k); }
    double of(std::size_t replicate, std::size_t k, std::size_t band) const {
        return (mean_[k][band] - replicates_.energy[replicate][k][band]) /
               (static_cast<double>(count()) - 1.0);
    }

private:
    const HistogramReplicates& replicates_;
    double bin_;
    std::vector<Spectrum> mean_;
};

/// An instant of a decay.
struct Point {
    double time = 0.0;       // seconds after the onset
    double remaining = 0.0;  // energy from there on
    std::size_t interval = 0;
    double share = 0.0;  // of the interval's energy that is still to come
};

/// Least-squares line through the part of a decay between two levels, the decay being straight
/// between its points: seconds for 60 dB.
class LineTime {
public:
    LineTime(std::span<const Point> points, std::span<const double> level_db)
        : points_(points), level_db_(level_db) {}

    double operator()(const DecayRange& range) const {
        const Crossing begin =
            range.from_db == 0 ? Crossing{1, points_[0].time, level_db_[0]} : at(-range.from_db);
        const Crossing end = at(-range.to_db);
        const double middle = 0.5 * (begin.time + end.time);
        double moment = 0.0;
        Crossing from = begin;
        for (std::size_t j = begin.next; j <= end.next; ++j) {
            const Crossing to = j < end.next ? Crossing{j + 1, points_[j].time, level_db_[j]} : end;
            const double step = to.time - from.time;
            moment += step * (0.5 * (from.time + to.time) - middle) * 0.5 *
                          (from.level_db + to.level_db) +
                      step * step * (to.level_db - from.level_db) / 12.0;
            from = to;
        }
        const double length = end.time - begin.time;
        return -60.0 * length * length * length / (12.0 * moment);
    }

private:
    struct Crossing {
        std::size_t next = 1;  // point after it
        double time = 0.0;
        double level_db = 0.0;
    };

    Crossing at(double level_db) const {
        std::size_t next = 1;
        while (next + 1 < points_.size() && level_db_[next] >= level_db) {
            ++next;
        }
        const double before = level_db_[next - 1];
        const double after = level_db_[next];
        const double share =
            before > after ? std::clamp((before - level_db) / (before - after), 0.0, 1.0) : 0.0;
        return {next,
                points_[next - 1].time + share * (points_[next].time - points_[next - 1].time),
                before + share * (after - before)};
    }

    std::span<const Point> points_;
    std::span<const double> level_db_;
};

/// The metrics of one band with any replicate left out.
class BandJackknife {
public:
    BandJackknife(const EnergyCourse& course, std::size_t band, const Deviations& deviations)
        : deviations_(deviations),
          band_(band),
          energy_(course.energy[band]),
          onset_(course.onset[band]),
          sample_rate_(course.sample_rate) {
        remaining_.resize(energy_.size() + 1);
        for (std::size_t n = energy_.size(); n-- > 0;) {
            remaining_[n] = remaining_[n + 1] + energy_[n];
            moment_ +=
                energy_[n] * (static_cast<double>(n) - static_cast<double>(onset_)) / sample_rate_;
        }
        place_points();
        after_speech_limit_ = point_at(onset_ + sample_of(kSpeechLimit));
        after_music_limit_ = point_at(onset_ + sample_of(kMusicLimit));
    }

    BandMetrics without(std::size_t replicate) {
        const std::size_t intervals = deviations_.intervals();
        tail_.assign(intervals + 1, 0.0);
        double moment = moment_;
        const double onset_time = static_cast<double>(onset_) / sample_rate_;
        for (std::size_t k = intervals; k-- > 0;) {
            const double deviation = deviations_.of(replicate, k, band_);
            tail_[k] = tail_[k + 1] + deviation;
            moment += deviation * (deviations_.middle(k) - onset_time);
        }
        const double all = positive(remaining_.front() + tail_.front());
        level_db_.clear();
        for (const Point& point : points_) {
            level_db_.push_back(remaining_at(point) / all);
        }
        natural_logs(level_db_, level_db_);
        for (double& level : level_db_) {
            level *= kDbPerLogEnergy;
        }
        const LineTime line_time(points_, level_db_);
        const double after_50_ms = remaining_at(after_speech_limit_);
        const double after_80_ms = remaining_at(after_music_limit_);
        return {.early_decay_time = line_time(kEarlyDecay),
                .reverberation_time_t20 = line_time(kT20),
                .reverberation_time_t30 = line_time(kT30),
                .clarity_c50_db = 10.0 * math::log10(positive(all - after_50_ms) / after_50_ms),
                .clarity_c80_db = 10.0 * math::log10(positive(all - after_80_ms) / after_80_ms),
                .definition_d50 = 1.0 - after_50_ms / all,
                .centre_time = moment / all,
                .strength_db = 10.0 * math::log10(all / kReferenceEnergy)};
    }

private:
    // Few enough to be cheap, and so close that the line of a metric moves by under a per mille.
    static constexpr std::size_t kEarlyPoints = 64;
    static constexpr std::size_t kLatePoints = 96;

    std::size_t sample_of(double time) const {
        return static_cast<std::size_t>(std::llround(time * sample_rate_));
    }

    // Where few rays arrive, those left out may have been all.
    double positive(double energy) const { return std::max(energy, 1e-9 * remaining_.front()); }

    double remaining_at(const Point& point) const {
        const double change = point.interval < deviations_.intervals()
                                  ? (1.0 - point.share) * tail_[point.interval + 1] +
                                        point.share * tail_[point.interval]
                                  : 0.0;
        return positive(point.remaining + change);
    }

    std::size_t first_below(double level_db) const {
        const double limit = remaining_.front() * math::pow10(level_db / 10.0);
        const auto found = std::find_if(remaining_.begin() + static_cast<long>(onset_),
                                        remaining_.end() - 1,
                                        [&](double remaining) { return remaining < limit; });
        return static_cast<std::size_t>(found - remaining_.begin());
    }

    // Evenly down to the end of EDT, then to that of T30, each with room for what leaving out
    // moves.
    void place_points() {
        const std::size_t early_end = std::max(first_below(-11.0), onset_ + 2);
        const std::size_t late_end = std::max(first_below(-37.0), early_end + 1);
        points_.push_back(point_at(onset_));
        const auto add_evenly = [&](std::size_t begin, std::size_t end, std::size_t count) {
            std::size_t last = begin;
            for (std::size_t i = 1; i <= count; ++i) {
                const std::size_t sample = begin + (end - begin) * i / count;
                if (sample > last) {
                    points_.push_back(point_at(sample));
                    last = sample;
                }
            }
        };
        points_.push_back(point_at(onset_ + 1));
        add_evenly(onset_ + 1, early_end, kEarlyPoints);
        add_evenly(early_end, late_end, kLatePoints);
    }

    Point point_at(std::size_t sample) const {
        const double time = static_cast<double>(sample) / sample_rate_;
        Point point = {.time = static_cast<double>(sample - onset_) / sample_rate_,
                       .remaining = sample < remaining_.size() ? remaining_[sample] : 0.0};
        while (point.interval < deviations_.intervals() &&
               deviations_.begin(point.interval + 1) <= time) {
            ++point.interval;
        }
        if (point.interval < deviations_.intervals()) {
            const double passed = time - deviations_.begin(point.interval);
            point.share = std::clamp(1.0 - passed / deviations_.length(point.interval), 0.0, 1.0);
        }
        return point;
    }

    const Deviations& deviations_;
    std::size_t band_;
    std::span<const double> energy_;
    std::size_t onset_;
    double sample_rate_;
    std::vector<double> remaining_;  // from each instant on
    double moment_ = 0.0;            // about the onset
    std::vector<Point> points_;
    Point after_speech_limit_, after_music_limit_;
    std::vector<double> tail_, level_db_;  // of the replicate at hand
};

/// The speech transmission index with any replicate left out.
class SpeechJackknife {
public:
    SpeechJackknife(const Bands& bands, const SpeechCourse& speech, const Deviations& deviations)
        : bands_(bands),
          speech_(speech),
          deviations_(deviations),
          of_octave_(deviations.intervals()) {
        for (std::size_t k = 0; k < deviations.intervals(); ++k) {
            ModulationSums unit{.energy = 1.0};
            for (std::size_t f = 0; f < kModulationHz.size(); ++f) {
                const double turn = kTurn * kModulationHz[f];
                const double half = 0.5 * turn * deviations.length(k);
                const double spread = half > 0.0 ? math::sin(half) / half : 1.0;
                unit.in_phase[f] = spread * math::cos(turn * deviations.middle(k));
                unit.in_quadrature[f] = spread * math::sin(turn * deviations.middle(k));
            }
            const Row row = row_of(unit);
            units_.insert(units_.end(), row.begin(), row.end());
        }
    }

    double without(std::size_t replicate) {
        std::array<ModulationSums, kSpeechBands> octaves = speech_.octaves;
        SpeechSpectrum energy{};
        for (std::size_t octave = 0; octave < kSpeechBands; ++octave) {
            const OctaveBands parts = bands_of_speech_octave(bands_, octave);
            for (std::size_t k = 0; k < deviations_.intervals(); ++k) {
                double& deviation = of_octave_[k];
                deviation = 0.0;
                for (std::size_t i = 0; i < parts.count; ++i) {
                    deviation += deviations_.of(replicate, k, parts.first + i) /
                                 static_cast<double>(parts.count);
                }
            }
            Row sums = row_of(octaves[octave]);
            add_rows(units_, of_octave_, sums);
            octaves[octave] = sums_of(sums);
            octaves[octave].energy =
                std::max(octaves[octave].energy, 1e-9 * speech_.octaves[octave].energy);
            energy[octave] = octaves[octave].energy;
        }
        return speech_transmission(octaves,
                                   speech_.conditions ? std::optional(levels_at_listener(
                                                            *speech_.conditions, energy))
                                                      : std::nullopt)
            .index;
    }

private:
    /// Modulation sums as numbers in a row: the energy, those in phase, those in quadrature.
    using Row = std::array<double, kSumRow>;
    static constexpr std::size_t kCount = kModulationHz.size();
    static_assert(1 + 2 * kCount <= kSumRow);

    static Row row_of(const ModulationSums& sums) {
        Row row{};
        row[0] = sums.energy;
        std::copy(sums.in_phase.begin(), sums.in_phase.end(), row.begin() + 1);
        std::copy(sums.in_quadrature.begin(), sums.in_quadrature.end(), row.begin() + 1 + kCount);
        return row;
    }

    static ModulationSums sums_of(const Row& row) {
        ModulationSums sums{.energy = row[0]};
        std::copy_n(row.begin() + 1, kCount, sums.in_phase.begin());
        std::copy_n(row.begin() + 1 + kCount, kCount, sums.in_quadrature.begin());
        return sums;
    }

    const Bands& bands_;
    const SpeechCourse& speech_;
    const Deviations& deviations_;
    std::vector<double> units_;      // a row per interval, of unit energy in it
    std::vector<double> of_octave_;  // deviation per interval
};

/// Standard error of the mean of replicates from the values without each of them.
double jackknife_error(std::span<const double> without) {
    return static_cast<double>(without.size() - 1) * standard_error_of_mean(without);
}

/// The error of a metric that has a value.
std::optional<double> error_of(const std::optional<double>& value,
                               const std::vector<BandMetrics>& without,
                               std::optional<double> BandMetrics::*metric) {
    std::vector<double> numbers;
    for (const BandMetrics& metrics : without) {
        numbers.push_back((metrics.*metric).value_or(0.0));
    }
    return value ? std::optional(jackknife_error(numbers)) : std::nullopt;
}

}  // namespace

MetricValues metric_errors(const Bands& bands,
                           const MetricValues& values,
                           const EnergyCourse& course,
                           const std::optional<SpeechCourse>& speech,
                           const HistogramReplicates& replicates,
                           double bin) {
    MetricValues errors;
    errors.bands.resize(bands.count());
    const std::size_t count = replicates.energy.size();
    if (count < 2) {
        return errors;
    }
    const Deviations deviations(replicates, bin, bands.count());
    // Single numbers are means over bands, replicate by replicate: bands share rays.
    std::vector<std::vector<BandMetrics>> without(count, std::vector<BandMetrics>(bands.count()));
    for (std::size_t band = 0; band < bands.count(); ++band) {
        if (!values.bands[band].strength_db && !values.bands[band].definition_d50) {
            continue;
        }
        BandJackknife jackknife(course, band, deviations);
        std::vector<BandMetrics> of_band;
        for (std::size_t replicate = 0; replicate < count; ++replicate) {
            of_band.push_back(without[replicate][band] = jackknife.without(replicate));
        }
        for (const BandMetricKind& kind : kBandMetricKinds) {
            errors.bands[band].*kind.value =
                error_of(values.bands[band].*kind.value, of_band, kind.value);
        }
    }
    std::vector<BandMetrics> mid;
    for (const std::vector<BandMetrics>& of_replicate : without) {
        mid.push_back(mid_frequency_means(bands, of_replicate));
    }
    for (const BandMetricKind& kind : kBandMetricKinds) {
        errors.mid.*kind.value = error_of(values.mid.*kind.value, mid, kind.value);
    }
    if (values.speech_transmission_index && speech) {
        SpeechJackknife jackknife(bands, *speech, deviations);
        std::vector<double> numbers;
        for (std::size_t replicate = 0; replicate < count; ++replicate) {
            numbers.push_back(jackknife.without(replicate));
        }
        errors.speech_transmission_index = jackknife_error(numbers);
    }
    return errors;
}

}  // namespace earshot::audio
