// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/propagation/internal/quadrature.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace earshot::propagation {

/// Where an integrand is steep: it has a singularity at position +- j distance in the complex
/// plane.
struct SteepPlace {
    double position = 0.0;
    double distance = 0.0;
};

/// Of a panel with 16 nodes: its length over the distance to a singularity, and the radians that
/// the phase may turn in it. Either leaves an error below 1e-7.
inline constexpr double kMaxPanelLength = 2.5;
inline constexpr double kMaxPanelPhase = 24.0;

/// Calls add(position, weight) for the nodes of panels between `begin` and `end`, which are halved
/// until each is short against its distance from every steep place and the phase turns little.
template <typename Phase, typename Add>
void integrate_graded(double begin,
                      double end,
                      std::span<const SteepPlace> steep,
                      const Phase& phase,
                      const Add& add) {
    const double smallest = std::ldexp(end - begin, -40);
    const auto is_fine = [&](double from, double to) {
        const double length = to - from;
        if (length <= smallest) {
            return true;
        }
        for (const SteepPlace& place : steep) {
            const double gap = std::max({0.0, from - place.position, place.position - to});
            if (length > kMaxPanelLength * std::max(gap, place.distance)) {
                return false;
            }
        }
        const double middle = phase(0.5 * (from + to));
        return std::abs(middle - phase(from)) + std::abs(phase(to) - middle) <= kMaxPanelPhase;
    };
    double from = begin;
    double size = end - begin;
    // Panels are those of a binary tree; `to` is reached from the left in order.
    while (from < end) {
        while (!is_fine(from, std::min(end, from + size))) {
            size *= 0.5;
        }
        const double to = std::min(end, from + size);
        const double centre = 0.5 * (from + to);
        const double half = 0.5 * (to - from);
        for (const QuadratureNode& node : kLegendre16) {
            add(centre - half * node.position, half * node.weight);
            add(centre + half * node.position, half * node.weight);
        }
        from = to;
        size *= 2.0;
    }
}

}  // namespace earshot::propagation
