// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/bands.h"
#include "earshot/propagation/internal/ray_tracer.h"
#include "earshot/propagation/late_materials.h"

#include <cstddef>
#include <vector>

namespace earshot::propagation {

/// Adds up what the batches of one listener tell of materials, in their order. Batches are dealt
/// out to the parts of LateMaterials in turn.
class MaterialSums {
public:
    /// Of listener `listener`, with `bins` bins. Without materials nothing is added.
    MaterialSums(const RayOptions& options,
                 std::size_t listener,
                 std::size_t bins,
                 std::size_t materials);

    /// Adds a batch with the weight of its rays.
    void add(const BatchResult& batch, double weight);
    LateMaterials result() const;

private:
    void add_energy(const BatchResult& batch, double weight, LateMaterials::Part& part) const;

    std::size_t listener_, bins_;
    bool has_scatterings_;
    LateMaterials sums_;         // times the rays of a batch
    audio::Spectrum emitted_{};  // likewise
    double rays_ = 0.0;
    std::size_t batches_ = 0;
};

}  // namespace earshot::propagation
