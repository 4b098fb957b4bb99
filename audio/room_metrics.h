// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/bands.h"
#include "earshot/audio/metric_note.h"

#include <array>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace earshot::audio {

/// ISO 3382-1 metrics of one band. A value that is not supported is empty: a decay time where the
/// decay ends too early or is shorter than the band's filter rings, the others where the response
/// ends before their limit (docs/algorithms/audio.md).
struct BandMetrics {
    std::optional<double> early_decay_time;        ///< EDT, seconds
    std::optional<double> reverberation_time_t20;  ///< T20, seconds
    std::optional<double> reverberation_time_t30;  ///< T30, seconds
    std::optional<double> clarity_c50_db;          ///< C50
    std::optional<double> clarity_c80_db;          ///< C80
    std::optional<double> definition_d50;          ///< D50, 0..1
    std::optional<double> centre_time;             ///< Ts, seconds
    std::optional<double> strength_db;             ///< G, re free field at 10 m
};

/// What is to be known of a metric whatever its value.
struct BandMetricKind {
    std::string_view key;  ///< in metrics.json
    std::optional<double> BandMetrics::*value = nullptr;
    /// Just-noticeable difference (ISO 3382-1:2009, table A.1), a share of the value or in its
    /// unit.
    double just_noticeable_difference = 0.0;
    bool relative = false;
    std::string_view unit{};
};

inline constexpr std::array<BandMetricKind, 8> kBandMetricKinds = {
    {{"edt", &BandMetrics::early_decay_time, 0.05, true, "s"},
     {"t20", &BandMetrics::reverberation_time_t20, 0.05, true, "s"},
     {"t30", &BandMetrics::reverberation_time_t30, 0.05, true, "s"},
     {"c50", &BandMetrics::clarity_c50_db, 1.0, false, "dB"},
     {"c80", &BandMetrics::clarity_c80_db, 1.0, false, "dB"},
     {"d50", &BandMetrics::definition_d50, 0.05, false, ""},
     {"ts", &BandMetrics::centre_time, 0.01, false, "s"},
     {"g", &BandMetrics::strength_db, 1.0, false, "dB"}}};

/// Just-noticeable difference of the speech transmission index (Bradley, Reich and Norcross 1999).
inline constexpr double kSpeechJustNoticeableDifference = 0.03;

/// A number for each metric: its value or its standard error.
struct MetricValues {
    std::vector<BandMetrics> bands{};  ///< one per band, in order
    BandMetrics mid{};                 ///< single numbers, see mid_frequency_means()
    std::optional<double> speech_transmission_index{};  ///< STI, see speech.h
};

/// The steady noise in which a measured response ends; empty where none was found.
struct BandNoise {
    std::optional<double> level_db;          ///< of its mean square, decibels re a sample of 1
    std::optional<double> peak_to_noise_db;  ///< the decay's loudest 10 ms above it
};

struct RoomMetrics : MetricValues {
    /// Of the values above, where they are estimated by rays. A value is empty if twice its
    /// standard error exceeds its just-noticeable difference; the error is not.
    MetricValues standard_error{};
    std::vector<BandNoise> noise{};   ///< one per band of a measured response, else none
    std::vector<MetricNote> notes{};  ///< why a value is empty, and the like
};

/// Single numbers: each metric's mean over the octaves 500 Hz and 1 kHz, or the thirds from 400 Hz
/// to 1250 Hz (ISO 3382-1:2009, table A.1); empty if it lacks one of them. `values`: one per band.
BandMetrics mid_frequency_means(const Bands& bands, std::span<const BandMetrics> values);

/// The same mean of any quantity that every band has. Precondition: values.size() >= bands.count().
double mid_frequency_mean(const Bands& bands, std::span<const double> values);

/// Frequency above which the room's modes overlap and sound follows rays (Schroeder and Kuttruff
/// 1962): 2000 sqrt(time / volume), hertz, of the mean T30 (or T20, else EDT) of the octaves or
/// thirds from 400 Hz to 1250 Hz; nothing if there is none. Precondition: volume > 0, cubic metres.
std::optional<double> schroeder_frequency_hz(const Bands& bands,
                                             const RoomMetrics& metrics,
                                             double volume);

}  // namespace earshot::audio
