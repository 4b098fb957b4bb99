// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/floating_point.h"

#include <cstddef>
#include <cstdint>

namespace earshot::frustum {

/// Planes of the cells of an 8 x 8 grid, row by row: inverse depth at the centre, how it changes
/// with u and v, and the size of the coefficients.
struct alignas(64) CellPlanes {
    static constexpr std::size_t kSide = 8;
    static constexpr std::size_t kCells = kSide * kSide;
    double centre[kCells] = {};
    double slope_u[kCells] = {}, slope_v[kCells] = {};
    double size[kCells] = {};
};

/// Where the cells lie in (u, v).
struct alignas(64) CellGrid {
    double centre_u[CellPlanes::kSide] = {}, centre_v[CellPlanes::kSide] = {};
    double half_cell[2] = {};
    double rounding = 0.0;  ///< of inverse depths, relative to the sizes of two planes
};

/// An inverse depth and the size of its coefficients.
struct PlaneOverCells {
    double constant, slope_u, slope_v, size;
};

/// Those of `cells` whose own plane has a larger inverse depth than another one everywhere in the
/// cell, by more than rounding. The same bits on every instruction set.
std::uint64_t cells_before(const CellPlanes& planes,
                           const CellGrid& grid,
                           const PlaneOverCells& plane,
                           std::uint64_t cells) noexcept;

/// Those of `cells` at whose centre an inverse depth exceeds a limit. The same bits on every
/// instruction set.
std::uint64_t cells_above(const CellGrid& grid,
                          const PlaneOverCells& plane,
                          double limit,
                          std::uint64_t cells) noexcept;

}  // namespace earshot::frustum
