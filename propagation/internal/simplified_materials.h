// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/floating_point.h"
#include "earshot/propagation/material.h"

#include <span>
#include <vector>

namespace earshot::propagation {

/// Surfaces of one material that something else stands for.
struct ReplacedSurface {
    const Material* material = nullptr;
    double area = 0.0;          ///< of sides that sound can reach, square metres
    double rms_distance = 0.0;  ///< from what stands for them, metres
};

/// A material for surfaces that stand for others.
struct SubstituteMaterial {
    Material material;
    double removed_depth = 0.0;  ///< metres
    bool is_new = false;         ///< it is not as it was
    bool is_limited = false;     ///< its absorption is cut at 1 at some frequency
};

/// `material` such that it absorbs and transmits on `area` what the replaced surfaces did, and
/// scatters as they did and by the depth that was removed besides.
SubstituteMaterial substitute_material(Material material,
                                       std::span<const ReplacedSurface> replaced,
                                       double area);

/// The scattering of a structure: 0.5 sqrt(depth / wavelength), at most 0.99 (Postma and Katz 2015,
/// with the speed of sound at 20 degrees).
double structure_scattering(double depth, double frequency_hz);

}  // namespace earshot::propagation
