// SPDX-License-Identifier: MIT
#include "earshot/audio/filter_bank.h"

#include "earshot/audio/internal/assembly_tables.h"
#include "earshot/base/assert.h"

#include <algorithm>
#include <cmath>
#include <complex>

namespace earshot::audio {

namespace {

/// Absolute values, and the sign that all have.
struct SignedSpectrum {
    Spectrum absolute{};
    double sign = 1.0;
};

SignedSpectrum split_sign(const Spectrum& pressure) {
    SignedSpectrum result;
    for (std::size_t band = 0; band < pressure.size(); ++band) {
        EARSHOT_ASSERT(std::isfinite(pressure[band]));
        result.sign = pressure[band] < 0.0 ? -1.0 : result.sign;
        result.absolute[band] = std::abs(pressure[band]);
    }
    return result;
}

std::vector<double> taps_of(const ArrivalFilter& filter, Spectrum pressure, double largest) {
    for (double& value : pressure) {
        value /= largest;
    }
    std::vector<std::complex<double>> spectrum(filter.fft().bins());
    filter.response(pressure, spectrum);
    std::vector<double> taps(filter.fft().size());
    filter.fft().inverse(spectrum, taps);
    return taps;
}

}  // namespace

FilterBank::FilterBank(const Assembler& assembler, std::span<const Spectrum> spectra) {
    const AssemblyTables& tables = assembler.tables();
    const std::size_t bands = tables.filter.bands_in_use();

    // Spectra that are neither silent nor flat need a filter.
    std::vector<SignedSpectrum> of_one_sign;
    std::vector<std::size_t> filtered;
    for (std::size_t i = 0; i < spectra.size(); ++i) {
        of_one_sign.push_back(split_sign(spectra[i]));
        if (!tables.flat({.delay = 0.0, .pressure = of_one_sign[i].absolute})) {
            filtered.push_back(i);
        }
    }
    std::vector<const Spectrum*> pressures;
    for (const std::size_t i : filtered) {
        pressures.push_back(&of_one_sign[i].absolute);
    }
    std::vector<double> largest;
    LargeArray<double> logs;
    log_pressures(pressures, bands, largest, logs);
    Representatives representatives;
    std::vector<std::size_t> chosen, outside;  // indices into `filtered`
    if (!filtered.empty()) {
        representatives.find(tables.nodes.rows(), logs, filtered.size(), filtered.size());
        chosen.assign(representatives.pivots().begin(), representatives.pivots().end());
        outside.assign(representatives.outside().begin(), representatives.outside().end());
    }

    // The filters: none, the representatives, and those of what they leave outside.
    taps_.push_back({1.0});
    for (const std::vector<std::size_t>* some : {&chosen, &outside}) {
        for (const std::size_t i : *some) {
            taps_.push_back(taps_of(tables.filter, *pressures[i], largest[i]));
        }
    }
    weights_.assign(spectra.size() * filters(), 0.0);
    for (std::size_t i = 0; i < spectra.size(); ++i) {
        weights_[i * filters()] = of_one_sign[i].sign * of_one_sign[i].absolute[0];
    }
    for (std::size_t k = 0; k < filtered.size(); ++k) {
        double* row = &weights_[filtered[k] * filters()];
        const double factor = of_one_sign[filtered[k]].sign * largest[k];
        row[0] = 0.0;
        const auto own = std::find(outside.begin(), outside.end(), k);
        if (own != outside.end()) {
            row[1 + chosen.size() + static_cast<std::size_t>(own - outside.begin())] = factor;
            continue;
        }
        const std::span<const double> weights = representatives.weights(k);
        std::transform(weights.begin(), weights.end(), row + 1, [&](double weight) {
            return factor * weight;
        });
    }
}

MultiConvolver FilterBank::convolver(std::size_t channels, std::size_t block) const {
    const std::vector<std::span<const double>> filters(taps_.begin(), taps_.end());
    return MultiConvolver(filters, channels, block);
}

}  // namespace earshot::audio
