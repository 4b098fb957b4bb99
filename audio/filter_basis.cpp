// SPDX-License-Identifier: MIT
#include "earshot/audio/filter_basis.h"

#include "earshot/audio/internal/assembly_tables.h"
#include "earshot/base/assert.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <utility>

// Filters are compared at the nodes of FilterNodes, as vectors of unit length. The basis is chosen
// by Gram-Schmidt with the largest remainder first (Golub and Van Loan 2013, section 5.4), as
// Representatives does for a set that is known.

namespace earshot::audio {

struct FilterBasis::State {
    const AssemblyTables* tables = nullptr;
    std::vector<std::vector<double>> rows;      // orthonormal
    std::vector<std::vector<double>> triangle;  // row m: the vector of filter m by rows 0 ... m
};

namespace {

double dot(std::span<const double> a, std::span<const double> b) {
    double sum = 0.0;
    for (std::size_t k = 0; k < a.size(); ++k) {
        sum += a[k] * b[k];
    }
    return sum;
}

double length_of(std::span<const double> a) {
    return std::sqrt(dot(a, a));
}

/// Takes the components along the rows out of a vector; their sizes.
std::vector<double> project(const std::vector<std::vector<double>>& rows,
                            std::vector<double>& vector) {
    std::vector<double> coefficients(rows.size(), 0.0);
    // Twice: the first time leaves rounding of the size of what it takes out.
    for (int round = 0; round < 2; ++round) {
        for (std::size_t m = 0; m < rows.size(); ++m) {
            const double along = dot(rows[m], vector);
            coefficients[m] += along;
            for (std::size_t k = 0; k < vector.size(); ++k) {
                vector[k] -= along * rows[m][k];
            }
        }
    }
    return coefficients;
}

/// Leaves out the end of a filter that holds so little of its energy that it does not count beside
/// `error`: half of it.
void trim(double error, std::vector<double>& taps) {
    double rest = 0.25 * error * error * dot(taps, taps);
    while (taps.size() > 1 && taps.back() * taps.back() <= rest) {
        rest -= taps.back() * taps.back();
        taps.pop_back();
    }
}

Spectrum absolute(const Spectrum& pressure) {
    Spectrum result{};
    std::transform(
        pressure.begin(), pressure.end(), result.begin(), [](double p) { return std::abs(p); });
    return result;
}

}  // namespace

// The spectrum at the nodes of the filter of pressures relative to the largest.
std::vector<double> FilterBasis::vector_of(const Spectrum& relative) const {
    const NodeRows nodes = state_->tables->nodes.rows();
    const Spectrum* one = &relative;
    std::vector<double> largest;
    LargeArray<double> logs;
    log_pressures({&one, 1}, nodes.bands, largest, logs);
    const std::size_t size = vector_size(nodes.count);
    LargeArray<double> vectors(size * kLanes);
    alignas(64) std::array<double, kLanes> norms{};
    node_vectors(nodes, logs.data(), vectors.data(), norms.data());
    std::vector<double> vector(size);
    for (std::size_t k = 0; k < size; ++k) {
        vector[k] = norms[0] * vectors[k * kLanes];
    }
    return vector;
}

bool FilterBasis::is_flat(const Spectrum& pressure) const {
    return state_->tables->flat({.delay = 0.0, .pressure = pressure});
}

FilterBasis::FilterBasis(const Assembler& assembler,
                         std::span<const Spectrum> samples,
                         const Settings& settings)
    : state_(std::make_unique<State>()) {
    EARSHOT_ASSERT(settings.max_filters >= 1);
    state_->tables = &assembler.tables();
    choose(samples, settings);
}

FilterBasis::~FilterBasis() = default;
FilterBasis::FilterBasis(FilterBasis&&) noexcept = default;
FilterBasis& FilterBasis::operator=(FilterBasis&&) noexcept = default;

void FilterBasis::choose(std::span<const Spectrum> samples, const Settings& settings) {
    const ArrivalFilter& filter = state_->tables->filter;
    const auto add = [&](const Spectrum& relative, std::vector<double> taps) {
        std::vector<double> vector = vector_of(relative);
        std::vector<double> coefficients = project(state_->rows, vector);
        const double rest = length_of(vector);
        coefficients.push_back(rest);
        for (double& value : vector) {
            value /= rest;
        }
        state_->rows.push_back(std::move(vector));
        state_->triangle.push_back(std::move(coefficients));
        taps_.push_back(std::move(taps));
    };
    Spectrum ones{};
    ones.fill(1.0);
    add(ones, {1.0});

    // Remainders of the samples, of unit length at first.
    std::vector<Spectrum> spectra;
    std::vector<std::vector<double>> remainders;
    for (const Spectrum& sample : samples) {
        if (is_flat(sample)) {
            continue;
        }
        Spectrum relative = sample;
        const double largest = *std::max_element(
            sample.begin(), sample.begin() + static_cast<std::ptrdiff_t>(filter.bands_in_use()));
        for (double& value : relative) {
            value /= largest;
        }
        std::vector<double> vector = vector_of(relative);
        const double norm = length_of(vector);
        for (double& value : vector) {
            value /= norm;
        }
        project(state_->rows, vector);
        spectra.push_back(relative);
        remainders.push_back(std::move(vector));
    }
    while (taps_.size() < settings.max_filters && !spectra.empty()) {
        std::size_t farthest = 0;
        double largest = 0.0;
        for (std::size_t i = 0; i < remainders.size(); ++i) {
            const double rest = length_of(remainders[i]);
            if (rest > largest) {
                largest = rest;
                farthest = i;
            }
        }
        if (!(largest > settings.max_error)) {
            return;
        }
        std::vector<std::complex<double>> spectrum(filter.fft().bins());
        filter.response(spectra[farthest], spectrum);
        std::vector<double> taps(filter.fft().size());
        filter.fft().inverse(spectrum, taps);
        trim(settings.max_error, taps);
        add(spectra[farthest], std::move(taps));
        const std::vector<std::vector<double>> row{state_->rows.back()};
        for (std::vector<double>& remainder : remainders) {
            project(row, remainder);
        }
    }
}

double FilterBasis::add_weights(const Spectrum& pressure, std::span<double> weights) const {
    EARSHOT_ASSERT(weights.size() == filters());
    const Spectrum positive = absolute(pressure);
    const double sign =
        std::any_of(pressure.begin(), pressure.end(), [](double p) { return p < 0.0; }) ? -1.0
                                                                                        : 1.0;
    if (is_flat(positive)) {
        weights[0] += sign * positive[0];
        return 0.0;
    }
    const std::size_t bands = state_->tables->filter.bands_in_use();
    const double largest =
        *std::max_element(positive.begin(), positive.begin() + static_cast<std::ptrdiff_t>(bands));
    Spectrum relative = positive;
    for (double& value : relative) {
        value /= largest;
    }
    std::vector<double> vector = vector_of(relative);
    const double norm = length_of(vector);
    std::vector<double> coefficients = project(state_->rows, vector);
    // From components along the rows to weights of the filters: the triangle, from its end.
    for (std::size_t m = filters(); m-- > 0;) {
        const double weight = coefficients[m] / state_->triangle[m][m];
        for (std::size_t j = 0; j < m; ++j) {
            coefficients[j] -= weight * state_->triangle[m][j];
        }
        weights[m] += sign * largest * weight;
    }
    return length_of(vector) / norm;
}

}  // namespace earshot::audio
