// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/bands.h"
#include "earshot/audio/impulse_response.h"
#include "earshot/frustum/path_arrivals.h"
#include "earshot/propagation/air.h"

#include <cstddef>
#include <span>
#include <vector>

namespace earshot::propagation {

/// What turns lengths and facets into pressures.
struct ArrivalModel {
    std::size_t bands = 0;
    double speed_of_sound = 0.0;
    const AirAbsorption& air;
    bool air_absorption = true;
    std::span<const audio::Spectrum> reflection;  ///< pressure factors per facet
    double min_pressure = 0.0;                    ///< arrivals of less in every band are left out
};

/// The arrivals of an omnidirectional source's paths at a listener, with the numbers of the same
/// paths that are described one by one.
std::vector<audio::Arrival> describe_arrivals(frustum::PathArrivals& paths,
                                              const geometry::Vec3& listener,
                                              const ArrivalModel& model);

}  // namespace earshot::propagation
