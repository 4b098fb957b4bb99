// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/frustum/internal/box_search.h"
#include "earshot/frustum/path_arrivals.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace earshot::frustum {

/// The images of a source for a listener, in a box whose walls are coordinate planes. There,
/// mirroring changes one coordinate and no other, so the coordinates of all images come from one
/// short table per axis, and whether a line passes an edge is a question of two axes.
class BoxArrivals {
public:
    /// Preconditions: the room is straight, and the points are contained in the lattice.
    BoxArrivals(const BoxLattice& lattice,
                const geometry::Vec3& source,
                const geometry::Vec3& listener);

    /// False: the pair must be left to frusta.
    bool is_complete() const noexcept { return is_complete_; }
    std::span<const double> lengths() const noexcept { return lengths_; }
    PathArrival at(std::size_t i, bool name_facets);

private:
    /// A path. Most are known by their cell alone; those near edges have been constructed.
    struct Image {
        double length = 0.0;
        std::int32_t order = 0;
        std::int32_t constructed = -1;  ///< index into the search's paths
        std::array<std::int8_t, 3> cell{};
    };

    void make_coordinates(std::size_t axis);
    void find_edges(std::size_t a, std::size_t b);
    void find_images();
    void add(const Cell& cell, double squared);
    void sort();
    void sort_by_length();
    void sort_equals(std::size_t begin, std::size_t end);
    bool passes_edge(const Cell& cell) const noexcept;
    geometry::Vec3 last_reflection(const Image& image) const;
    /// Place in the tables of the images that an axis mirrors `number` times, as in a Cell.
    std::size_t column(int number) const noexcept {
        return static_cast<std::size_t>(number + max_order_);
    }

    const BoxLattice& lattice_;
    BoxLattice::Search search_;
    int max_order_;
    std::size_t columns_;
    bool is_complete_ = true;
    std::array<int, 3> component_{};                 ///< of positions, per axis of the room
    std::array<std::vector<double>, 3> coordinate_;  ///< per axis: of the image, by column
    std::array<std::vector<double>, 3> squared_;     ///< of the distance along the axis, likewise
    /// Per pair of axes (the one that is left out): whether the line of two columns passes an edge.
    std::array<std::vector<std::uint8_t>, 3> passes_edge_;
    std::vector<Image> images_;
    /// Per axis, by column: where the line from the listener crosses the first wall, from 0 to 1 at
    /// the image; 2 if it crosses none.
    std::array<std::vector<double>, 3> first_crossing_;
    std::vector<double> lengths_;
};

}  // namespace earshot::frustum
