// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/frustum/edge_paths.h"
#include "earshot/geometry/wedge.h"

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace earshot::propagation {

/// Tells which paths over edges may be as loud as is asked for, from their ends alone: before it is
/// known what of an edge sound reaches.
class EdgeLevelFilter final : public frustum::EdgePathFilter {
public:
    /// `max_reflection`: per facet the pressure factor of the loudest band. `max_order`: terms of
    /// diffraction that mend specular paths with more reflections do not count. `loudest_source`:
    /// what the source sends in any direction and band.
    EdgeLevelFilter(std::span<const double> max_reflection, int max_order, double loudest_source)
        : max_reflection_(max_reflection), max_order_(max_order), loudest_source_(loudest_source) {}

    /// The next listener, and the pressure in the loudest band that is asked for there.
    void add_listener(double min_pressure) { min_pressure_.push_back(min_pressure); }

    bool may_be_wanted(const geometry::Wedge& wedge,
                       const geometry::Interval& part,
                       const frustum::EdgeEnd& source,
                       const frustum::EdgeEnd& listener,
                       std::size_t listener_index) const override;

private:
    std::span<const double> max_reflection_;
    int max_order_;
    double loudest_source_;
    std::vector<double> min_pressure_;  // per listener
};

/// A bound on the pressure that any parts of a wedge within one diffract between two ends, at every
/// frequency, their reflections aside. `face_factors`: as EdgeDiffraction::pressure_factors.
double max_pressure_between(const geometry::Wedge& wedge,
                            const geometry::Interval& part,
                            const frustum::EdgeEnd& source,
                            const frustum::EdgeEnd& listener,
                            const std::array<double, 3>& face_factors) noexcept;

}  // namespace earshot::propagation
