// SPDX-License-Identifier: MIT
// What rays tell of the materials that they meet.
#include "earshot/propagation/internal/listener_sums.h"
#include "earshot/propagation/internal/ray_batch.h"
#include "earshot/propagation/internal/replicate_sums.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace earshot::propagation {

void RayTracer::describe_intervals() {
    const std::vector<std::size_t> first_bin = coarse_intervals(bins_, options_.bin);
    interval_of_bin_.clear();
    for (std::size_t bin = 0, interval = 0; bin < bins_; ++bin) {
        interval += bin == first_bin[interval + 1] ? 1 : 0;
        interval_of_bin_.push_back(interval);
    }
    air_loss_ = air_losses(options_, bins_);
}

BatchMaterials RayTracer::empty_materials() const {
    const std::size_t materials = reported_materials();
    const std::size_t cells = receivers_.size() * material_intervals() * materials * bands_;
    return {.reflections = std::vector<double>(cells),
            .touched = std::vector<double>(cells),
            .scatterings = std::vector<double>(options_.report_scattering ? cells : 0),
            .absorbed = std::vector<double>(2 * materials * bands_)};
}

template <std::size_t kBands>
void RayBatch<kBands>::set_rain_reflections(std::size_t ray, std::uint32_t material) {
    if (materials_ == 0) {
        return;
    }
    std::uint32_t* rain = rain_reflections_.data() + (secondary_source_count_ - 1) * counts_;
    std::copy_n(reflections_of(ray), counts_, rain);
    count_reflection(material, true, rain);
}

template <std::size_t kBands>
void RayBatch<kBands>::record_materials(std::size_t listener,
                                        std::size_t bin,
                                        const Energies& energy,
                                        double share,
                                        const std::uint32_t* reflections) {
    const std::size_t row = listener * tracer_.material_intervals() + tracer_.interval_of_bin_[bin];
    for (std::size_t material = 0; material < materials_; ++material) {
        if (reflections[material] > 0) {
            const std::size_t cell = (row * materials_ + material) * kBands;
            add(share * reflections[material], energy, result_.materials.reflections.data() + cell);
            add(share, energy, result_.materials.touched.data() + cell);
            if (counts_ > materials_ && reflections[materials_ + material] > 0) {
                add(share * reflections[materials_ + material],
                    energy,
                    result_.materials.scatterings.data() + cell);
            }
        }
    }
}

/// What a surface takes of the energy that arrives after a way of `travelled` metres.
template <std::size_t kBands>
void RayBatch<kBands>::record_absorption(std::size_t material,
                                         double travelled,
                                         const RaySurface& surface,
                                         const Energies& energy) {
    const double position = travelled * tracer_.bins_per_metre_;
    const bool is_late = position >= kEarlyLimit / options_.bin;
    const std::size_t bin = position < static_cast<double>(tracer_.bins_)
                                ? static_cast<std::size_t>(position)
                                : tracer_.bins_ - 1;
    const double* air = tracer_.air_loss_.data() + bin * kBands;
    double* absorbed =
        result_.materials.absorbed.data() + ((is_late ? materials_ : 0) + material) * kBands;
    for (std::size_t band = 0; band < kBands; ++band) {
        absorbed[band] += air[band] * (surface.absorbed[band] * energy[band]);
    }
}

// Octaves and thirds.
template void RayBatch<10>::set_rain_reflections(std::size_t, std::uint32_t);
template void RayBatch<10>::record_materials(
    std::size_t, std::size_t, const Energies&, double, const std::uint32_t*);
template void RayBatch<10>::record_absorption(std::size_t,
                                              double,
                                              const RaySurface&,
                                              const Energies&);
template void RayBatch<31>::set_rain_reflections(std::size_t, std::uint32_t);
template void RayBatch<31>::record_materials(
    std::size_t, std::size_t, const Energies&, double, const std::uint32_t*);
template void RayBatch<31>::record_absorption(std::size_t,
                                              double,
                                              const RaySurface&,
                                              const Energies&);

}  // namespace earshot::propagation
