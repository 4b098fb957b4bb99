// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/energy_histogram.h"
#include "earshot/audio/impulse_response.h"
#include "earshot/audio/room_metrics.h"
#include "earshot/audio/speech.h"

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace earshot::audio {

/// By how much the energies of one band change per unit of a parameter.
struct EnergyRates {
    std::span<const double> arrivals{};  ///< one per arrival: of its pressure squared
    std::span<const double> bins{};      ///< one per bin of the late energy
};

/// Derivatives of energy_metrics() by any parameter on which the energies depend: the gradient of
/// each metric by the energy of each arrival and bin, taken once, times the rates of the energies.
/// A reverberation time jumps where an end of its range passes a step of the decay: its derivative
/// is the mean over a change that moves the ends by half a decibel both ways. Onsets stay.
class MetricDerivatives {
public:
    MetricDerivatives(const Bands& bands,
                      std::span<const Arrival> arrivals,
                      const EnergyHistogram& late,
                      const std::optional<SpeechConditions>& speech = {});

    /// The values, as energy_metrics() without replicates.
    const RoomMetrics& metrics() const noexcept { return metrics_; }
    /// Seconds since emission; 0 of a silent band.
    double onset(std::size_t band) const noexcept { return onset_[band]; }

    /// Of the metrics of a band; of one without a value: empty.
    BandMetrics of_band(std::size_t band, const EnergyRates& rates) const;
    /// Of the speech transmission index, by what changes in one band.
    std::optional<double> of_speech(std::size_t band, const EnergyRates& rates) const;

private:
    static constexpr std::size_t kKinds = kBandMetricKinds.size();
    /// Derivatives by the energy of each arrival and bin.
    template <std::size_t kCount>
    struct Gradient {
        std::vector<std::array<double, kCount>> arrivals{}, bins{};
    };

    RoomMetrics metrics_;
    std::vector<double> onset_;                // per band
    std::vector<Gradient<kKinds>> gradients_;  // per band, in the order of kBandMetricKinds
    std::vector<Gradient<1>> of_index_;        // per band; empty of bands that it does not use
};

}  // namespace earshot::audio
