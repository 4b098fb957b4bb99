// SPDX-License-Identifier: MIT
#include "earshot/frustum/internal/box_arrivals.h"

#include "earshot/base/assert.h"
#include "earshot/frustum/internal/reflection_point.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <numeric>
#include <utility>

namespace earshot::frustum {

using geometry::FacetId;
using geometry::Vec3;

namespace {

/// The coordinate that varies along a coordinate axis.
int component_of(const Vec3& axis) noexcept {
    return axis.x != 0.0 ? 0 : axis.y != 0.0 ? 1 : 2;
}

/// Whether start + t slope is within `distance` of a whole number, for one of the t.
bool comes_close_to_whole(double start,
                          double slope,
                          std::span<const double> all_t,
                          double distance) noexcept {
    constexpr double kRound = 0x1.8p52;  // adding it rounds numbers below 2^51 to whole ones
    bool is_close = false;
    for (const double t : all_t) {
        const double position = start + t * slope;
        const double whole = (position + kRound) - kRound;
        is_close |= std::abs(position - whole) <= distance;
    }
    return is_close;
}

}  // namespace

BoxArrivals::BoxArrivals(const BoxLattice& lattice, const Vec3& source, const Vec3& listener)
    : lattice_(lattice),
      search_(lattice, source, listener),
      max_order_(lattice.options_.max_order),
      columns_(static_cast<std::size_t>(2 * max_order_ + 1)) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
        make_coordinates(axis);
        passes_edge_[axis].assign(columns_ * columns_, 0);
    }
    for (std::size_t axis = 0; axis < 3; ++axis) {
        find_edges((axis + 1) % 3, (axis + 2) % 3);
        find_edges((axis + 2) % 3, (axis + 1) % 3);
    }
    find_images();
    if (is_complete_) {
        sort();
    }
}

// The image that the high wall mirrored last was mirrored last by the low wall before, and so on.
void BoxArrivals::make_coordinates(std::size_t axis) {
    const auto& facets = lattice_.scene_.facets.facets;
    const auto [low, high] = lattice_.room_.walls[axis];
    const int k = component_of(lattice_.room_.axes[axis]);
    component_[axis] = k;
    std::vector<double>& coordinate = coordinate_[axis];
    coordinate.resize(columns_);
    coordinate[column(0)] = search_.source[k];
    const auto mirror = [&](FacetId wall, int from) {
        Vec3 image = search_.source;
        image[k] = coordinate[column(from)];
        return facets[wall].plane.mirror(image)[k];
    };
    for (int n = 1; n <= max_order_; ++n) {
        coordinate[column(n)] = mirror(high, 1 - n);
        coordinate[column(-n)] = mirror(low, n - 1);
    }
    const double from = search_.local_listener[axis];
    for (int n = -max_order_; n <= max_order_; ++n) {
        const double difference = search_.listener[k] - coordinate[column(n)];
        squared_[axis].push_back(difference * difference);
        const double along = std::abs(search_.image(axis, n) - from);
        const double to_wall = n > 0 ? lattice_.room_.size(axis) - from : from;
        first_crossing_[axis].push_back(n == 0 ? 2.0 : to_wall / along);
    }
}

// Marks the columns of axes a and b for which a reflection by a wall of axis a is closer to a wall
// of axis b than Search::construct() accepts.
void BoxArrivals::find_edges(std::size_t a, std::size_t b) {
    const BoxRoom& room = lattice_.room_;
    const double size = room.size(b);
    const double max_length = lattice_.max_length_;
    const double error = lattice_.image_error(max_order_, max_length);
    std::vector<std::uint8_t>& marks = passes_edge_[3 - a - b];
    for (int i = -max_order_; i <= max_order_; ++i) {
        const int reflections = std::abs(i);
        const double from = search_.local_listener[a];
        const double along = std::abs(search_.image(a, i) - from);
        const double first = i > 0 ? room.size(a) - from : from;
        const double border =
            (lattice_.border_ + kLatticeSafety * error * (1.0 + max_length / along)) / size;
        std::array<double, kMaxLatticeOrder> t{};
        for (int n = 0; n < reflections; ++n) {
            t[static_cast<std::size_t>(n)] = (first + n * room.size(a)) / along;
        }
        const auto crossings = std::span(t).first(static_cast<std::size_t>(reflections));
        const int left = max_order_ - reflections;
        for (int j = -left; j <= left && i != 0; ++j) {
            const double start = search_.local_listener[b] / size;
            const double slope = search_.image(b, j) / size - start;
            if (comes_close_to_whole(start, slope, crossings, border)) {
                const std::size_t row = column(a < b ? i : j), cell = column(a < b ? j : i);
                marks[row * columns_ + cell] = 1;
            }
        }
    }
}

bool BoxArrivals::passes_edge(const Cell& cell) const noexcept {
    const std::size_t x = column(cell[0]), y = column(cell[1]), z = column(cell[2]);
    return (passes_edge_[2][x * columns_ + y] | passes_edge_[1][x * columns_ + z] |
            passes_edge_[0][y * columns_ + z]) != 0;
}

void BoxArrivals::find_images() {
    const auto n = static_cast<std::size_t>(max_order_);
    images_.reserve(columns_ * (2 * n * n + 2 * n + 3) / 3);
    // The axes of the room in the order of coordinates, in which glm::distance adds squares.
    std::array<std::size_t, 3> axis{};
    for (std::size_t k = 0; k < 3; ++k) {
        axis[static_cast<std::size_t>(component_[k])] = k;
    }
    Cell cell{};
    for (int x = -max_order_; x <= max_order_; ++x) {
        const int left = max_order_ - std::abs(x);
        for (int y = -left; y <= left; ++y) {
            const int rest = left - std::abs(y);
            const double squared = squared_[axis[0]][column(x)] + squared_[axis[1]][column(y)];
            cell[axis[0]] = x;
            cell[axis[1]] = y;
            for (int z = -rest; z <= rest && is_complete_; ++z) {
                cell[axis[2]] = z;
                add(cell, squared + squared_[axis[2]][column(z)]);
            }
        }
    }
}

void BoxArrivals::add(const Cell& cell, double squared) {
    if (passes_edge(cell)) {
        const std::size_t before = search_.result.paths.size();
        is_complete_ = search_.visit(cell);
        for (std::size_t i = before; i < search_.result.paths.size(); ++i) {
            const SpecularPath& path = search_.result.paths[i];
            images_.push_back({.length = path.length,
                               .order = static_cast<std::int32_t>(path.triangles.size()),
                               .constructed = static_cast<std::int32_t>(i),
                               .cell = {}});
        }
        return;
    }
    const double length = std::sqrt(squared);
    if (length > lattice_.options_.max_length) {
        return;
    }
    if (lattice_.options_.min_pressure > 0.0) {
        search_.set_cell(cell);
        search_.find_crossings();
        search_.make_sequence();
        if (!search_.within_limits(length)) {
            return;
        }
    }
    images_.push_back({.length = length,
                       .order = std::abs(cell[0]) + std::abs(cell[1]) + std::abs(cell[2]),
                       .constructed = -1,
                       .cell = {static_cast<std::int8_t>(cell[0]),
                                static_cast<std::int8_t>(cell[1]),
                                static_cast<std::int8_t>(cell[2])}});
}

// By length: a radix sort by the upper 33 bits of the positive numbers, whose time grows with the
// count alone; then an insertion sort, which moves only images that agree in these bits.
void BoxArrivals::sort_by_length() {
    constexpr std::size_t kDigits = std::size_t{1} << 11U;
    std::vector<Image> sorted(images_.size());
    for (const unsigned shift : {31U, 42U, 53U}) {
        const auto digit = [&](const Image& image) {
            return std::bit_cast<std::uint64_t>(image.length) >> shift & (kDigits - 1);
        };
        std::array<std::size_t, kDigits> next{};
        for (const Image& image : images_) {
            ++next[digit(image)];
        }
        std::exclusive_scan(next.begin(), next.end(), next.begin(), std::size_t{0});
        for (const Image& image : images_) {
            sorted[next[digit(image)]++] = image;
        }
        images_.swap(sorted);
    }
    const auto comes_first = [](const Image& a, const Image& b) {
        return std::pair(a.length, a.order) < std::pair(b.length, b.order);
    };
    for (std::size_t i = 1; i < images_.size(); ++i) {
        const Image image = images_[i];
        std::size_t k = i;
        for (; k > 0 && comes_first(image, images_[k - 1]); --k) {
            images_[k] = images_[k - 1];
        }
        images_[k] = image;
    }
}

// By length, order and triangles, as sort_and_deduplicate(). There are no duplicates: those of one
// image have been removed, and the images of a box lie apart.
void BoxArrivals::sort() {
    sort_by_length();
    const auto key = [](const Image& image) { return std::pair(image.length, image.order); };
    for (std::size_t begin = 0; begin < images_.size();) {
        std::size_t end = begin + 1;
        while (end < images_.size() && key(images_[end]) == key(images_[begin])) {
            ++end;
        }
        if (end > begin + 1) {
            sort_equals(begin, end);
        }
        begin = end;
    }
    lengths_.reserve(images_.size());
    for (const Image& image : images_) {
        lengths_.push_back(image.length);
    }
}

void BoxArrivals::sort_equals(std::size_t begin, std::size_t end) {
    std::vector<std::pair<std::vector<geometry::TriangleId>, Image>> keyed;
    for (std::size_t i = begin; i < end; ++i) {
        Image image = images_[i];
        if (image.constructed < 0) {
            image.constructed = static_cast<std::int32_t>(search_.result.paths.size());
            is_complete_ =
                search_.visit({image.cell[0], image.cell[1], image.cell[2]}) &&
                search_.result.paths.size() == static_cast<std::size_t>(image.constructed) + 1 &&
                is_complete_;
            if (!is_complete_) {
                return;
            }
        }
        const auto index = static_cast<std::size_t>(image.constructed);
        keyed.emplace_back(search_.result.paths[index].triangles, image);
    }
    std::sort(
        keyed.begin(), keyed.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    for (std::size_t i = begin; i < end; ++i) {
        images_[i] = keyed[i - begin].second;
    }
}

PathArrival BoxArrivals::at(std::size_t i, bool name_facets) {
    const Image& image = images_[i];
    const auto& facets = lattice_.scene_.facets;
    PathArrival arrival{.order = static_cast<std::size_t>(image.order),
                        .last_point = search_.source};
    if (image.constructed >= 0) {
        const SpecularPath& path =
            search_.result.paths[static_cast<std::size_t>(image.constructed)];
        for (std::size_t k = 0; k < path.triangles.size(); ++k) {
            search_.sequence[k] = facets.of_triangle[path.triangles[k]];
        }
        arrival.last_point = path.points[path.points.size() - 2];
    } else if (image.order > 0) {
        arrival.last_point = last_reflection(image);
        if (name_facets) {
            search_.set_cell({image.cell[0], image.cell[1], image.cell[2]});
            search_.find_crossings();
            search_.make_sequence();
        }
    }
    if (name_facets) {
        arrival.facets = std::span(search_.sequence).first(arrival.order);
    }
    return arrival;
}

// The reflection in the wall whose plane the line from the listener crosses first.
Vec3 BoxArrivals::last_reflection(const Image& image) const {
    Vec3 behind(0.0);
    std::size_t last = 0;
    double closest = 2.0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::size_t at = column(image.cell[axis]);
        behind[component_[axis]] = coordinate_[axis][at];
        if (first_crossing_[axis][at] < closest) {
            closest = first_crossing_[axis][at];
            last = axis;
        }
    }
    const int number = image.cell[last];
    Vec3 before = behind;
    before[component_[last]] = coordinate_[last][column(number > 0 ? 1 - number : -1 - number)];
    const FacetId wall = lattice_.room_.walls[last][number > 0 ? 1 : 0];
    const auto reflection = find_reflection(lattice_.scene_.facets.facets[wall].plane,
                                            before,
                                            behind,
                                            search_.listener,
                                            lattice_.verifier_->rounding_slack(image.length));
    EARSHOT_ASSERT(reflection.has_value());
    return reflection ? reflection->point : search_.listener;
}

PathArrivals::PathArrivals(std::unique_ptr<BoxArrivals> arrivals)
    : arrivals_(std::move(arrivals)) {}
PathArrivals::PathArrivals(PathArrivals&&) noexcept = default;
PathArrivals& PathArrivals::operator=(PathArrivals&&) noexcept = default;
PathArrivals::~PathArrivals() = default;

std::span<const double> PathArrivals::lengths() const noexcept {
    return arrivals_->lengths();
}

PathArrival PathArrivals::at(std::size_t i, bool name_facets) {
    return arrivals_->at(i, name_facets);
}

}  // namespace earshot::frustum
