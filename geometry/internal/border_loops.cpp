// SPDX-License-Identifier: MIT
#include "earshot/geometry/internal/border_loops.h"

#include "earshot/geometry/vector.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <limits>
#include <utility>

namespace earshot::geometry {
namespace {

constexpr std::uint32_t kNowhere = std::numeric_limits<std::uint32_t>::max();

double squared_distance(const Vec3& point, const Vec3& from, const Vec3& to) noexcept {
    const Vec3 along = to - from;
    const double length_squared = glm::dot(along, along);
    const double t = length_squared > 0.0 ? glm::dot(point - from, along) / length_squared : 0.0;
    const Vec3 rest = point - (from + glm::clamp(t, 0.0, 1.0) * along);
    return glm::dot(rest, rest);
}

/// The vertex farthest from `point`, the smallest of several.
std::size_t farthest_from(const Vec3& point, const std::vector<Vec3>& polygon) noexcept {
    std::size_t best = 0;
    double best_distance = -1.0;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Vec3 rest = polygon[i] - point;
        const double distance = glm::dot(rest, rest);
        if (distance > best_distance ||
            (distance == best_distance && lexicographic_less(polygon[i], polygon[best]))) {
            best = i;
            best_distance = distance;
        }
    }
    return best;
}

struct Farthest {
    std::size_t index = 0;
    double squared = -1.0;
};

/// Of the vertices strictly between two indices, the farthest from the segment that joins them.
/// Indices run past the end, to go round.
Farthest farthest_between(const std::vector<Vec3>& polygon, std::size_t begin, std::size_t end) {
    const std::size_t n = polygon.size();
    Farthest farthest;
    for (std::size_t i = begin + 1; i < end; ++i) {
        const double squared =
            squared_distance(polygon[i % n], polygon[begin % n], polygon[end % n]);
        if (squared > farthest.squared) {
            farthest = {i, squared};
        }
    }
    return farthest;
}

/// Indices of the corners, ascending from `start`, which is one of them, as is `middle`.
std::vector<std::size_t> split_chains(const std::vector<Vec3>& polygon,
                                      std::size_t start,
                                      std::size_t middle,
                                      double limit) {
    const std::size_t end = start + polygon.size();
    std::vector<std::size_t> corners{start};
    std::vector<std::size_t> chain_ends{end, middle};  // those still to reach, the nearest last
    while (!chain_ends.empty()) {
        const Farthest farthest = farthest_between(polygon, corners.back(), chain_ends.back());
        if (farthest.squared > limit) {
            chain_ends.push_back(farthest.index);
        } else {
            corners.push_back(chain_ends.back());
            chain_ends.pop_back();
        }
    }
    corners.pop_back();  // the start again
    return corners;
}

/// Splitting takes any vertex of a run parallel to its chord for a corner; those go here.
void remove_straight_corners(const std::vector<Vec3>& polygon,
                             std::vector<std::size_t>& corners,
                             double limit) {
    for (bool has_changed = true; has_changed && corners.size() > 3;) {
        has_changed = false;
        for (std::size_t i = 0; i < corners.size() && corners.size() > 3;) {
            const std::size_t k = corners.size();
            const std::size_t before = corners[(i + k - 1) % k];
            std::size_t after = corners[(i + 1) % k];
            after += after < before ? polygon.size() : 0;
            if (farthest_between(polygon, before, after).squared > limit) {
                ++i;
                continue;
            }
            corners.erase(corners.begin() + static_cast<std::ptrdiff_t>(i));
            has_changed = true;
        }
    }
}

}  // namespace

namespace {

/// Without negative zeros, from the smallest vertex on.
Loop normalised(Loop loop) {
    for (Vec3& vertex : loop) {
        vertex += 0.0;  // -0 becomes 0
    }
    std::rotate(
        loop.begin(), std::min_element(loop.begin(), loop.end(), lexicographic_less), loop.end());
    return loop;
}

}  // namespace

Loop corners_of(const std::vector<Vec3>& polygon, double tolerance) {
    if (polygon.size() == 3) {
        return normalised(polygon);
    }
    // The farthest vertex from any point is a corner of the convex hull. The smallest vertex and
    // the ones found from it are the same wherever the loop began.
    const Vec3 smallest = *std::min_element(polygon.begin(), polygon.end(), lexicographic_less);
    const std::size_t start = farthest_from(smallest, polygon);
    std::size_t middle = farthest_from(polygon[start], polygon);
    middle += middle < start ? polygon.size() : 0;
    const double limit = tolerance * tolerance;
    std::vector<std::size_t> corners = split_chains(polygon, start, middle, limit);
    if (corners.size() < 3) {  // a sliver
        const Farthest one = farthest_between(polygon, start, middle);
        const Farthest other = farthest_between(polygon, middle, start + polygon.size());
        corners.push_back(one.squared >= other.squared ? one.index : other.index);
        std::sort(corners.begin(), corners.end());
    }
    remove_straight_corners(polygon, corners, limit);

    Loop loop;
    loop.reserve(corners.size());
    for (const std::size_t corner : corners) {
        loop.push_back(polygon[corner % polygon.size()]);
    }
    return normalised(std::move(loop));
}

BorderWalk::BorderWalk(std::span<const Triangle> triangles,
                       std::span<const HalfEdgeId> twins,
                       std::span<const FacetId> of_triangle,
                       std::size_t vertex_count)
    : triangles_(triangles),
      twins_(twins),
      of_triangle_(of_triangle),
      walked_(twins.size(), false),
      place_(vertex_count, kNowhere) {}

bool BorderWalk::is_border(HalfEdgeId h) const noexcept {
    const HalfEdgeId twin = twins_[h];
    return twin == kNoHalfEdge || of_triangle_[triangle_of(twin)] != of_triangle_[triangle_of(h)];
}

std::vector<std::vector<VertexId>> BorderWalk::loops(std::span<const TriangleId> members) {
    std::vector<std::vector<VertexId>> found;
    for (const TriangleId triangle : members) {
        for (HalfEdgeId h = 3 * triangle; h < 3 * triangle + 3; ++h) {
            if (!walked_[h] && is_border(h)) {
                trace(h, found);
            }
        }
    }
    return found;
}

void BorderWalk::trace(HalfEdgeId first, std::vector<std::vector<VertexId>>& loops) {
    path_.clear();
    const auto cut_off_from = [&](std::size_t begin) {
        if (path_.size() - begin >= 3) {
            loops.emplace_back(path_.begin() + static_cast<std::ptrdiff_t>(begin), path_.end());
        }
        for (std::size_t i = begin; i < path_.size(); ++i) {
            place_[path_[i]] = kNowhere;
        }
        path_.resize(begin);
    };
    HalfEdgeId h = first;
    do {
        // Where the border touches itself, what lies between the two visits is a loop of its own.
        const VertexId vertex = start_of(triangles_, h);
        if (place_[vertex] != kNowhere) {
            cut_off_from(place_[vertex]);
        }
        place_[vertex] = static_cast<std::uint32_t>(path_.size());
        path_.push_back(vertex);
        walked_[h] = true;
        // Turn about the end through the facet's triangles: the border of the same sector.
        h = next_in_triangle(h);
        while (!is_border(h)) {
            h = next_in_triangle(twins_[h]);
        }
    } while (h != first);
    cut_off_from(0);
}

}  // namespace earshot::geometry
