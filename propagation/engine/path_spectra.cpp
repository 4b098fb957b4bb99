// SPDX-License-Identifier: MIT
#include "earshot/propagation/engine/internal/path_spectra.h"

#include "earshot/propagation/air.h"
#include "earshot/propagation/material.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>

namespace earshot::propagation {

namespace {

// Materials of which all triples are made; of more, triples of one alone.
constexpr std::size_t kMaxForTriples = 10;
constexpr std::array<double, 7> kDistances = {0.0, 8.0, 20.0, 40.0, 80.0, 150.0, 300.0};  // metres

using audio::Spectrum;

Spectrum product(const Spectrum& a, const Spectrum& b) {
    Spectrum result{};
    std::transform(a.begin(), a.end(), b.begin(), result.begin(), std::multiplies<>());
    return result;
}

bool is_heard(const Spectrum& spectrum) {
    return std::any_of(spectrum.begin(), spectrum.end(), [](double p) { return p > 0.0; });
}

/// Products of up to three.
std::vector<Spectrum> products_of(const std::vector<Spectrum>& factors, const Spectrum& ones) {
    std::vector<Spectrum> products = {ones};
    for (std::size_t i = 0; i < factors.size(); ++i) {
        products.push_back(factors[i]);
        for (std::size_t j = i; j < factors.size(); ++j) {
            const Spectrum pair = product(factors[i], factors[j]);
            products.push_back(pair);
            for (std::size_t k = j; k < factors.size(); ++k) {
                if (factors.size() <= kMaxForTriples || (i == j && j == k)) {
                    products.push_back(product(pair, factors[k]));
                }
            }
        }
    }
    return products;
}

std::vector<Spectrum> radiated(const Scene& scene, const audio::Bands& bands) {
    std::vector<Spectrum> spectra;
    for (const Emitter& source : scene.sources) {
        if (source.directivity.is_omnidirectional()) {
            continue;
        }
        for (int x = -1; x <= 1; ++x) {
            for (int y = -1; y <= 1; ++y) {
                for (int z = -1; z <= 1; ++z) {
                    if (x == 0 && y == 0 && z == 0) {
                        continue;
                    }
                    Spectrum spectrum =
                        source.directivity.pressure(bands, glm::normalize(geometry::Vec3(x, y, z)));
                    for (double& value : spectrum) {
                        value = std::abs(value);
                    }
                    spectra.push_back(spectrum);
                }
            }
        }
    }
    return spectra;
}

}  // namespace

std::vector<Spectrum> path_spectra(const Scene& scene, const Options& options) {
    const audio::Bands& bands = options.bands;
    Spectrum ones{};
    std::fill_n(ones.begin(), bands.count(), 1.0);
    std::vector<Spectrum> factors;
    for (const Material& material : scene.materials) {
        factors.push_back(reflected_pressure(material, bands));
        if (options.transmission) {
            factors.push_back(transmitted_pressure(material, bands));
        }
    }
    std::vector<Spectrum> surfaces = products_of(factors, ones);
    for (const Spectrum& spectrum : radiated(scene, bands)) {
        surfaces.push_back(spectrum);
    }
    std::vector<Spectrum> spectra;
    for (const double distance : kDistances) {
        if (distance > 0.0 && !options.air_absorption) {
            break;
        }
        const Spectrum air = air_pressure(options.air, bands, distance);
        for (const Spectrum& surface : surfaces) {
            Spectrum spectrum = product(surface, air);
            if (is_heard(spectrum)) {
                spectra.push_back(spectrum);
            }
        }
    }
    return spectra;
}

}  // namespace earshot::propagation
