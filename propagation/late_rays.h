// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/base/progress.h"
#include "earshot/propagation/late_energy.h"

#include <cstddef>
#include <functional>
#include <span>

namespace earshot::propagation {

/// Throws Error if an option is out of range.
void validate(const RayOptions& options);

/// Late sound by stochastic ray tracing (Vorlaender 2008, chapter 11). At each surface a ray loses
/// the absorbed energy and is reflected specularly or, with the probability of the scattering
/// coefficient, into a direction drawn from Lambert's law. Scattered energy reaches every visible
/// listener directly (diffuse rain), but from surfaces near it, where rays that start at the
/// listener find it; specular legs count by the length of their chord through a sphere about the
/// listener, an unbiased estimate of the energy density. Backs of one-sided
/// materials absorb all energy. Ray i is a pure function of (seed, i), and sums run in the order of
/// rays: the same bits for any executor. Throws Error if an option is out of range. Reports the
/// stage "late rays", ray by ray.
LateEnergy trace_late_rays(const RayScene& scene,
                           const RaySource& source,
                           std::span<const geometry::Vec3> listeners,
                           const RayOptions& options = {},
                           Executor& executor = Executor::serial(),
                           Progress* progress = nullptr);

/// Takes what the listener of an index receives.
using VisitLateSound = std::function<void(std::size_t, LateSound&&)>;

/// The same for listeners by the hundred: calls visit() once for each listener, from several
/// threads at a time, so that memory holds few results at a time. The numbers are those of
/// trace_late_rays().
LateTotals visit_late_sound(const RayScene& scene,
                            const RaySource& source,
                            std::span<const geometry::Vec3> listeners,
                            const VisitLateSound& visit,
                            const RayOptions& options = {},
                            Executor& executor = Executor::serial(),
                            Progress* progress = nullptr);

/// The length of a histogram that holds a decay of about 65 dB in every band, seconds, 0.05 ... 20,
/// estimated from a few rays.
double late_length(const RayScene& scene,
                   const RaySource& source,
                   const RayOptions& options = {},
                   Executor& executor = Executor::serial());

}  // namespace earshot::propagation
