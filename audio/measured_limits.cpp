// SPDX-License-Identifier: MIT
#include "earshot/audio/internal/decay_kernel.h"
#include "earshot/audio/internal/metrics_reader.h"
#include "earshot/base/math.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace earshot::audio {

namespace {

// Half the just-noticeable differences (ISO 3382-1:2009, table A.1): what an early end may change.
constexpr double kMaxLevelChange = 0.122;  // of an energy: 0.5 dB
constexpr double kMaxDefinitionChange = 0.025;
constexpr double kMaxCentreChange = 0.005;  // seconds

// Of the energy of an octave, missing where it matters to modulation: half of 0.03 of the index.
constexpr double kMaxSpeechShare = 0.05;

constexpr double kStandardErrors = 2.5;  // that have to fit into a just-noticeable difference
// A line through a range of the curve follows its lower end.
constexpr double kLineGain = 1.4;

/// What the noise of a measurement leaves uncertain. The band's noise has an independent value
/// every 1 / bandwidth seconds; each adds its product with the decay and what its own energy
/// deviates from the mean.
class NoiseError {
public:
    NoiseError(const DecayCurve& curve, const BandDecay& decay)
        : curve_(curve),
          cell_energy_(decay.noise.energy * decay.sample_rate / decay.bandwidth_hz),
          bandwidth_hz_(decay.bandwidth_hz),
          end_(static_cast<double>(decay.squared.size() - decay.onset) / decay.sample_rate) {}

    /// Standard error of the level of the energy that arrives from a time on, decibels.
    double level_db(double energy, double time) const {
        const double cells = std::max(0.0, end_ - time) * bandwidth_hz_;
        const double share = cell_energy_ / energy;
        return kDbPerLogEnergy * std::sqrt(2.0 * share + cells * share * share);
    }

    /// Of a clarity, decibels.
    double clarity_db(double limit) const {
        const double late = curve_.energy_from(limit);
        const double early = curve_.energy() - late;
        // Early and late energy deviate independently.
        return std::hypot(level_db(late, limit), level_db(early, end_ - limit));
    }

    /// Of a reverberation time read from a range, as a share.
    double time_share(const DecayRange& range, double time) const {
        const double level =
            level_db(curve_.energy() * math::pow10(-range.to_db / 10.0), time * range.to_db / 60.0);
        return kLineGain * level / (range.to_db - range.from_db);
    }

    /// Of the centre time of an exponential decay, seconds.
    double centre_time(double centre) const {
        return 2.0 * centre * std::sqrt(cell_energy_ / curve_.energy());
    }

private:
    const DecayCurve& curve_;
    double cell_energy_;
    double bandwidth_hz_;
    double end_;  // of the curve after the onset, seconds
};

std::string noise_text(const BandDecay& decay) {
    return "noise " + std::to_string(std::lround(decay.noise.peak_to_noise_db)) +
           " dB below the decay's start";
}

}  // namespace

bool MetricsReader::is_lost_in_noise(const BandDecay& decay, std::size_t band) {
    if (!decay.withhold_uncertain || !(decay.noise.energy > 0.0) ||
        decay.noise.peak_to_noise_db >= kMinPeakToNoiseDb) {
        return false;
    }
    const std::string text =
        noise_text(decay) + ", " + std::to_string(std::lround(kMinPeakToNoiseDb)) + " dB needed";
    add("all", band, text);
    refuse_speech(band, text);
    return true;
}

void MetricsReader::refuse(const char* metric,
                           std::size_t band,
                           const std::string& text,
                           std::optional<double>& value) {
    if (value) {
        value.reset();
        add(metric, band, text);
    }
}

void MetricsReader::limit_to_noise(const DecayCurve& curve,
                                   const BandDecay& decay,
                                   std::size_t band,
                                   BandMetrics& out) {
    const NoiseError error(curve, decay);
    const std::string text = noise_text(decay) + " may change it by more than is just noticeable";
    const auto limit = [&](std::size_t kind, double standard_error) {
        const BandMetricKind& metric = kBandMetricKinds[kind];
        if (!(kStandardErrors * standard_error <= metric.just_noticeable_difference)) {
            refuse(metric.key.data(), band, text, out.*metric.value);
        }
    };
    for (std::size_t kind = 0; kind < kBandMetricKinds.size(); ++kind) {
        const auto value = kBandMetricKinds[kind].value;
        if (!(out.*value)) {
            continue;
        }
        if (value == &BandMetrics::early_decay_time) {
            limit(kind, error.time_share(kEarlyDecay, *(out.*value)));
        } else if (value == &BandMetrics::reverberation_time_t20) {
            limit(kind, error.time_share(kT20, *(out.*value)));
        } else if (value == &BandMetrics::reverberation_time_t30) {
            limit(kind, error.time_share(kT30, *(out.*value)));
        } else if (value == &BandMetrics::clarity_c50_db) {
            limit(kind, error.clarity_db(kSpeechLimit));
        } else if (value == &BandMetrics::clarity_c80_db) {
            limit(kind, error.clarity_db(kMusicLimit));
        } else if (value == &BandMetrics::definition_d50) {
            // D = 1 / (1 + 10^(-C / 10)).
            limit(kind,
                  *(out.*value) * (1.0 - *(out.*value)) * error.clarity_db(kSpeechLimit) /
                      kDbPerLogEnergy);
        } else if (value == &BandMetrics::centre_time) {
            limit(kind, error.centre_time(*(out.*value)));
        } else {
            limit(kind, error.level_db(curve.energy(), 0.0));
        }
    }
}

void MetricsReader::limit_to_extent(const DecayCurve& curve,
                                    const BandDecay& decay,
                                    std::size_t band,
                                    BandMetrics& out) {
    // What the response lacks because it ends before its decay does.
    const double missing = decay.noise.missing_energy;
    const double share = missing / curve.energy();
    const std::string text = "the response ends before its decay does, about " +
                             std::to_string(std::lround(100.0 - 100.0 / (1.0 + share))) +
                             " % of the energy is missing";
    if (missing > kMaxLevelChange * curve.energy_from(kSpeechLimit)) {
        refuse("c50", band, text, out.clarity_c50_db);
    }
    if (missing > kMaxLevelChange * curve.energy_from(kMusicLimit)) {
        refuse("c80", band, text, out.clarity_c80_db);
    }
    if (out.definition_d50 && *out.definition_d50 * share > kMaxDefinitionChange) {
        refuse("d50", band, text, out.definition_d50);
    }
    if (share * decay.after_onset > kMaxCentreChange) {
        refuse("ts", band, text, out.centre_time);
    }
    if (share > kMaxLevelChange) {
        refuse("g", band, text, out.strength_db);
    }
    if (share > kMaxSpeechShare) {
        refuse_speech(band, text);
    }
}

void MetricsReader::refuse_speech(std::size_t band, const std::string& text) {
    if (is_of_speech(band)) {
        speech_is_unsure_ = true;
        add("sti", band, text);
    }
}

}  // namespace earshot::audio
