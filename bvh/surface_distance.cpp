// SPDX-License-Identifier: MIT
#include "earshot/bvh/surface_distance.h"

#include "earshot/base/assert.h"
#include "earshot/bvh/closest_point.h"
#include "earshot/bvh/tree.h"
#include "earshot/geometry/closest_point.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace earshot::bvh {
namespace {

using geometry::Corners;
using geometry::MeshView;
using geometry::TriangleId;
using geometry::Vec3;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// A corner and what is closest to it.
struct Corner {
    Vec3 position{0.0};
    double distance = 0.0;
    TriangleId closest = 0;
};
using Piece = std::array<Corner, 3>;

/// What some triangles came to.
struct Sums {
    double lower = 0.0;
    double upper = 0.0;
    double area = 0.0;
    double squares = 0.0;  // squared distance times area
};

class Measurement {
public:
    Measurement(const MeshView& to, const Tree& tree, double resolution)
        : to_(to), tree_(tree), resolution_(resolution) {}

    Corner corner(const Vec3& position) const {
        const auto found = closest_point(tree_, to_, position);
        return {position, found ? found->distance : kInfinity, found ? found->triangle : 0};
    }

    /// Adds a triangle, halved where need be.
    void add(const Piece& triangle, Sums& sums) {
        stack_.assign(1, triangle);
        while (!stack_.empty()) {
            const Piece piece = stack_.back();
            stack_.pop_back();
            for (const Corner& corner : piece) {
                sums.lower = std::max(sums.lower, corner.distance);
            }
            const double upper = upper_bound(piece, std::max(sums.lower, resolution_));
            if (upper > std::max(sums.lower, resolution_) && bisect(piece)) {
                continue;
            }
            sums.upper = std::max(sums.upper, upper);
            const double area =
                0.5 * glm::length(glm::cross(piece[1].position - piece[0].position,
                                             piece[2].position - piece[0].position));
            sums.area += area;
            for (const Corner& corner : piece) {
                sums.squares += area / 3.0 * corner.distance * corner.distance;
            }
        }
    }

private:
    static std::size_t longest_edge(const Piece& piece) {
        std::size_t longest = 0;
        double squared = -1.0;
        for (std::size_t i = 0; i < 3; ++i) {
            const Vec3 along = piece[(i + 1) % 3].position - piece[i].position;
            if (glm::dot(along, along) > squared) {
                squared = glm::dot(along, along);
                longest = i;
            }
        }
        return longest;
    }

    /// Of the distance from anywhere in the piece; no better than it must be to reach `enough`.
    double upper_bound(const Piece& piece, double enough) const {
        // A point of a triangle is no farther from a corner than the longer edge there, and some
        // corner is within the longest edge / sqrt(3) of it (Jung 1901).
        const std::size_t i = longest_edge(piece);
        const Vec3 along = piece[(i + 1) % 3].position - piece[i].position;
        constexpr double kJung = 0.57735026918962584;  // 1 / sqrt(3), rounded up
        double bound = std::max({piece[0].distance, piece[1].distance, piece[2].distance}) +
                       kJung * std::sqrt(glm::dot(along, along));
        for (std::size_t k = 0; k < 3 && bound > enough; ++k) {
            bound = std::min(bound, distance_to_one(piece, piece[k].closest, bound));
        }
        return bound;
    }

    /// The largest distance of a corner from one triangle, or `limit` if that is less.
    double distance_to_one(const Piece& piece, TriangleId one, double limit) const {
        const auto [a, b, c] = geometry::corners(to_, one);
        double largest = 0.0;
        for (const Corner& corner : piece) {
            double distance = corner.distance;
            if (corner.closest != one) {
                const auto found =
                    geometry::PreparedPoint(corner.position).closest_point(a, b, c, limit);
                distance = found ? found->distance : limit;
            }
            largest = std::max(largest, distance);
        }
        return largest;
    }

    /// False if the longest edge is too short to be halved.
    bool bisect(const Piece& piece) {
        const std::size_t i = longest_edge(piece);
        const Corner& a = piece[i];
        const Corner& b = piece[(i + 1) % 3];
        const Corner& c = piece[(i + 2) % 3];
        const Vec3 along = b.position - a.position;
        if (glm::dot(along, along) <= resolution_ * resolution_) {
            return false;
        }
        const Corner middle = corner(0.5 * (a.position + b.position));
        stack_.push_back({middle, b, c});
        stack_.push_back({a, middle, c});
        return true;
    }

    MeshView to_;
    const Tree& tree_;
    double resolution_;
    std::vector<Piece> stack_;
};

}  // namespace

SurfaceDistance one_sided_distance(const MeshView& from,
                                   const MeshView& to,
                                   double resolution,
                                   Executor& executor) {
    EARSHOT_ASSERT(resolution > 0.0);
    if (from.triangles.empty()) {
        return {};
    }
    if (to.triangles.empty()) {
        return {.lower = kInfinity, .upper = kInfinity, .rms = kInfinity};
    }
    const Tree tree = Tree::build(triangle_boxes(to, executor), {}, executor);
    std::vector<Corner> corners(from.positions.size());
    constexpr std::size_t kGrain = 4096;
    executor.for_each(corners.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        const Measurement measurement(to, tree, resolution);
        for (std::size_t v = begin; v < end; ++v) {
            corners[v] = measurement.corner(from.positions[v]);
        }
    });
    // Every chunk prunes by what it has found itself, so that the answer does not depend on
    // threads.
    std::vector<Sums> sums(chunk_count(from.triangles.size(), kGrain));
    executor.for_each(from.triangles.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        Measurement measurement(to, tree, resolution);
        for (std::size_t t = begin; t < end; ++t) {
            const auto& [a, b, c] = from.triangles[t];
            measurement.add({corners[a], corners[b], corners[c]}, sums[begin / kGrain]);
        }
    });
    SurfaceDistance distance;
    double area = 0.0;
    double squares = 0.0;
    for (const Sums& part : sums) {
        distance.lower = std::max(distance.lower, part.lower);
        distance.upper = std::max(distance.upper, part.upper);
        area += part.area;
        squares += part.squares;
    }
    distance.rms = area > 0.0 ? std::sqrt(squares / area) : 0.0;
    return distance;
}

}  // namespace earshot::bvh
