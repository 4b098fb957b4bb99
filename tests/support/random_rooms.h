// SPDX-License-Identifier: MIT
#pragma once

#include "support/rooms.h"
#include <cstdint>

namespace earshot::support {

/// Number of families random_room() takes in turn.
inline constexpr std::uint64_t kRoomFamilies = 7;

/// A room that follows from the seed: boxes with standing and floating obstacles, L, T and U plans,
/// rooms coupled through openings from a millimetre to a door, sloped and folded ceilings, single
/// sheets and millimetre plates, slivers and millimetre gaps, and rooms crowded with furniture
/// (seed modulo kRoomFamilies). Every other round the whole room is turned, so that no wall is
/// parallel to an axis. 12 to 400 triangles.
Room random_room(std::uint64_t seed);

}  // namespace earshot::support
