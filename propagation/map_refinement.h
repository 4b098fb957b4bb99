// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/propagation/map_metric.h"
#include "earshot/propagation/map_points.h"

#include <compare>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace earshot::propagation {

/// A square of cells of a lattice, all of which take part, as the cells of a quadtree are: `size`
/// is a power of two, of which `column` and `row` are multiples. At the lattice's border it is
/// clipped.
struct MapCell {
    std::uint32_t sheet = 0;
    std::uint32_t row = 0, column = 0;  ///< of its first cell
    std::uint32_t size = 1;             ///< cells along a side, before it is clipped

    std::uint32_t end_column(const MapLattice& lattice) const noexcept;
    std::uint32_t end_row(const MapLattice& lattice) const noexcept;
    friend auto operator<=>(const MapCell&, const MapCell&) = default;
};

/// A cell and its point, which is in its middle.
struct MapCellPoint {
    MapCell cell{};
    geometry::Vec3 point{0.0};
};

/// The coarsest cells of a quadtree over the lattice: of at most `size` cells (a power of two)
/// along a side, halved until all of their parts take part and their middle is in the air.
std::vector<MapCellPoint> coarsest_cells(const MapLattice& lattice,
                                         std::uint32_t size,
                                         const AirTest& air);

/// The quarters of a cell. Precondition: size > 1.
std::vector<MapCellPoint> quarters_of(const MapCell& cell,
                                      const MapLattice& lattice,
                                      const AirTest& air);

/// Which cells are to be halved: those that share an edge with another where some value differs by
/// more than its just-noticeable difference and the standard error of the difference. `values`: of
/// each cell, for any number of sources each metric. Ascending indices of cells that can be halved.
std::vector<std::size_t> cells_to_halve(const MapLattice& lattice,
                                        std::span<const MapCellPoint> cells,
                                        std::span<const MapValue> values,
                                        std::span<const MapMetric> metrics);

/// Per sheet, row and column: the number of the cell that holds a cell of the lattice; kNoCell
/// where there is none.
inline constexpr std::uint32_t kNoCell = 0xFFFFFFFF;
std::vector<std::uint32_t> cell_numbers(const MapLattice& lattice,
                                        std::span<const MapCellPoint> cells);

}  // namespace earshot::propagation
