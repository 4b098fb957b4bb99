// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/floating_point.h"

#include <cstddef>
#include <vector>

namespace earshot::propagation {

/// End of the early part of sound, seconds: of C80, and of the energies by material.
inline constexpr double kEarlyLimit = 0.08;

/// What the late energy of one listener has met on its way, by material and band. Energies are
/// means over the rays, in the units of EnergyHistogram::energy but without the loss in air. Arrays
/// are row-major.
struct LateMaterials {
    std::size_t materials = 0;
    std::size_t bands = 0;
    /// First bin of each interval, and the number of bins, as in HistogramReplicates.
    std::vector<std::size_t> first_bin{};

    /// A part of the batches of rays; the sums of all parts are those of all rays.
    struct Part {
        double share = 0.0;                 ///< of the rays
        std::vector<double> energy{};       ///< interval, band
        std::vector<double> reflections{};  ///< interval, material, band: energy times the number
                                            ///< of its reflections by the material
        std::vector<double> scatterings{};  ///< likewise, of those that scattered it; empty unless
                                            ///< RayOptions::report_scattering
    };
    /// Equally large but for the last batches: replicates, for standard errors.
    std::vector<Part> parts{};
    /// Interval, material, band: energy that the material reflected at least once.
    std::vector<double> touched{};
    /// Share of the emitted energy that the material absorbs, the loss in air before it included:
    /// window (until kEarlyLimit after the emission, later), material, band.
    std::vector<double> absorbed{};

    std::size_t intervals() const noexcept { return first_bin.empty() ? 0 : first_bin.size() - 1; }
};

}  // namespace earshot::propagation
