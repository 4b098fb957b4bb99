// SPDX-License-Identifier: MIT
#include "earshot/propagation/map_limit.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <map>
#include <utility>

namespace earshot::propagation {

using geometry::Vec3;

namespace {

/// An edge between the middles of two neighbouring cells, by the first one's index and its
/// direction: 0 along the row, 1 along the column.
using Edge = std::pair<std::size_t, int>;

/// Finds the lines of one sheet.
class MarchingSquares {
public:
    MarchingSquares(const MapLattice& lattice,
                    std::size_t sheet,
                    std::span<const double> values,
                    double level)
        : lattice_(lattice), sheet_(sheet), values_(values), level_(level) {}

    std::vector<std::vector<Vec3>> lines() {
        for (std::uint32_t row = 0; row + 1 < lattice_.rows(); ++row) {
            for (std::uint32_t column = 0; column + 1 < lattice_.columns(); ++column) {
                add_square(column, row);
            }
        }
        std::vector<std::vector<Vec3>> lines;
        // Open lines first, from their first ends; what is left is closed.
        for (const bool open : {true, false}) {
            for (auto& [edge, others] : neighbours_) {
                const std::size_t ends = open ? 1 : 2;
                if (count(others) == ends) {
                    lines.push_back(follow(edge));
                }
            }
        }
        return lines;
    }

private:
    static constexpr Edge kNoEdge = {static_cast<std::size_t>(-1), 0};
    using Neighbours = std::array<Edge, 2>;

    static std::size_t count(const Neighbours& edges) {
        return (edges[0] != kNoEdge ? 1U : 0U) + (edges[1] != kNoEdge ? 1U : 0U);
    }
    std::size_t index(std::uint32_t column, std::uint32_t row) const {
        return std::size_t{row} * lattice_.columns() + column;
    }

    void add_square(std::uint32_t column, std::uint32_t row) {
        const std::size_t a = index(column, row), b = a + 1;
        const std::size_t d = index(column, row + 1), c = d + 1;
        const std::array<std::size_t, 4> corners = {a, b, c, d};
        const std::array<Edge, 4> edges = {Edge(a, 0), Edge(b, 1), Edge(d, 0), Edge(a, 1)};
        double sum = 0.0;
        std::array<bool, 4> is_above{};
        for (std::size_t i = 0; i < 4; ++i) {
            if (std::isnan(values_[corners[i]])) {
                return;
            }
            sum += values_[corners[i]];
            is_above[i] = values_[corners[i]] >= level_;
        }
        std::array<Edge, 4> crossed{};
        std::size_t crossings = 0;
        for (std::size_t i = 0; i < 4; ++i) {
            if (is_above[i] != is_above[(i + 1) % 4]) {
                crossed[crossings++] = edges[i];
            }
        }
        if (crossings == 2) {
            connect(crossed[0], crossed[1]);
        } else if (crossings == 4) {
            // A saddle: the mean tells which opposite corners are joined.
            const bool joins_first = (0.25 * sum >= level_) == is_above[0];
            connect(crossed[0], crossed[joins_first ? 1 : 3]);
            connect(crossed[2], crossed[joins_first ? 3 : 1]);
        }
    }

    void connect(const Edge& a, const Edge& b) {
        for (const auto& [edge, other] : {std::pair(a, b), std::pair(b, a)}) {
            Neighbours& edges =
                neighbours_.try_emplace(edge, Neighbours{kNoEdge, kNoEdge}).first->second;
            edges[edges[0] == kNoEdge ? 0 : 1] = other;
        }
    }

    /// Takes the line through an edge, which it begins at.
    std::vector<Vec3> follow(const Edge& start) {
        std::vector<Vec3> line = {point_on(start)};
        Edge edge = start;
        for (;;) {
            Neighbours& edges = neighbours_.at(edge);
            const std::size_t way = edges[0] != kNoEdge ? 0 : 1;
            const Edge next = std::exchange(edges[way], kNoEdge);
            if (next == kNoEdge) {
                return line;
            }
            Neighbours& back = neighbours_.at(next);
            back[back[0] == edge ? 0 : 1] = kNoEdge;
            line.push_back(point_on(next));
            edge = next;
        }
    }

    Vec3 middle(std::size_t cell) const {
        const auto column = static_cast<std::uint32_t>(cell % lattice_.columns());
        const auto row = static_cast<std::uint32_t>(cell / lattice_.columns());
        return {lattice_.x_at(column + 0.5),
                lattice_.height(sheet_, column, row),
                lattice_.z_at(row + 0.5)};
    }
    Vec3 point_on(const Edge& edge) const {
        const std::size_t from = edge.first;
        const std::size_t to = edge.second == 0 ? from + 1 : from + lattice_.columns();
        const double share = (level_ - values_[from]) / (values_[to] - values_[from]);
        return middle(from) + share * (middle(to) - middle(from));
    }

    const MapLattice& lattice_;
    std::size_t sheet_;
    std::span<const double> values_;
    double level_;
    std::map<Edge, Neighbours> neighbours_;  // of the crossed edges, ordered
};

}  // namespace

std::vector<std::vector<Vec3>> contour_lines(const MapLattice& lattice,
                                             std::span<const double> values,
                                             double level) {
    const std::size_t per_sheet = std::size_t{lattice.columns()} * lattice.rows();
    std::vector<std::vector<Vec3>> all;
    for (std::size_t sheet = 0; sheet < lattice.sheets(); ++sheet) {
        auto lines =
            MarchingSquares(lattice, sheet, values.subspan(sheet * per_sheet, per_sheet), level)
                .lines();
        std::move(lines.begin(), lines.end(), std::back_inserter(all));
    }
    return all;
}

}  // namespace earshot::propagation
