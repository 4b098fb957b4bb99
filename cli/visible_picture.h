// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/mesh.h"
#include "earshot/io/png.h"
#include "earshot/propagation/scene.h"
#include "earshot/visibility/item_buffer.h"

#include <array>
#include <cstdint>
#include <span>
#include <string>

namespace earshot::cli {

using Colour = std::array<std::uint8_t, 3>;

/// A colour of its own for a number; successive numbers get very different ones.
Colour colour_of(std::uint32_t number) noexcept;

/// #rrggbb
std::string name_of(const Colour& colour);

/// Every triangle in the colour of its number. Black where nothing is seen, here and below.
io::Picture paint_triangles(const visibility::ItemBuffer& buffer);

/// Every triangle in the colour of its material's index, darker where it is seen at a flat angle.
/// `mesh` is in the pose of the item buffer.
io::Picture paint_materials(const visibility::ItemBuffer& buffer,
                            const geometry::MeshView& mesh,
                            std::span<const std::uint32_t> material_of_triangle);

/// Distances as greys: 255 at the point, falling evenly to 15 at `range` metres and beyond.
io::Picture paint_depths(const visibility::ItemBuffer& buffer, double range);

/// The largest distance, metres; 0 if nothing is seen.
double farthest(const visibility::ItemBuffer& buffer) noexcept;

}  // namespace earshot::cli
