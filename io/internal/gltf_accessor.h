// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/types.h"
#include "earshot/io/internal/gltf_file.h"

#include <cstdint>
#include <vector>

namespace earshot::io {

/// Limit of the numbers of an accessor without a bufferView (all zeros but for sparse values), so
/// that a few characters of JSON cannot ask for all memory.
inline constexpr std::size_t kMaxUnbackedNumbers = std::size_t{1} << 24U;

/// The numbers of a glTF accessor (2.0 section 3.6.2) with `components` each (1 SCALAR, 3 VEC3, 4
/// VEC4, 16 MAT4), element after element: floats as they are, normalised integers as fractions,
/// others as numbers; sparse values put in place. Throws Error if the type is another, the bytes do
/// not lie in their buffer, or a number is not finite.
std::vector<double> accessor_numbers(const GltfFile& file, int accessor, std::size_t components);

/// The same for unsigned integers that are not normalised: vertex indices and joints. Each must be
/// below `bound`, the number of `what`.
std::vector<std::uint32_t> accessor_indices(const GltfFile& file,
                                            int accessor,
                                            std::size_t components,
                                            std::size_t bound,
                                            const std::string& what);

/// VEC3 numbers as they are: a vertex that no triangle uses may hold anything.
std::vector<geometry::Vec3> accessor_points(const GltfFile& file, int accessor);

/// Throws Error if one of these points of the accessor that is used is not finite or lies beyond
/// kMaxCoordinate.
void check_used_points(const GltfFile& file,
                       int accessor,
                       const std::vector<geometry::Vec3>& points,
                       const std::vector<bool>& is_used);

}  // namespace earshot::io
