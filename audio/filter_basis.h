// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/bands.h"
#include "earshot/audio/impulse_response.h"
#include "earshot/base/floating_point.h"

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

namespace earshot::audio {

/// A few minimum-phase filters, chosen once, whose weighted sums stand for those of spectra that
/// come later: a signal is filtered by each once, however many arrivals it makes and however these
/// change. FilterBank is for spectra that are all known.
class FilterBasis {
public:
    struct Settings {
        /// What a filter of the samples may miss of its energy, as a ratio of pressures.
        double max_error = 1e-3;
        std::size_t max_filters = 16;  ///< >= 1; fewer where they suffice
    };

    /// `samples`: spectra like those that come, each finite, >= 0 and with a pressure in a band
    /// below half the assembler's sample rate. The assembler must outlive the object.
    FilterBasis(const Assembler& assembler,
                std::span<const Spectrum> samples,
                const Settings& settings);
    ~FilterBasis();
    FilterBasis(FilterBasis&&) noexcept;
    FilterBasis& operator=(FilterBasis&&) noexcept;

    /// Filter 0 leaves the signal as it is.
    std::size_t filters() const noexcept { return taps_.size(); }
    std::span<const double> taps(std::size_t filter) const noexcept { return taps_[filter]; }

    /// Adds the weights, one per filter, of the filter of a spectrum whose pressures are of one
    /// sign in all bands. Returns what they miss of its energy, as a ratio of pressures: 0 for
    /// spectra whose bands are alike, which need filter 0 alone.
    double add_weights(const Spectrum& pressure, std::span<double> weights) const;

private:
    struct State;
    std::vector<double> vector_of(const Spectrum& relative) const;
    bool is_flat(const Spectrum& pressure) const;
    void choose(std::span<const Spectrum> samples, const Settings& settings);

    std::unique_ptr<State> state_;
    std::vector<std::vector<double>> taps_;
};

}  // namespace earshot::audio
