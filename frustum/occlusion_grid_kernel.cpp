// SPDX-License-Identifier: MIT
#include "earshot/frustum/internal/occlusion_rows.h"

#include <bit>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "earshot/frustum/occlusion_grid_kernel.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which includes this file again for every instruction set.
#include "earshot/base/simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace earshot::frustum::HWY_NAMESPACE {

using namespace earshot::HWY_NAMESPACE;

/// Those of `cells` for which test(first, depth) is true, a row or a part of it at a time: `first`
/// is a cell, `depth` is that of the plane at the centres from there on.
template <typename Test>
HWY_INLINE std::uint64_t cells_where(const CellGrid& grid,
                                     const PlaneOverCells& plane,
                                     std::uint64_t cells,
                                     const Test& test) {
    constexpr std::size_t kSide = CellPlanes::kSide;
    Doubles in_first_row[kSide / Doubles::kCount];
    for (std::size_t first = 0; first < kSide; first += Doubles::kCount) {
        in_first_row[first / Doubles::kCount] =
            Doubles(plane.constant) + Doubles(plane.slope_u) * Doubles::load(grid.centre_u + first);
    }
    std::uint64_t result = 0;
    for (std::uint64_t rest = cells; rest != 0;) {
        const auto row = static_cast<std::size_t>(std::countr_zero(rest)) / kSide;
        rest &= ~(std::uint64_t{0xff} << kSide * row);
        const Doubles to_row = Doubles(plane.slope_v) * Doubles(grid.centre_v[row]);
        for (std::size_t first = 0; first < kSide; first += Doubles::kCount) {
            const std::size_t cell = kSide * row + first;
            const Doubles depth = in_first_row[first / Doubles::kCount] + to_row;
            result |= std::uint64_t{bits(test(cell, depth))} << cell;
        }
    }
    return result & cells;
}

// The difference of two inverse depths is linear in (u, v): it is positive in the whole cell if it
// exceeds at the centre what it can lose on the way to a corner.
std::uint64_t before(const CellPlanes& planes,
                     const CellGrid& grid,
                     const PlaneOverCells& plane,
                     std::uint64_t cells) {
    const Doubles slope_u(plane.slope_u), slope_v(plane.slope_v), size(plane.size);
    const Doubles half_u(grid.half_cell[0]), half_v(grid.half_cell[1]), rounding(grid.rounding);
    return cells_where(grid, plane, cells, [&](std::size_t cell, const Doubles& depth) {
        const Doubles change = abs(Doubles::load(planes.slope_u + cell) - slope_u) * half_u +
                               abs(Doubles::load(planes.slope_v + cell) - slope_v) * half_v;
        const Doubles margin = change + rounding * (Doubles::load(planes.size + cell) + size);
        return margin < Doubles::load(planes.centre + cell) - depth;
    });
}

std::uint64_t above(const CellGrid& grid,
                    const PlaneOverCells& plane,
                    double limit,
                    std::uint64_t cells) {
    const Doubles lowest(limit);
    return cells_where(
        grid, plane, cells, [&](std::size_t, const Doubles& depth) { return lowest < depth; });
}

}  // namespace earshot::frustum::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace earshot::frustum {

HWY_EXPORT(before);
HWY_EXPORT(above);

std::uint64_t cells_before(const CellPlanes& planes,
                           const CellGrid& grid,
                           const PlaneOverCells& plane,
                           std::uint64_t cells) noexcept {
    return HWY_DYNAMIC_DISPATCH(before)(planes, grid, plane, cells);
}

std::uint64_t cells_above(const CellGrid& grid,
                          const PlaneOverCells& plane,
                          double limit,
                          std::uint64_t cells) noexcept {
    return HWY_DYNAMIC_DISPATCH(above)(grid, plane, limit, cells);
}

}  // namespace earshot::frustum
#endif
