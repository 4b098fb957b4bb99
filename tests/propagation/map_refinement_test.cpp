// SPDX-License-Identifier: MIT
#include "earshot/propagation/map_refinement.h"

#include <gtest/gtest.h>

#include "map_room.h"
#include <algorithm>
#include <cmath>
#include <functional>

namespace earshot::propagation {
namespace {

using Field = std::function<MapValue(const geometry::Vec3&)>;

/// Refines until no cell is to be refined, as compute_metric_map() does, on values of a formula.
std::vector<MapCellPoint> refined(const MapLattice& lattice,
                                  std::uint32_t size,
                                  const AirTest& air,
                                  const Field& field) {
    const std::vector<MapMetric> metrics = {MapMetric("sti", audio::Bands::octaves())};
    std::vector<MapCellPoint> cells = coarsest_cells(lattice, size, air);
    for (;;) {
        std::vector<MapValue> values;
        for (const MapCellPoint& cell : cells) {
            values.push_back(field(cell.point));
        }
        const auto halved = cells_to_halve(lattice, cells, values, metrics);
        if (halved.empty()) {
            return cells;
        }
        std::vector<MapCellPoint> next;
        for (std::size_t k = 0; k < cells.size(); ++k) {
            if (std::find(halved.begin(), halved.end(), k) == halved.end()) {
                next.push_back(cells[k]);
            } else {
                const auto quarters = quarters_of(cells[k].cell, lattice, air);
                next.insert(next.end(), quarters.begin(), quarters.end());
            }
        }
        cells = next;
    }
}

std::size_t cells_covered(const MapLattice& lattice, const std::vector<MapCellPoint>& cells) {
    std::size_t covered = 0;
    for (const MapCellPoint& cell : cells) {
        covered += std::size_t{cell.cell.end_column(lattice) - cell.cell.column} *
                   (cell.cell.end_row(lattice) - cell.cell.row);
    }
    return covered;
}

struct RefinedRoom : MapRoom {
    MapLattice lattice{MapRectangle{0, 0, 8, 6, 1.2}, 0.25, air};

    std::size_t valid() const {
        return std::size_t{lattice.columns()} * lattice.rows() - lattice.excluded().total();
    }
};

TEST(MapRefinement, CoarseCellsCoverEveryPointInTheAirOnce) {
    const RefinedRoom room;
    for (const std::uint32_t size : {1U, 2U, 8U, 64U}) {
        const auto cells = coarsest_cells(room.lattice, size, room.air);
        const auto numbers = cell_numbers(room.lattice, cells);
        EXPECT_EQ(cells_covered(room.lattice, cells), room.valid());
        for (std::size_t i = 0; i < numbers.size(); ++i) {
            EXPECT_EQ(
                numbers[i] != kNoCell,
                room.lattice.is_valid(
                    0, static_cast<std::uint32_t>(i % 32), static_cast<std::uint32_t>(i / 32)));
        }
        for (const MapCellPoint& cell : cells) {
            EXPECT_EQ(room.air.exclusion_at(cell.point), PointExclusion::none);
            EXPECT_LE(cell.cell.size, size);
        }
    }
}

TEST(MapRefinement, ASmoothFieldKeepsCoarseCells) {
    const RefinedRoom room;
    const auto first = coarsest_cells(room.lattice, 4, room.air);
    // 0.02 per metre: a difference of 0.02 between neighbours, the limit is 0.03.
    const auto cells = refined(room.lattice, 4, room.air, [](const geometry::Vec3& p) {
        return MapValue{.value = 0.5 + 0.02 * p.x};
    });
    EXPECT_EQ(cells.size(), first.size());
}

TEST(MapRefinement, CellsAreHalvedAtAStepAndNowhereElse) {
    const RefinedRoom room;
    const auto cells = refined(room.lattice, 8, room.air, [](const geometry::Vec3& p) {
        return MapValue{.value = p.x < 5.1 ? 0.4 : 0.7};
    });
    EXPECT_EQ(cells_covered(room.lattice, cells), room.valid());
    bool is_coarse_away = false;
    for (const MapCellPoint& cell : cells) {
        const double low = room.lattice.x_at(cell.cell.column);
        const double high = room.lattice.x_at(cell.cell.end_column(room.lattice));
        if (low < 5.1 && high > 5.1) {
            EXPECT_EQ(cell.cell.size, 1U);
        }
        is_coarse_away |= cell.cell.size == 8 && high <= 2.0;
    }
    EXPECT_TRUE(is_coarse_away);
}

TEST(MapRefinement, DifferencesWithinTheirStandardErrorAreLeft) {
    const RefinedRoom room;
    const Field noisy = [](const geometry::Vec3& p) {
        return MapValue{.value = p.x < 5.1 ? 0.40 : 0.44, .standard_error = 0.008};
    };
    const auto first = coarsest_cells(room.lattice, 4, room.air);
    EXPECT_EQ(refined(room.lattice, 4, room.air, noisy).size(), first.size());
    const Field certain = [](const geometry::Vec3& p) {
        return MapValue{.value = p.x < 5.1 ? 0.40 : 0.44, .standard_error = 0.006};
    };
    EXPECT_GT(refined(room.lattice, 4, room.air, certain).size(), first.size());
}

TEST(MapRefinement, ValuesThatAreUnknownHalveNothing) {
    const RefinedRoom room;
    const auto first = coarsest_cells(room.lattice, 4, room.air);
    const auto cells = refined(room.lattice, 4, room.air, [](const geometry::Vec3& p) {
        return p.x < 5.1 ? MapValue{} : MapValue{.value = 0.4};
    });
    EXPECT_EQ(cells.size(), first.size());
}

}  // namespace
}  // namespace earshot::propagation
