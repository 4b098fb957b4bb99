// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/collision/internal/scene_meshes.h"
#include "earshot/collision/rigid_motion.h"

#include <cstddef>
#include <cstdint>
#include <optional>

namespace earshot::collision {

/// The screw on which a mesh whose vertices all follow one rigid node moves from one instant to
/// another; nothing for a mesh that deforms, is scaled, or does not turn: chords are exact then.
std::optional<Screw> screw_between(const SceneMeshes& meshes,
                                   std::uint32_t mesh,
                                   double t0,
                                   double t1);

/// Into how many parts of equal duration a step has to be split, a power of two up to 64, so that
/// between their ends screws follow the nodes: all turn by less than half a circle and are within
/// 1e-4 of the mesh's size of where the animation has them at two instants in between.
std::size_t screw_steps(const SceneMeshes& meshes, double t0, double t1);

/// How far a mesh turns during a step, radians: the sum over screw_steps().
double turn_of(const SceneMeshes& meshes, std::uint32_t mesh, double t0, double t1);

/// The instant after `part` of `parts` of a step; exact at its ends.
double instant_within(double t0, double t1, std::size_t part, std::size_t parts) noexcept;

}  // namespace earshot::collision
