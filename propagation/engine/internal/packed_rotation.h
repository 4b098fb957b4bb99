// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/harmonic_rotation.h"
#include "earshot/propagation/pose.h"

#include <cstdint>

namespace earshot::propagation {

/// How a listener is turned, in one word, which threads pass on without locks: of the unit
/// quaternion re the axes of a listener who looks along -Z the largest component's place, and the
/// three others in 20 bits each (4e-6 rad).
std::uint64_t pack_rotation(const Pose& pose) noexcept;

/// The listener's front, left and up in those of one who looks along -Z.
audio::RotationRows unpack_rotation(std::uint64_t packed) noexcept;

}  // namespace earshot::propagation
