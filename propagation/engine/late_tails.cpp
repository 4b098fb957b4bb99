// SPDX-License-Identifier: MIT
#include "earshot/propagation/engine/internal/late_tails.h"

#include "earshot/audio/filter_cache.h"
#include "earshot/audio/late_noise.h"
#include "earshot/audio/spatial.h"
#include "earshot/propagation/pose.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

namespace earshot::propagation {

namespace {

using Matrix = std::array<std::array<double, LateTails::kMaxChannels>, LateTails::kMaxChannels>;

/// The harmonics, in the scene's axes, of a plane wave from each part of the sphere.
std::array<std::array<double, LateTails::kMaxChannels>, audio::kDirectionParts> part_harmonics() {
    std::array<std::array<double, LateTails::kMaxChannels>, audio::kDirectionParts> harmonics{};
    for (std::size_t part = 0; part < audio::kDirectionParts; ++part) {
        const auto middle = audio::middle_of_part(part);
        const geometry::Vec3 towards = Pose{}.seen_from({middle[0], middle[1], middle[2]});
        audio::spherical_harmonics(1, {towards.x, towards.y, towards.z}, harmonics[part]);
    }
    return harmonics;
}

/// The lower triangular factor of a matrix that has no negative eigenvalue (Golub and Van Loan
/// 2013, section 4.2). A row that those before it make up has no part of its own.
Matrix cholesky_factor(const Matrix& matrix) {
    constexpr double kRounding = 1e-12;  // of numbers of at most 1
    Matrix factor{};
    for (std::size_t column = 0; column < matrix.size(); ++column) {
        for (std::size_t row = column; row < matrix.size(); ++row) {
            double left = matrix[row][column];
            for (std::size_t k = 0; k < column; ++k) {
                left -= factor[row][k] * factor[column][k];
            }
            if (row == column) {
                factor[row][column] = left > kRounding ? std::sqrt(left) : 0.0;
            } else if (factor[column][column] > 0.0) {
                factor[row][column] = left / factor[column][column];
            }
        }
    }
    return factor;
}

/// What makes of independent noises of equal energy the harmonics of a field whose energy comes
/// from the parts of the sphere as `directions` tell, or from all alike: their covariance is the
/// sum over the parts of energy times harmonic times harmonic, re the energy of all.
Matrix mixing_of(std::span<const audio::Spectrum> directions, std::size_t band) {
    static const auto harmonics = part_harmonics();
    double whole = 0.0;
    for (const audio::Spectrum& energy : directions) {
        whole += energy[band];
    }
    Matrix covariance{};
    for (std::size_t part = 0; part < audio::kDirectionParts; ++part) {
        const double share =
            whole > 0.0 ? directions[part][band] / whole : 1.0 / audio::kDirectionParts;
        for (std::size_t row = 0; row < covariance.size(); ++row) {
            for (std::size_t column = 0; column < covariance.size(); ++column) {
                covariance[row][column] += share * harmonics[part][row] * harmonics[part][column];
            }
        }
    }
    return cholesky_factor(covariance);
}

}  // namespace

LateTails::LateTails(const audio::Bands& bands, const Settings& settings) : settings_(settings) {
    const audio::FilterCache cache;
    for (std::size_t channel = 0; channel < settings.channels; ++channel) {
        noise_.push_back(audio::band_noise(
            bands, settings.length, settings.sample_rate, settings.seed + channel, cache));
    }
}

std::shared_ptr<const audio::Tail> LateTails::make(const audio::EnergyHistogram& histogram,
                                                   std::size_t source) const {
    const std::size_t shift = source * settings_.length / settings_.sources;
    std::vector<std::vector<double>> channels(settings_.channels,
                                              std::vector<double>(settings_.length, 0.0));
    for (std::size_t band = 0; band < noise_.front().size(); ++band) {
        Matrix mixing{};
        for (std::size_t bin = 0; bin < histogram.energy.size(); ++bin) {
            if (bin % audio::kBinsPerSpan == 0) {
                const std::size_t span = bin / audio::kBinsPerSpan;
                mixing = span < histogram.directions.size()
                             ? mixing_of(histogram.directions[span], band)
                             : mixing_of({}, band);
            }
            for (std::size_t channel = 0; channel < settings_.channels; ++channel) {
                for (std::size_t noise = 0; noise <= channel; ++noise) {
                    add({.histogram = histogram, .bin = bin, .band = band, .shift = shift},
                        mixing[channel][noise],
                        noise_[noise][band],
                        channels[channel]);
                }
            }
        }
    }
    return std::make_shared<const audio::Tail>(channels, settings_.block);
}

void LateTails::add(const Interval& interval,
                    double gain,
                    const std::vector<double>& noise,
                    std::vector<double>& tail) const {
    const double samples_per_bin = interval.histogram.bin * settings_.sample_rate;
    const double amplitude =
        gain * std::sqrt(interval.histogram.energy[interval.bin][interval.band] / samples_per_bin);
    if (amplitude == 0.0) {
        return;
    }
    const auto sample_at = [&](std::size_t bin) {
        return std::min(
            static_cast<std::size_t>(std::ceil(static_cast<double>(bin) * samples_per_bin)),
            settings_.length);
    };
    const std::size_t end = sample_at(interval.bin + 1);
    for (std::size_t n = sample_at(interval.bin); n < end; ++n) {
        const std::size_t place = n + interval.shift;
        tail[n] += amplitude * noise[place < settings_.length ? place : place - settings_.length];
    }
}

}  // namespace earshot::propagation
