// SPDX-License-Identifier: MIT
#include "earshot/audio/room_metrics.h"

#include "earshot/audio/internal/band_energy.h"
#include "earshot/audio/internal/decay_curve.h"
#include "earshot/audio/internal/noise_floor.h"
#include "earshot/audio/internal/onset.h"
#include "earshot/base/math.h"

#include <algorithm>
#include <cmath>

namespace earshot::audio {

namespace {

constexpr double kReferenceEnergy = 0.01;  // free field at 10 m, pressure 1 at 1 m
constexpr double kLeastLateEnergy = 1e-6;  // of all: below it a clarity is that of the filter
constexpr double kSpeechLimit = 0.05;      // seconds
constexpr double kMusicLimit = 0.08;       // seconds
constexpr double kLeastSpeechHz = 90.0;
constexpr double kMostSpeechHz = 11000.0;

std::string in_ms(double time) {
    return std::to_string(std::lround(1000.0 * time)) + " ms";
}

std::string band_name(const Bands& bands, std::size_t band) {
    std::string text = std::to_string(bands.nominal_hz()[band]);
    text.erase(text.find_last_not_of('0') + 1);
    if (text.back() == '.') {
        text.pop_back();
    }
    return text + " Hz";
}

// The decay times of a band; what it lacks goes to the notes. True if the response ends early.
bool read_decay(const DecayCurve& curve,
                const NoiseFloor& noise,
                double bandwidth_hz,
                const std::string& band,
                BandMetrics& out,
                std::vector<std::string>& notes) {
    bool ends_early = false;
    const auto time = [&](const DecayRange& range) -> std::optional<double> {
        constexpr int kRoomDb = 10;
        if (noise.energy > 0.0 && noise.depth_db < range.to_db + kRoomDb) {
            notes.push_back(std::string(range.name) + " at " + band + ": noise " +
                            std::to_string(std::lround(noise.depth_db)) +
                            " dB below the decay's start, " +
                            std::to_string(range.to_db + kRoomDb) + " dB needed");
            return std::nullopt;
        }
        const DecayCurve::Reading reading = curve.read(range, bandwidth_hz);
        ends_early = ends_early || reading.ends_early;
        if (!reading.time) {
            notes.push_back(std::string(range.name) + " at " + band + ": " + reading.why_not);
        }
        return reading.time;
    };
    out.early_decay_time = time(kEarlyDecay);
    out.reverberation_time_t20 = time(kT20);
    out.reverberation_time_t30 = time(kT30);
    return ends_early;
}

// Ratio of the energy before and after the limit.
std::optional<double> read_clarity_db(const DecayCurve& curve,
                                      double limit,
                                      const std::string& name_and_band,
                                      std::vector<std::string>& notes) {
    const double late = curve.energy_from(limit);
    if (late < kLeastLateEnergy * curve.energy()) {
        notes.push_back(name_and_band + ": no energy after " + in_ms(limit));
        return std::nullopt;
    }
    return 10.0 * math::log10((curve.energy() - late) / late);
}

// First moment of the energy about the onset, seconds.
double centre_of(std::span<const double> squared, std::size_t onset, double sample_rate) {
    double energy = 0.0;
    double moment = 0.0;
    for (std::size_t n = 0; n < squared.size(); ++n) {
        energy += squared[n];
        moment += squared[n] * (static_cast<double>(n) - static_cast<double>(onset));
    }
    return moment / energy / sample_rate;
}

}  // namespace

RoomMetrics room_metrics(const Bands& bands,
                         const ImpulseResponse& response,
                         const MetricsOptions& options) {
    RoomMetrics metrics;
    metrics.bands.resize(bands.count());
    std::vector<std::string>& notes = metrics.notes;
    const auto onset = find_onset(response.samples);
    if (!onset) {
        notes.emplace_back("the response is silent");
        return metrics;
    }
    const double after_onset =
        static_cast<double>(response.samples.size() - *onset) / response.sample_rate;
    const std::string too_short = ": the response ends within ";
    if (after_onset < kSpeechLimit) {
        notes.push_back("c50, d50" + too_short + in_ms(kSpeechLimit) + " of the direct sound");
    }
    if (after_onset < kMusicLimit) {
        notes.push_back("c80, ts, g" + too_short + in_ms(kMusicLimit) + " of the direct sound");
    }
    const BandEnergy energy(bands, response.samples, response.sample_rate);
    bool ends_early = false;
    bool speech_ends_early = false;
    for (std::size_t band = 0; band < bands.count(); ++band) {
        const std::string at_band = " at " + band_name(bands, band);
        if (!energy.covers(band)) {
            notes.push_back("all" + at_band + ": the band reaches past half the sample rate");
            continue;
        }
        std::vector<double> squared = energy.squared(band);
        if (std::all_of(squared.begin(), squared.end(), [](double e) { return e == 0.0; })) {
            notes.push_back("all" + at_band + ": silent");
            continue;
        }
        const std::size_t begin = energy.lead() + *onset;
        NoiseFloor noise;
        if (options.ends_in_noise) {
            const std::span<const double> signal(squared.data(),
                                                 energy.lead() + response.samples.size());
            noise = find_noise_floor(signal, begin, response.sample_rate);
            squared.resize(noise.energy > 0.0 ? noise.end : squared.size());
        }
        const DecayCurve curve(squared, begin, response.sample_rate, noise.beyond);
        BandMetrics& out = metrics.bands[band];
        const double bandwidth = bands.upper_edge_hz(band) - bands.lower_edge_hz(band);
        const bool ends_here =
            read_decay(curve, noise, bandwidth, band_name(bands, band), out, notes);
        ends_early |= ends_here;
        speech_ends_early |= ends_here && bands.upper_edge_hz(band) > kLeastSpeechHz &&
                             bands.lower_edge_hz(band) < kMostSpeechHz;
        if (after_onset >= kSpeechLimit) {
            out.clarity_c50_db = read_clarity_db(curve, kSpeechLimit, "c50" + at_band, notes);
            out.definition_d50 = 1.0 - curve.energy_from(kSpeechLimit) / curve.energy();
        }
        if (after_onset >= kMusicLimit) {
            out.clarity_c80_db = read_clarity_db(curve, kMusicLimit, "c80" + at_band, notes);
            out.centre_time = centre_of(squared, begin, response.sample_rate);
            const double reference = kReferenceEnergy * energy.of_unit_impulse(band);
            out.strength_db = 10.0 * math::log10(curve.energy() / reference);
        }
    }
    if (ends_early) {
        notes.emplace_back(
            "c50, c80, d50, ts, g: of the response as it is, which ends before its decay does");
    }
    if (speech_ends_early) {
        notes.emplace_back("sti: the response ends before its decay does");
    } else if (const auto speech =
                   speech_transmission(response, options.speech, options.ends_in_noise)) {
        metrics.speech_transmission_index = speech->index;
    } else {
        notes.emplace_back(
            "sti: an octave from 125 Hz to 8 kHz is silent or reaches past half the sample rate");
    }
    return metrics;
}

}  // namespace earshot::audio
