// SPDX-License-Identifier: MIT
#include "earshot/propagation/map_refinement.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace earshot::propagation {

namespace {

/// Adds a cell if all of it takes part, else those of its quarters that do.
class Division {
public:
    Division(const MapLattice& lattice, const AirTest& air, std::vector<MapCellPoint>& cells)
        : lattice_(lattice), air_(air), cells_(cells) {}

    void add(const MapCell& cell) {
        const std::uint32_t end_column = cell.end_column(lattice_);
        const std::uint32_t end_row = cell.end_row(lattice_);
        std::size_t valid = 0;
        double height = 0.0;
        for (std::uint32_t row = cell.row; row < end_row; ++row) {
            for (std::uint32_t column = cell.column; column < end_column; ++column) {
                if (lattice_.is_valid(cell.sheet, column, row)) {
                    ++valid;
                    height += lattice_.height(cell.sheet, column, row);
                }
            }
        }
        if (valid == 0) {
            return;
        }
        const double x = lattice_.x_at(0.5 * (cell.column + end_column));
        const double z = lattice_.z_at(0.5 * (cell.row + end_row));
        if (cell.size == 1) {
            cells_.push_back({cell, {x, height, z}});
            return;
        }
        const std::size_t all = std::size_t{end_column - cell.column} * (end_row - cell.row);
        if (valid == all) {
            const auto point = lattice_.point_at(x, height / static_cast<double>(valid), z, air_);
            if (point) {
                cells_.push_back({cell, *point});
                return;
            }
        }
        add_quarters(cell);
    }

    void add_quarters(const MapCell& cell) {
        const std::uint32_t half = cell.size / 2;
        for (const std::uint32_t row : {cell.row, cell.row + half}) {
            for (const std::uint32_t column : {cell.column, cell.column + half}) {
                if (row < lattice_.rows() && column < lattice_.columns()) {
                    add({.sheet = cell.sheet, .row = row, .column = column, .size = half});
                }
            }
        }
    }

private:
    const MapLattice& lattice_;
    const AirTest& air_;
    std::vector<MapCellPoint>& cells_;
};

bool differ(std::span<const MapValue> a,
            std::span<const MapValue> b,
            std::span<const MapMetric> metrics) {
    for (std::size_t i = 0; i < a.size(); ++i) {
        if (!a[i].value || !b[i].value) {
            continue;
        }
        const double mean = 0.5 * (*a[i].value + *b[i].value);
        const double limit =
            metrics[i % metrics.size()].just_noticeable_difference(mean) +
            std::hypot(a[i].standard_error.value_or(0.0), b[i].standard_error.value_or(0.0));
        if (std::abs(*a[i].value - *b[i].value) > limit) {
            return true;
        }
    }
    return false;
}

}  // namespace

std::uint32_t MapCell::end_column(const MapLattice& lattice) const noexcept {
    return std::min(column + size, lattice.columns());
}

std::uint32_t MapCell::end_row(const MapLattice& lattice) const noexcept {
    return std::min(row + size, lattice.rows());
}

std::vector<MapCellPoint> coarsest_cells(const MapLattice& lattice,
                                         std::uint32_t size,
                                         const AirTest& air) {
    std::vector<MapCellPoint> cells;
    Division division(lattice, air, cells);
    for (std::uint32_t sheet = 0; sheet < lattice.sheets(); ++sheet) {
        for (std::uint32_t row = 0; row < lattice.rows(); row += size) {
            for (std::uint32_t column = 0; column < lattice.columns(); column += size) {
                division.add({.sheet = sheet, .row = row, .column = column, .size = size});
            }
        }
    }
    return cells;
}

std::vector<MapCellPoint> quarters_of(const MapCell& cell,
                                      const MapLattice& lattice,
                                      const AirTest& air) {
    std::vector<MapCellPoint> cells;
    Division(lattice, air, cells).add_quarters(cell);
    return cells;
}

std::vector<std::uint32_t> cell_numbers(const MapLattice& lattice,
                                        std::span<const MapCellPoint> cells) {
    const std::size_t per_sheet = std::size_t{lattice.columns()} * lattice.rows();
    std::vector<std::uint32_t> numbers(lattice.sheets() * per_sheet, kNoCell);
    for (std::size_t k = 0; k < cells.size(); ++k) {
        const MapCell& cell = cells[k].cell;
        for (std::uint32_t row = cell.row; row < cell.end_row(lattice); ++row) {
            for (std::uint32_t column = cell.column; column < cell.end_column(lattice); ++column) {
                numbers[cell.sheet * per_sheet + std::size_t{row} * lattice.columns() + column] =
                    static_cast<std::uint32_t>(k);
            }
        }
    }
    return numbers;
}

std::vector<std::size_t> cells_to_halve(const MapLattice& lattice,
                                        std::span<const MapCellPoint> cells,
                                        std::span<const MapValue> values,
                                        std::span<const MapMetric> metrics) {
    if (cells.empty() || metrics.empty()) {
        return {};
    }
    const std::size_t per_cell = values.size() / cells.size();
    const auto values_of = [&](std::size_t k) { return values.subspan(k * per_cell, per_cell); };
    const std::vector<std::uint32_t> numbers = cell_numbers(lattice, cells);
    std::vector<std::uint8_t> is_halved(cells.size(), 0);
    const auto compare = [&](std::uint32_t a, std::uint32_t b) {
        const bool can_be_halved = a != b && a != kNoCell && b != kNoCell &&
                                   ((cells[a].cell.size > 1 && is_halved[a] == 0) ||
                                    (cells[b].cell.size > 1 && is_halved[b] == 0));
        if (can_be_halved && differ(values_of(a), values_of(b), metrics)) {
            is_halved[a] = cells[a].cell.size > 1 ? 1 : 0;
            is_halved[b] = cells[b].cell.size > 1 ? 1 : 0;
        }
    };
    const std::size_t columns = lattice.columns();
    for (std::size_t i = 0; i < numbers.size(); ++i) {
        const std::size_t column = i % columns;
        const std::size_t row = i / columns % lattice.rows();
        if (column + 1 < columns) {
            compare(numbers[i], numbers[i + 1]);
        }
        if (row + 1 < lattice.rows()) {
            compare(numbers[i], numbers[i + columns]);
        }
    }
    std::vector<std::size_t> halved;
    for (std::size_t k = 0; k < cells.size(); ++k) {
        if (is_halved[k] != 0) {
            halved.push_back(k);
        }
    }
    return halved;
}

}  // namespace earshot::propagation
