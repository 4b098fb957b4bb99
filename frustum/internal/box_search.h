// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/frustum/internal/box_lattice.h"

#include <array>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

namespace earshot::frustum {

inline constexpr std::size_t kMaxLatticeOrder = 64;  ///< of TraceOptions
/// Factor of safety by which all bounds of errors are multiplied.
inline constexpr double kLatticeSafety = 4.0;

/// Numbers along the axes of a BoxRoom.
using Axes = std::array<double, 3>;
/// An image: reflections per axis; negative if the last one is by the low wall.
using Cell = std::array<int, 3>;

/// Where the line to a listener crosses a plane of the lattice.
struct Crossing {
    double t = 0.0;  ///< from the listener, 0, to the image, 1
    int axis = 0;
};

/// The images of one source for one listener, one at a time.
struct BoxLattice::Search {
    Search(const BoxLattice& lattice, const geometry::Vec3& source, const geometry::Vec3& listener);

    /// Adds the paths of an image to the result. False: the pair must be left to frusta.
    bool visit(const Cell& the_cell);
    void set_cell(const Cell& the_cell);
    /// The image along one axis in the ideal box, as a coordinate.
    double image(std::size_t axis, int number) const noexcept;
    void find_crossings();
    void make_sequence();
    bool within_limits(double length) const;
    bool construct();

    const BoxLattice& lattice;
    const BoxRoom& room;
    geometry::Vec3 source, listener;
    Axes local_source, local_listener;
    Paths result;

    // The image at hand.
    Cell cell{};
    std::size_t order = 0;
    Axes distance{};  ///< of the ideal image from the listener, along each axis
    Axes border{};    ///< metres: see may_be_at_edge()
    std::array<Crossing, kMaxLatticeOrder> crossings;
    std::array<geometry::FacetId, kMaxLatticeOrder> sequence;
    std::array<geometry::Vec3, kMaxLatticeOrder + 1> images;
    std::array<geometry::Vec3, kMaxLatticeOrder> points;
    std::array<geometry::TriangleId, kMaxLatticeOrder> triangles;

private:
    using Cluster = std::pair<std::size_t, std::size_t>;

    void make_images();
    bool may_be_at_edge(const Crossing& a, const Crossing& b) const;
    std::vector<Cluster> clusters() const;
    std::span<Crossing> crossings_of(const Cluster& cluster);
    bool decide_at_edges();
    bool take_lowest_order(std::span<const Cluster> uncertain);
    void verify(std::vector<SpecularPath>& found);
};

}  // namespace earshot::frustum
