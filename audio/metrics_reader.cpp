// SPDX-License-Identifier: MIT
#include "earshot/audio/internal/metrics_reader.h"

#include "earshot/audio/internal/decay_kernel.h"
#include "earshot/base/math.h"

#include <cmath>
#include <initializer_list>
#include <utility>

namespace earshot::audio {

namespace {

constexpr double kMinLateEnergy = 1e-6;  // of all: below it a clarity is that of the filter
// Of a filter's bandwidth and a limit in time: with less, the filter carries so much energy past
// the limit that clarity and centre time change by more than is just noticeable.
constexpr double kMinBandwidthTime = 2.0;
constexpr double kMinSpeechHz = 90.0;
constexpr double kMaxSpeechHz = 11000.0;

std::string in_ms(double time) {
    return std::to_string(std::lround(1000.0 * time)) + " ms";
}

// First moment of the energy about the onset, seconds. What was cut off decays exponentially.
double centre_of(const BandDecay& decay) {
    double energy = decay.noise.tail_energy;
    double moment = 0.0;
    if (energy > 0.0) {
        const double time_constant = energy / decay.noise.energy;  // samples
        moment = energy * (static_cast<double>(decay.squared.size() - decay.onset) + time_constant);
    }
    const EnergyMoments sums = energy_moments(decay.squared, static_cast<double>(decay.onset));
    return (moment + sums.moment) / (energy + sums.energy) / decay.sample_rate;
}

}  // namespace

void MetricsReader::add(const char* metric, std::optional<std::size_t> band, std::string text) {
    notes_.push_back({.metric = metric,
                      .band_hz = band ? std::optional(bands_.nominal_hz()[*band]) : std::nullopt,
                      .text = std::move(text)});
}

void MetricsReader::note_extent(double after_onset) {
    const auto note = [&](std::initializer_list<const char*> metrics, double limit) {
        for (const char* metric : metrics) {
            if (after_onset < limit) {
                add(metric,
                    {},
                    "the response ends within " + in_ms(limit) + " of the direct sound");
            }
        }
    };
    note({"c50", "d50"}, kSpeechLimit);
    note({"c80", "ts", "g"}, kMusicLimit);
}

bool MetricsReader::is_of_speech(std::size_t band) const noexcept {
    return bands_.upper_edge_hz(band) > kMinSpeechHz && bands_.lower_edge_hz(band) < kMaxSpeechHz;
}

void MetricsReader::read_times(const DecayCurve& curve,
                               const BandDecay& decay,
                               std::size_t band,
                               BandMetrics& out) {
    bool ends_early = false;
    const auto time = [&](const DecayRange& range) -> std::optional<double> {
        constexpr int kRoomDb = 10;
        if (decay.noise.energy > 0.0 && decay.noise.peak_to_noise_db < range.to_db + kRoomDb) {
            add(range.name,
                band,
                "noise " + std::to_string(std::lround(decay.noise.peak_to_noise_db)) +
                    " dB below the decay's start, " + std::to_string(range.to_db + kRoomDb) +
                    " dB needed");
            return std::nullopt;
        }
        DecayCurve::Reading reading = curve.read(range, decay.bandwidth_hz, decay.full_decay);
        ends_early = ends_early || reading.ends_early;
        if (!reading.time) {
            add(range.name, band, std::move(reading.why_not));
        }
        return reading.time;
    };
    out.early_decay_time = time(kEarlyDecay);
    out.reverberation_time_t20 = time(kT20);
    out.reverberation_time_t30 = time(kT30);
    // Where uncertain values are withheld, what is missing is judged by its energy.
    ends_early = ends_early && !decay.withhold_uncertain;
    any_ends_early_ |= ends_early;
    speech_ends_early_ |= ends_early && is_of_speech(band);
}

// Whether the filter of a recording's band carries too much energy past the limit for the metrics.
bool MetricsReader::rings_past(double limit,
                               const BandDecay& decay,
                               std::size_t band,
                               std::initializer_list<const char*> metrics) {
    if (!decay.withhold_uncertain || decay.bandwidth_hz * limit >= kMinBandwidthTime) {
        return false;
    }
    for (const char* metric : metrics) {
        add(metric, band, "the band's filter rings for longer than " + in_ms(limit));
    }
    return true;
}

// Ratio of the energy before and after the limit.
std::optional<double> MetricsReader::clarity_db(const DecayCurve& curve,
                                                double limit,
                                                const char* metric,
                                                std::size_t band) {
    const double late = curve.energy_from(limit);
    if (late < kMinLateEnergy * curve.energy()) {
        add(metric, band, "no energy after " + in_ms(limit));
        return std::nullopt;
    }
    return 10.0 * math::log10((curve.energy() - late) / late);
}

BandMetrics MetricsReader::read(std::size_t band, const BandDecay& decay) {
    if (is_lost_in_noise(decay, band)) {
        return {};
    }
    DecayCurve curve(decay.squared,
                     decay.onset,
                     decay.sample_rate,
                     decay.noise.tail_energy,
                     std::move(curve_memory_));
    BandMetrics out;
    read_times(curve, decay, band, out);
    if (decay.after_onset >= kSpeechLimit &&
        !rings_past(kSpeechLimit, decay, band, {"c50", "d50"})) {
        out.clarity_c50_db = clarity_db(curve, kSpeechLimit, "c50", band);
        out.definition_d50 = 1.0 - curve.energy_from(kSpeechLimit) / curve.energy();
    }
    if (decay.after_onset >= kMusicLimit) {
        if (!rings_past(kMusicLimit, decay, band, {"c80", "ts"})) {
            out.clarity_c80_db = clarity_db(curve, kMusicLimit, "c80", band);
            out.centre_time = centre_of(decay);
        }
        out.strength_db = 10.0 * math::log10(curve.energy() / (kReferenceEnergy * decay.reference));
    }
    if (decay.withhold_uncertain && decay.noise.energy > 0.0) {
        limit_to_noise(curve, decay, band, out);
    } else if (decay.withhold_uncertain) {
        limit_to_extent(curve, decay, band, out);
    }
    curve_memory_ = std::move(curve).take_memory();
    return out;
}

bool MetricsReader::note_early_ends() {
    if (any_ends_early_) {
        for (const char* metric : {"c50", "c80", "d50", "ts", "g"}) {
            add(metric, {}, "of the response as it is, which ends before its decay does");
        }
    }
    if (speech_ends_early_) {
        add("sti", {}, "the response ends before its decay does");
    }
    return speech_ends_early_ || speech_is_unsure_;
}

}  // namespace earshot::audio
