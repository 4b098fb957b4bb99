// SPDX-License-Identifier: MIT
#include "earshot/scenes/rounded_prism.h"

#include "earshot/base/math.h"
#include "earshot/geometry/triangulate.h"

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace earshot::scenes {
namespace {

using Point = glm::dvec2;

constexpr double kQuarterTurn = 1.5707963267948966;

/// A point of the rounded profile and its normal, which points out of the solid.
struct OutlinePoint {
    Point position{0.0};
    Point normal{0.0};
};

Point unit(const Point& v) {
    return v / std::sqrt(v.x * v.x + v.y * v.y);
}

Point right_of(const Point& direction) {
    return {direction.y, -direction.x};
}

int pieces_of(double length, double max_length) {
    return std::max(1, static_cast<int>(std::ceil(length / max_length)));
}

/// The rounded profile, counter-clockwise.
class Outline {
public:
    Outline(const std::vector<Vec2>& profile, const Rounding& rounding) : rounding_(rounding) {
        const std::size_t n = profile.size();
        const auto at = [&](std::size_t i) { return Point(profile[i % n].u, profile[i % n].v); };
        for (std::size_t i = 0; i < n; ++i) {
            add_corner(at(i + n - 1), at(i), at(i + 1));
        }
        divide_straight_pieces();
    }

    const std::vector<OutlinePoint>& points() const { return points_; }

private:
    /// An arc that touches both edges of the corner.
    void add_corner(const Point& before, const Point& corner, const Point& after) {
        const Point in = unit(corner - before);
        const Point out = unit(after - corner);
        const double cross = in.x * out.y - in.y * out.x;
        const double dot = in.x * out.x + in.y * out.y;
        const double half_tangent = std::abs(cross) / (1.0 + dot);  // of half the turn
        const double sense = cross > 0.0 ? 1.0 : -1.0;              // convex, or an inner corner
        const Point start = corner - rounding_.radius * half_tangent * in;
        const Point centre = start - sense * rounding_.radius * right_of(in);
        for (int k = 0; k <= rounding_.pieces; ++k) {
            // Normals turn evenly but for what the chord's division lacks.
            const double share = static_cast<double>(k) / rounding_.pieces;
            const Point normal = unit((1.0 - share) * right_of(in) + share * right_of(out));
            points_.push_back({centre + sense * rounding_.radius * normal, normal});
        }
    }

    void divide_straight_pieces() {
        std::vector<OutlinePoint> divided;
        const auto arc = static_cast<std::size_t>(rounding_.pieces) + 1;
        for (std::size_t i = 0; i < points_.size(); ++i) {
            divided.push_back(points_[i]);
            if (i % arc + 1 != arc) {
                continue;
            }
            const OutlinePoint& end = points_[(i + 1) % points_.size()];
            const Point along = end.position - points_[i].position;
            const int count =
                pieces_of(std::sqrt(along.x * along.x + along.y * along.y), rounding_.max_length);
            for (int k = 1; k < count; ++k) {
                divided.push_back({points_[i].position + static_cast<double>(k) / count * along,
                                   points_[i].normal});
            }
        }
        points_ = std::move(divided);
    }

    Rounding rounding_;
    std::vector<OutlinePoint> points_;
};

/// The outline, drawn in by `inset`, at a place along the prism.
struct Ring {
    double inset = 0.0;
    double along = 0.0;
};

std::vector<Ring> rings_of(double length, const Rounding& rounding) {
    const double radius = rounding.radius / 2.0;
    const int pieces = std::max(1, rounding.pieces / 2);
    std::vector<Ring> first;
    for (int k = 0; k <= pieces; ++k) {
        const double angle = kQuarterTurn * (1.0 - static_cast<double>(k) / pieces);
        first.push_back({radius * (1.0 - cos(angle)), radius * (1.0 - sin(angle))});
    }
    std::vector<Ring> rings = first;
    const double straight = length - 2.0 * radius;
    const int count = pieces_of(straight, rounding.max_length);
    for (int k = 1; k < count; ++k) {
        rings.push_back({0.0, radius + static_cast<double>(k) / count * straight});
    }
    for (auto ring = first.rbegin(); ring != first.rend(); ++ring) {
        rings.push_back({ring->inset, length - ring->along});
    }
    return rings;
}

}  // namespace

Faces rounded_prism(const std::vector<Vec2>& profile,
                    double length,
                    const Frame& frame,
                    std::size_t material,
                    const Rounding& rounding) {
    const Outline outline(profile, rounding);
    const std::vector<OutlinePoint>& points = outline.points();
    const auto flat = [&](std::size_t i, const Ring& ring) {
        return points[i].position - ring.inset * points[i].normal;
    };
    const auto at = [&](std::size_t i, const Ring& ring) {
        const Point p = flat(i, ring);
        return frame.origin + frame.u * p.x + frame.v * p.y + frame.w * ring.along;
    };
    const std::vector<Ring> rings = rings_of(length, rounding);
    Faces faces;
    for (std::size_t r = 0; r + 1 < rings.size(); ++r) {
        for (std::size_t i = 0; i < points.size(); ++i) {
            const std::size_t next = (i + 1) % points.size();
            faces.push_back(
                {{at(i, rings[r]), at(next, rings[r]), at(next, rings[r + 1]), at(i, rings[r + 1])},
                 4,
                 material});
        }
    }
    std::vector<Point> end;
    for (std::size_t i = 0; i < points.size(); ++i) {
        end.push_back(flat(i, rings.front()));
    }
    geometry::IndexLoop loop(points.size());
    std::iota(loop.begin(), loop.end(), std::size_t{0});
    for (const auto& [a, b, c] :
         geometry::triangulate(end, {loop}, geometry::EarOrder::shortest_diagonal)) {
        const Ring& low = rings.front();
        const Ring& high = rings.back();
        faces.push_back({{at(c, low), at(b, low), at(a, low)}, 3, material});
        faces.push_back({{at(a, high), at(b, high), at(c, high)}, 3, material});
    }
    return faces;
}

}  // namespace earshot::scenes
