// SPDX-License-Identifier: MIT
#include "earshot/propagation/engine/internal/late_tails.h"

#include "earshot/audio/filter_cache.h"
#include "earshot/audio/late_noise.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace earshot::propagation {

LateTails::LateTails(const audio::Bands& bands, const Settings& settings) : settings_(settings) {
    const audio::FilterCache cache;
    for (std::size_t channel = 0; channel < settings.channels; ++channel) {
        noise_.push_back(audio::band_noise(
            bands, settings.length, settings.sample_rate, settings.seed + channel, cache));
    }
}

std::shared_ptr<const audio::Tail> LateTails::make(const audio::EnergyHistogram& histogram,
                                                   std::size_t source) const {
    const double samples_per_bin = histogram.bin * settings_.sample_rate;
    const std::size_t shift = source * settings_.length / settings_.sources;
    std::vector<std::vector<double>> channels;
    for (std::size_t channel = 0; channel < settings_.channels; ++channel) {
        // SN3D: in a diffuse field a harmonic of degree 1 has a third of the energy of degree 0.
        const double energy = (channel == 0 ? 1.0 : 1.0 / 3.0) / samples_per_bin;
        std::vector<double>& tail = channels.emplace_back(settings_.length, 0.0);
        for (std::size_t bin = 0; bin < histogram.energy.size(); ++bin) {
            const auto begin =
                static_cast<std::size_t>(std::ceil(static_cast<double>(bin) * samples_per_bin));
            const auto end = std::min(
                static_cast<std::size_t>(std::ceil(static_cast<double>(bin + 1) * samples_per_bin)),
                settings_.length);
            for (std::size_t band = 0; band < noise_[channel].size(); ++band) {
                const double amplitude = std::sqrt(energy * histogram.energy[bin][band]);
                if (amplitude == 0.0) {
                    continue;
                }
                const std::vector<double>& noise = noise_[channel][band];
                for (std::size_t n = begin; n < end; ++n) {
                    const std::size_t place = n + shift;
                    tail[n] += amplitude *
                               noise[place < settings_.length ? place : place - settings_.length];
                }
            }
        }
    }
    return std::make_shared<const audio::Tail>(channels, settings_.block);
}

}  // namespace earshot::propagation
