// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/internal/decay_curve.h"
#include "earshot/audio/internal/noise_floor.h"
#include "earshot/audio/room_metrics.h"

#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace earshot::audio {

inline constexpr double kSpeechLimit = 0.05;      ///< of C50 and D50, seconds
inline constexpr double kMusicLimit = 0.08;       ///< of C80, seconds
inline constexpr double kReferenceEnergy = 0.01;  ///< free field at 10 m, pressure 1 at 1 m

/// Energy over time in one band of a response.
struct BandDecay {
    std::span<const double> squared;  ///< per sample; one is positive
    std::size_t onset = 0;            ///< < squared.size()
    double sample_rate = 0.0;         ///< hertz
    double after_onset = 0.0;         ///< seconds of sound, without what a filter adds to its end
    double reference = 1.0;           ///< energy of a free field at 1 m
    double bandwidth_hz = 0.0;        ///< of the filter
    NoiseFloor noise{};
    bool full_decay = false;          ///< the decay is known not to be cut off
    bool withhold_uncertain = false;  ///< see MetricsOptions
};

/// Reads the metrics of band after band; what they lack is explained in `notes`.
class MetricsReader {
public:
    MetricsReader(const Bands& bands, std::vector<MetricNote>& notes)
        : bands_(bands), notes_(notes) {}

    /// Says that a band has none.
    void note_band(std::size_t band, std::string text) { add("all", band, std::move(text)); }
    /// Says which metrics so short a response cannot have.
    void note_extent(double after_onset);
    BandMetrics read(std::size_t band, const BandDecay& decay);
    /// To be called last: says which metrics are those of a decay that was cut off. True if the
    /// octaves of speech are.
    bool note_early_ends();

private:
    void read_times(const DecayCurve& curve,
                    const BandDecay& decay,
                    std::size_t band,
                    BandMetrics& out);
    bool rings_past(double limit,
                    const BandDecay& decay,
                    std::size_t band,
                    std::initializer_list<const char*> metrics);
    std::optional<double> clarity_db(const DecayCurve& curve,
                                     double limit,
                                     const char* metric,
                                     std::size_t band);
    /// Whether the noise of a measurement leaves nothing to read; says so.
    bool is_lost_in_noise(const BandDecay& decay, std::size_t band);
    /// Takes out what the noise of a measurement may change by a just-noticeable difference.
    void limit_to_noise(const DecayCurve& curve,
                        const BandDecay& decay,
                        std::size_t band,
                        BandMetrics& out);
    /// The same of what a measurement lacks at its end.
    void limit_to_extent(const DecayCurve& curve,
                         const BandDecay& decay,
                         std::size_t band,
                         BandMetrics& out);
    void refuse(const char* metric,
                std::size_t band,
                const std::string& text,
                std::optional<double>& value);
    void refuse_speech(std::size_t band, const std::string& text);
    bool is_of_speech(std::size_t band) const noexcept;
    void add(const char* metric, std::optional<std::size_t> band, std::string text);

    const Bands& bands_;
    std::vector<MetricNote>& notes_;
    bool any_ends_early_ = false;
    bool speech_ends_early_ = false;
    bool speech_is_unsure_ = false;  // for noise, or for what is missing at the end
    std::vector<double> curve_memory_;
};

}  // namespace earshot::audio
