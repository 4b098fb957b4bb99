// SPDX-License-Identifier: MIT
#include "earshot/propagation/map_limit.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace earshot::propagation {

namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// Interpolates between the points of cells of different sizes.
class Interpolation {
public:
    Interpolation(const MetricMap& map, std::size_t source, std::size_t metric)
        : map_(map),
          source_(source),
          metric_(metric),
          numbers_(cell_numbers(map.lattice, map.cells)) {}

    std::vector<double> values() const {
        const MapLattice& lattice = map_.lattice;
        std::vector<double> values(numbers_.size(), kNone);
        const std::size_t per_sheet = std::size_t{lattice.columns()} * lattice.rows();
        for (std::size_t i = 0; i < values.size(); ++i) {
            if (numbers_[i] != kNoCell) {
                const std::size_t in_sheet = i % per_sheet;
                values[i] = value_at(i - in_sheet,
                                     static_cast<std::uint32_t>(in_sheet % lattice.columns()),
                                     static_cast<std::uint32_t>(in_sheet / lattice.columns()));
            }
        }
        return values;
    }

private:
    /// The middle of a cell, in cells of the lattice.
    double centre(std::uint32_t begin, std::uint32_t end) const { return 0.5 * (begin + end); }

    /// The mean of the cells about a point, each with the product of two tents about its middle, as
    /// wide as the larger one of it and the point's own cell: that is bilinear interpolation where
    /// cells are equally large.
    double value_at(std::size_t first_of_sheet, std::uint32_t column, std::uint32_t row) const {
        const MapLattice& lattice = map_.lattice;
        const std::uint32_t own = number_at(first_of_sheet, column, row);
        const MapCell& own_cell = map_.cells[own].cell;
        const auto size = static_cast<double>(own_cell.size);
        // Every cell whose tent reaches the point touches the own cell or is its neighbour's
        // neighbour; probes at the distance of the own size and less meet them.
        std::vector<std::uint32_t> found = {own};
        // A cell may be far larger than the lattice.
        const std::uint32_t reach = own_cell.size;
        const auto first = [reach](std::uint32_t at) { return at - std::min(at, reach); };
        const auto last = [reach](std::uint32_t at, std::uint32_t count) {
            return at + std::min(count - 1 - at, reach);
        };
        for (std::uint32_t r = first(row); r <= last(row, lattice.rows()); ++r) {
            for (std::uint32_t c = first(column); c <= last(column, lattice.columns()); ++c) {
                const std::uint32_t number = number_at(first_of_sheet, c, r);
                if (number != kNoCell &&
                    std::find(found.begin(), found.end(), number) == found.end()) {
                    found.push_back(number);
                }
            }
        }
        double sum = 0.0, weights = 0.0;
        for (const std::uint32_t number : found) {
            const auto& value = map_.value(number, source_, metric_).value;
            if (!value) {
                continue;
            }
            const MapCell& cell = map_.cells[number].cell;
            const double width = std::max(size, static_cast<double>(cell.size));
            const double dx = column + 0.5 - centre(cell.column, cell.end_column(lattice));
            const double dz = row + 0.5 - centre(cell.row, cell.end_row(lattice));
            const double weight = std::max(0.0, 1.0 - std::abs(dx) / width) *
                                  std::max(0.0, 1.0 - std::abs(dz) / width);
            sum += weight * *value;
            weights += weight;
        }
        // A cell without a value stays so, whatever is about it.
        return map_.value(own, source_, metric_).value && weights > 0.0 ? sum / weights : kNone;
    }

    std::uint32_t number_at(std::size_t first_of_sheet,
                            std::uint32_t column,
                            std::uint32_t row) const {
        return numbers_[first_of_sheet + std::size_t{row} * map_.lattice.columns() + column];
    }

    const MetricMap& map_;
    std::size_t source_, metric_;
    std::vector<std::uint32_t> numbers_;
};

/// Adds up shares of what meets a limit.
class Shares {
public:
    explicit Shares(const MapLimit& limit) : limit_(limit) {}

    void add(double value, double standard_error) {
        all_ += 1.0;
        if (std::isnan(value)) {
            unknown_ += 1.0;
            return;
        }
        met_ += (limit_.is_minimum ? value >= limit_.value : value <= limit_.value) ? 1.0 : 0.0;
        uncertain_ += std::abs(value - limit_.value) < 2.0 * standard_error ? 1.0 : 0.0;
    }
    void give(MapLimitResult& result) const {
        if (all_ > 0.0) {
            result.share = met_ / all_;
            result.uncertain_share = uncertain_ / all_;
            result.unknown_share = unknown_ / all_;
        }
    }

private:
    const MapLimit& limit_;
    double all_ = 0.0, met_ = 0.0, uncertain_ = 0.0, unknown_ = 0.0;
};

}  // namespace

std::vector<double> interpolated_values(const MetricMap& map,
                                        std::size_t source,
                                        std::size_t metric) {
    return Interpolation(map, source, metric).values();
}

MapLimitResult evaluate_limit(const MetricMap& map, const MapLimit& limit, std::size_t source) {
    MapLimitResult result;
    Shares shares(limit);
    const auto error_of = [&](std::size_t cell) {
        return map.value(cell, source, limit.metric).standard_error.value_or(0.0);
    };
    for (std::size_t cell = 0; cell < map.cells.size(); ++cell) {
        const auto& value = map.value(cell, source, limit.metric).value;
        if (value && (!result.worst ||
                      (limit.is_minimum ? *value < *result.worst : *value > *result.worst))) {
            result.worst = value;
            result.worst_cell = cell;
        }
        if (map.lattice.sheets() == 0 && map.exclusions[cell] == PointExclusion::none) {
            shares.add(value.value_or(kNone), error_of(cell));
        }
    }
    if (map.lattice.sheets() > 0) {
        const std::vector<double> values = interpolated_values(map, source, limit.metric);
        const std::vector<std::uint32_t> numbers = cell_numbers(map.lattice, map.cells);
        for (std::size_t i = 0; i < values.size(); ++i) {
            if (numbers[i] != kNoCell) {
                shares.add(values[i], error_of(numbers[i]));
            }
        }
        result.contours = contour_lines(map.lattice, values, limit.value);
    }
    shares.give(result);
    return result;
}

}  // namespace earshot::propagation
