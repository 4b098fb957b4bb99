// SPDX-License-Identifier: MIT
#include "earshot/propagation/internal/material_sums.h"

#include "earshot/propagation/internal/replicate_sums.h"

#include <span>

namespace earshot::propagation {
namespace {

/// Enough to know a standard error to a quarter of it; their memory grows with their number.
constexpr std::size_t kMaxParts = 8;

void add(double weight, std::span<const double> part, std::vector<double>& sums) {
    for (std::size_t i = 0; i < sums.size(); ++i) {
        sums[i] += weight * part[i];
    }
}

void scale(double factor, std::vector<double>& numbers) {
    for (double& number : numbers) {
        number *= factor;
    }
}

}  // namespace

MaterialSums::MaterialSums(const RayOptions& options,
                           std::size_t listener,
                           std::size_t bins,
                           std::size_t materials)
    : listener_(listener), bins_(bins), has_scatterings_(options.report_scattering) {
    sums_.materials = materials;
    sums_.bands = options.bands.count();
    if (materials > 0) {
        sums_.first_bin = coarse_intervals(bins, options.bin);
        sums_.touched.resize(sums_.intervals() * materials * sums_.bands);
        sums_.absorbed.resize(2 * materials * sums_.bands);
    }
}

void MaterialSums::add(const BatchResult& batch, double weight) {
    if (sums_.materials == 0) {
        return;
    }
    const std::size_t cells = sums_.touched.size();
    const auto of_listener = [&](const std::vector<double>& numbers) {
        return std::span(numbers).subspan(listener_ * cells, cells);
    };
    if (sums_.parts.size() < kMaxParts) {
        sums_.parts.push_back({.energy = std::vector<double>(sums_.intervals() * sums_.bands),
                               .reflections = std::vector<double>(cells),
                               .scatterings = std::vector<double>(has_scatterings_ ? cells : 0)});
    }
    LateMaterials::Part& part = sums_.parts[batches_ % kMaxParts];
    part.share += weight;
    add_energy(batch, weight, part);
    propagation::add(weight, of_listener(batch.materials.reflections), part.reflections);
    if (has_scatterings_) {
        propagation::add(weight, of_listener(batch.materials.scatterings), part.scatterings);
    }
    propagation::add(weight, of_listener(batch.materials.touched), sums_.touched);
    propagation::add(weight, batch.materials.absorbed, sums_.absorbed);
    for (std::size_t band = 0; band < sums_.bands; ++band) {
        emitted_[band] += weight * batch.balance.emitted[band];
    }
    rays_ += weight;
    ++batches_;
}

void MaterialSums::add_energy(const BatchResult& batch,
                              double weight,
                              LateMaterials::Part& part) const {
    const double* energy = batch.energy.data() + listener_ * bins_ * sums_.bands;
    for (std::size_t interval = 0; interval < sums_.intervals(); ++interval) {
        double* sum = part.energy.data() + interval * sums_.bands;
        for (std::size_t bin = sums_.first_bin[interval]; bin < sums_.first_bin[interval + 1];
             ++bin) {
            for (std::size_t band = 0; band < sums_.bands; ++band) {
                sum[band] += weight * energy[bin * sums_.bands + band];
            }
        }
    }
}

LateMaterials MaterialSums::result() const {
    LateMaterials result = sums_;
    for (LateMaterials::Part& part : result.parts) {
        part.share /= rays_;
        scale(1.0 / rays_, part.energy);
        scale(1.0 / rays_, part.reflections);
        scale(1.0 / rays_, part.scatterings);
    }
    scale(1.0 / rays_, result.touched);
    for (std::size_t i = 0; i < result.absorbed.size(); ++i) {
        const double emitted = emitted_[i % sums_.bands];
        result.absorbed[i] = emitted > 0.0 ? result.absorbed[i] / emitted : 0.0;
    }
    return result;
}

}  // namespace earshot::propagation
