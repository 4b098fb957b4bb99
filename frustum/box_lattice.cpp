// SPDX-License-Identifier: MIT
#include "earshot/frustum/internal/box_lattice.h"

#include "earshot/frustum/internal/box_search.h"
#include "earshot/frustum/internal/path_order.h"
#include "earshot/frustum/internal/reflection_point.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iterator>
#include <limits>

namespace earshot::frustum {

using geometry::TriangleId;
using geometry::Vec3;

namespace {

/// The most orders of one image's walls that are verified one by one, in a room whose walls are
/// coordinate planes, and in one where the images of different orders differ by rounding. The
/// latter lets up to eight edges or three corners be passed by one path, which takes an order of 12
/// to exceed.
constexpr std::size_t kMaxOrders = 8, kMaxTurnedOrders = 256;
/// Rounding of mirroring and intersecting, per reflection and metre: PathVerifier allows 2^-42 for
/// sixteen.
constexpr double kRoundingPerReflection = 0x1p-48;

}  // namespace

BoxLattice::Search::Search(const BoxLattice& the_lattice,
                           const Vec3& the_source,
                           const Vec3& the_listener)
    : lattice(the_lattice),
      room(the_lattice.room_),
      source(the_source),
      listener(the_listener),
      local_source(room.local(the_source)),
      local_listener(room.local(the_listener)) {}

BoxLattice::BoxLattice(const SceneView& scene,
                       const PathVerifier& verifier,
                       const TraceOptions& options,
                       const BoxRoom& room)
    : scene_(scene),
      verifier_(&verifier),
      options_(options),
      room_(room),
      triangles_{
          {{WallTriangles(scene, room.walls[0][0]), WallTriangles(scene, room.walls[0][1])},
           {WallTriangles(scene, room.walls[1][0]), WallTriangles(scene, room.walls[1][1])},
           {WallTriangles(scene, room.walls[2][0]), WallTriangles(scene, room.walls[2][1])}}} {
    double largest = 0.0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        largest = std::max(largest, room.size(axis));
        diagonal_ += room.size(axis);
    }
    // The verifier's rules for layers of one surface reach as far as the tolerance, and outlines
    // leave out vertices within the tolerance.
    max_length_ = std::min(options.max_length, largest * (options.max_order + 1) + diagonal_);
    const double slack = verifier.rounding_slack(max_length_);
    border_ = kLatticeSafety * (scene.facets.tolerance + 2.0 * room.error + slack);
    min_height_ = kLatticeSafety * (kGrazingSlacks * slack + room.error +
                                    image_error(options.max_order, max_length_));
}

std::optional<BoxLattice> BoxLattice::make(const SceneView& scene,
                                           const PathVerifier& verifier,
                                           const TraceOptions& options) {
    const auto room = find_box_room(scene);
    return room ? std::optional(BoxLattice(scene, verifier, options, *room)) : std::nullopt;
}

// How far an image may lie from the ideal box's: each mirroring in a wall off by `error` and
// `tilt` moves it by twice the distance that the wall is off at the foot of the perpendicular, and
// turns it about that.
double BoxLattice::image_error(int order, double length) const noexcept {
    const double reach = length + diagonal_;
    return order * (2.0 * room_.error + 4.0 * room_.tilt * reach +
                    kRoundingPerReflection * (verifier_->extent() + reach));
}

bool BoxLattice::contains(const Vec3& point) const noexcept {
    const Axes local = room_.local(point);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        if (!(local[axis] >= min_height_ && local[axis] <= room_.size(axis) - min_height_)) {
            return false;
        }
    }
    return true;
}

std::optional<BoxLattice::Paths> BoxLattice::find(const Vec3& source, const Vec3& listener) const {
    Search search(*this, source, listener);
    const int n = options_.max_order;
    for (int x = -n; x <= n; ++x) {
        const int left = n - std::abs(x);
        for (int y = -left; y <= left; ++y) {
            const int rest = left - std::abs(y);
            for (int z = -rest; z <= rest; ++z) {
                if (!search.visit({x, y, z})) {
                    return std::nullopt;
                }
            }
        }
    }
    return std::move(search.result);
}

double BoxLattice::Search::image(std::size_t axis, int number) const noexcept {
    return number % 2 == 0 ? number * room.size(axis) + local_source[axis]
                           : (number + 1) * room.size(axis) - local_source[axis];
}

void BoxLattice::Search::set_cell(const Cell& the_cell) {
    cell = the_cell;
    order = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        order += static_cast<std::size_t>(std::abs(cell[axis]));
        distance[axis] = std::abs(image(axis, cell[axis]) - local_listener[axis]);
    }
}

bool BoxLattice::Search::visit(const Cell& the_cell) {
    set_cell(the_cell);
    const double length = std::sqrt(distance[0] * distance[0] + distance[1] * distance[1] +
                                    distance[2] * distance[2]);
    const double error = lattice.image_error(static_cast<int>(order), length);
    if (length - error > lattice.options_.max_length) {
        return true;
    }
    for (std::size_t axis = 0; axis < 3; ++axis) {
        border[axis] = lattice.border_ + kLatticeSafety * error * (1.0 + length / distance[axis]);
    }
    find_crossings();
    make_sequence();
    return construct() || decide_at_edges();
}

// Merges the crossings of the three axes, which are evenly spaced.
void BoxLattice::Search::find_crossings() {
    constexpr double kNone = std::numeric_limits<double>::infinity();
    Axes next{}, step{};
    std::array<int, 3> left{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        left[axis] = std::abs(cell[axis]);
        const double first =
            cell[axis] > 0 ? room.size(axis) - local_listener[axis] : local_listener[axis];
        const double per_metre = 1.0 / distance[axis];
        next[axis] = left[axis] > 0 ? first * per_metre : kNone;
        step[axis] = room.size(axis) * per_metre;
    }
    for (std::size_t i = 0; i < order; ++i) {
        std::size_t axis = next[1] < next[0] ? 1 : 0;
        axis = next[2] < next[axis] ? 2 : axis;
        crossings[i] = {.t = next[axis], .axis = static_cast<int>(axis)};
        next[axis] = --left[axis] > 0 ? next[axis] + step[axis] : kNone;
    }
}

// The walls from the listener on: those of one axis take turns.
void BoxLattice::Search::make_sequence() {
    std::array<std::size_t, 3> side = {
        cell[0] > 0 ? 1U : 0U, cell[1] > 0 ? 1U : 0U, cell[2] > 0 ? 1U : 0U};
    for (std::size_t i = 0; i < order; ++i) {
        const auto axis = static_cast<std::size_t>(crossings[i].axis);
        sequence[order - 1 - i] = room.walls[axis][side[axis]];
        side[axis] = 1 - side[axis];
    }
}

void BoxLattice::Search::make_images() {
    const auto& facets = lattice.scene_.facets.facets;
    images[0] = source;
    for (std::size_t i = 0; i < order; ++i) {
        images[i + 1] = facets[sequence[i]].plane.mirror(images[i]);
    }
}

// As CandidateGenerator::within_limits().
bool BoxLattice::Search::within_limits(double length) const {
    const TraceOptions& options = lattice.options_;
    double factor = 1.0;
    if (options.min_pressure > 0.0 && !lattice.scene_.max_pressure_factor.empty()) {
        for (std::size_t i = 0; i < order; ++i) {
            factor *= lattice.scene_.max_pressure_factor[sequence[i]];
        }
    }
    return length <= options.max_length && !(factor < options.min_pressure * length);
}

// Constructs the path of the sequence. True: its points are all so far inside of their walls that
// PathVerifier accepts it, and no other order of its walls: no leg touches another wall, and every
// other order would put a point beyond the border of its wall. (Or it is beyond the limits.)
bool BoxLattice::Search::construct() {
    make_images();
    const auto& facets = lattice.scene_.facets.facets;
    const double length = glm::distance(images[order], listener);
    const double slack = lattice.verifier_->rounding_slack(length);
    std::array<std::size_t, 3> side = {
        cell[0] > 0 ? 1U : 0U, cell[1] > 0 ? 1U : 0U, cell[2] > 0 ? 1U : 0U};
    Vec3 target = listener;
    for (std::size_t i = 0; i < order; ++i) {
        const std::size_t k = order - 1 - i;
        const auto axis = static_cast<std::size_t>(crossings[i].axis);
        const auto reflection =
            find_reflection(facets[sequence[k]].plane, images[k], images[k + 1], target, slack);
        if (!reflection) {
            return false;
        }
        target = reflection->point;
        const Axes local = room.local(target);
        for (const std::size_t other : {(axis + 1) % 3, (axis + 2) % 3}) {
            if (!(local[other] >= border[axis] &&
                  local[other] <= room.size(other) - border[axis])) {
                return false;
            }
        }
        const auto triangle = lattice.triangles_[axis][side[axis]].at(target);
        if (!triangle) {
            return false;
        }
        side[axis] = 1 - side[axis];
        points[k] = target;
        triangles[k] = *triangle;
    }
    ++result.candidates;
    if (!within_limits(length)) {
        return true;
    }
    SpecularPath& path = result.paths.emplace_back();
    path.length = length;
    path.triangles.assign(triangles.begin(),
                          triangles.begin() + static_cast<std::ptrdiff_t>(order));
    path.points.reserve(order + 2);
    path.points.push_back(source);
    path.points.insert(
        path.points.end(), points.begin(), points.begin() + static_cast<std::ptrdiff_t>(order));
    path.points.push_back(listener);
    return true;
}

// Whether two crossings that follow each other may do so the other way around: where the line
// crosses one plane, it is close to the other.
bool BoxLattice::Search::may_be_at_edge(const Crossing& a, const Crossing& b) const {
    const auto i = static_cast<std::size_t>(a.axis), j = static_cast<std::size_t>(b.axis);
    const double gap = b.t - a.t;
    return i != j && (gap * distance[j] <= 2.0 * border[i] || gap * distance[i] <= 2.0 * border[j]);
}

/// Runs of crossings whose order is uncertain, as ranges.
std::vector<BoxLattice::Search::Cluster> BoxLattice::Search::clusters() const {
    std::vector<Cluster> found;
    for (std::size_t i = 0; i + 1 < order; ++i) {
        if (!may_be_at_edge(crossings[i], crossings[i + 1])) {
            continue;
        }
        if (!found.empty() && found.back().second == i + 1) {
            ++found.back().second;
        } else {
            found.emplace_back(i, i + 2);
        }
    }
    return found;
}

void BoxLattice::Search::verify(std::vector<SpecularPath>& found) {
    make_sequence();
    make_images();
    if (!within_limits(glm::distance(images[order], listener))) {
        return;
    }
    ++result.candidates;
    auto path = lattice.verifier_->verify(
        std::span(sequence).first(order), std::span(images).first(order + 1), listener);
    if (path) {
        found.push_back(std::move(*path));
    }
}

std::span<Crossing> BoxLattice::Search::crossings_of(const Cluster& cluster) {
    return std::span(crossings).subspan(cluster.first, cluster.second - cluster.first);
}

// False: the pair must be left to frusta.
bool BoxLattice::Search::decide_at_edges() {
    const std::vector<Cluster> uncertain = clusters();
    const auto by_axis = [](const Crossing& a, const Crossing& b) { return a.axis < b.axis; };
    const auto ideal = crossings;
    for (const Cluster& cluster : uncertain) {
        std::ranges::sort(crossings_of(cluster), by_axis);
    }
    // Like an odometer, whose digits are the orders of the clusters.
    const auto next_order = [&] {
        return std::ranges::any_of(uncertain, [&](const Cluster& cluster) {
            const auto range = crossings_of(cluster);
            return std::next_permutation(range.begin(), range.end(), by_axis);
        });
    };
    std::vector<SpecularPath> found;
    std::size_t tried = 0;
    do {
        if (++tried > kMaxTurnedOrders) {
            return false;
        }
        if (room.is_straight() && tried > kMaxOrders) {
            crossings = ideal;
            return take_lowest_order(uncertain);
        }
        verify(found);
    } while (next_order());
    sort_and_deduplicate(found, lattice.scene_.facets, lattice.verifier_->extent());
    std::move(found.begin(), found.end(), std::back_inserter(result.paths));
    return true;
}

// Where several edges are passed exactly, every combination of orders makes the same path, and the
// one of the lowest triangle list is the one that reflects at each edge from the lower triangle
// first. False: the pair must be left to frusta.
bool BoxLattice::Search::take_lowest_order(std::span<const Cluster> uncertain) {
    std::vector<SpecularPath> found;
    verify(found);
    if (found.empty() || found.front().triangles.size() != order) {
        return false;
    }
    std::vector<TriangleId> lowest = found.front().triangles;
    for (const Cluster& cluster : uncertain) {
        // Crossings count from the listener, triangles from the source.
        const auto range = crossings_of(cluster);
        std::vector<std::pair<TriangleId, Crossing>> keyed;
        for (std::size_t i = 0; i < range.size(); ++i) {
            for (std::size_t k = 0; k < i; ++k) {
                if (range[k].axis == range[i].axis) {
                    return false;
                }
            }
            keyed.emplace_back(lowest[order - 1 - (cluster.first + i)], range[i]);
        }
        std::ranges::sort(keyed, std::ranges::greater{}, &std::pair<TriangleId, Crossing>::first);
        for (std::size_t i = 0; i < range.size(); ++i) {
            lowest[order - 1 - (cluster.first + i)] = keyed[i].first;
            range[i] = keyed[i].second;
        }
    }
    verify(found);
    const auto path = std::ranges::min_element(found, {}, &SpecularPath::triangles);
    result.paths.push_back(std::move(*path));
    return true;
}

}  // namespace earshot::frustum
