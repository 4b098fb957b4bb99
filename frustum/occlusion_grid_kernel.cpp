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

// The difference of two inverse depths is linear in (u, v): it is positive in the whole cell if it
// exceeds at the centre what it can lose on the way to a corner.
std::uint64_t before(const CellPlanes& planes,
                     const CellGrid& grid,
                     const PlaneOverCells& plane,
                     std::uint64_t cells) {
    constexpr std::size_t kSide = CellPlanes::kSide;
    const Doubles constant(plane.constant), slope_u(plane.slope_u), slope_v(plane.slope_v);
    const Doubles half_u(grid.half_cell[0]), half_v(grid.half_cell[1]);
    const Doubles size(plane.size), rounding(grid.rounding);
    Doubles in_row[kSide / Doubles::kCount];
    for (std::size_t first = 0; first < kSide; first += Doubles::kCount) {
        in_row[first / Doubles::kCount] = constant + slope_u * Doubles::load(grid.centre_u + first);
    }
    std::uint64_t result = 0;
    for (std::uint64_t rest = cells; rest != 0;) {
        const auto row = static_cast<std::size_t>(std::countr_zero(rest)) / kSide;
        rest &= ~(std::uint64_t{0xff} << kSide * row);
        const Doubles from_row = slope_v * Doubles(grid.centre_v[row]);
        for (std::size_t first = 0; first < kSide; first += Doubles::kCount) {
            const std::size_t cell = kSide * row + first;
            const Doubles here = in_row[first / Doubles::kCount] + from_row;
            const Doubles change = abs(Doubles::load(planes.slope_u + cell) - slope_u) * half_u +
                                   abs(Doubles::load(planes.slope_v + cell) - slope_v) * half_v;
            const Doubles margin = change + rounding * (Doubles::load(planes.size + cell) + size);
            result |= std::uint64_t{bits(margin < Doubles::load(planes.centre + cell) - here)}
                      << cell;
        }
    }
    return result & cells;
}

}  // namespace earshot::frustum::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace earshot::frustum {

HWY_EXPORT(before);

std::uint64_t cells_before(const CellPlanes& planes,
                           const CellGrid& grid,
                           const PlaneOverCells& plane,
                           std::uint64_t cells) noexcept {
    return HWY_DYNAMIC_DISPATCH(before)(planes, grid, plane, cells);
}

}  // namespace earshot::frustum
#endif
