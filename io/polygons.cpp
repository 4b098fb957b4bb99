// SPDX-License-Identifier: MIT
#include "earshot/io/internal/polygons.h"

#include "earshot/base/error.h"

#include <glm/geometric.hpp>

#include <cmath>

namespace earshot::io {
namespace {

using geometry::Triangle;
using geometry::Vec3;
using geometry::VertexId;

struct Point {
    double x = 0.0;
    double y = 0.0;
    friend bool operator==(const Point&, const Point&) = default;
};

/// Twice the signed area of a triangle: positive where its corners run counter-clockwise.
double twice_signed_area(const Point& a, const Point& b, const Point& c) noexcept {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// Newell: the area vector of a closed polygon, planar or not, relative to its first corner.
Vec3 area_vector(std::span<const Vec3> positions, std::span<const VertexId> corners) {
    const Vec3 origin = positions[corners[0]];
    Vec3 sum(0.0);
    for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
        sum += glm::cross(positions[corners[i]] - origin, positions[corners[i + 1]] - origin);
    }
    return sum;
}

/// The polygon projected along the largest axis of its area vector, wound counter-clockwise.
std::vector<Point> projected(std::span<const Vec3> positions, std::span<const VertexId> corners) {
    const Vec3 area = area_vector(positions, corners);
    const Vec3 size = glm::abs(area);
    int axis = size.x >= size.y && size.x >= size.z ? 0 : 1;
    axis = size.z > size.x && size.z > size.y ? 2 : axis;
    const int first = (axis + 1) % 3;
    const int second = (axis + 2) % 3;
    std::vector<Point> points;
    points.reserve(corners.size());
    for (const VertexId corner : corners) {
        const Vec3& p = positions[corner];
        points.push_back(area[axis] < 0.0 ? Point{p[second], p[first]}
                                          : Point{p[first], p[second]});
    }
    return points;
}

/// Triangulation by ear clipping (Meisters 1975). Corners are indices into `points`.
class EarCutter {
public:
    explicit EarCutter(std::vector<Point> points) : points_(std::move(points)) {
        for (std::size_t i = 0; i < points_.size(); ++i) {
            remaining_.push_back(i);
        }
    }

    std::size_t corner_count() const noexcept { return remaining_.size(); }

    /// Cuts the first ear at or after position `start`; any corner where there is none.
    std::array<std::size_t, 3> cut(std::size_t& start) {
        std::size_t position = start % remaining_.size();
        for (std::size_t tried = 0; tried < remaining_.size() && !is_ear(position); ++tried) {
            position = (position + 1) % remaining_.size();
        }
        const std::array<std::size_t, 3> ear{
            before(position), remaining_[position], after(position)};
        remaining_.erase(remaining_.begin() + static_cast<std::ptrdiff_t>(position));
        start = position;
        return ear;
    }

private:
    std::size_t before(std::size_t position) const {
        return remaining_[(position + remaining_.size() - 1) % remaining_.size()];
    }
    std::size_t after(std::size_t position) const {
        return remaining_[(position + 1) % remaining_.size()];
    }

    bool is_ear(std::size_t position) const {
        const Point& a = points_[before(position)];
        const Point& b = points_[remaining_[position]];
        const Point& c = points_[after(position)];
        if (!(twice_signed_area(a, b, c) > 0.0)) {
            return false;
        }
        for (const std::size_t other : remaining_) {
            const Point& p = points_[other];
            if (!(p == a) && !(p == b) && !(p == c) && twice_signed_area(a, b, p) >= 0.0 &&
                twice_signed_area(b, c, p) >= 0.0 && twice_signed_area(c, a, p) >= 0.0) {
                return false;
            }
        }
        return true;
    }

    std::vector<Point> points_;
    std::vector<std::size_t> remaining_;
};

}  // namespace

void add_polygon(PolygonMesh& mesh,
                 std::span<const std::int64_t> corners,
                 const std::string& file,
                 const std::string& face) {
    if (corners.size() > kMaxPolygonCorners) {
        throw Error(file,
                    face + " has " + std::to_string(corners.size()) + " corners",
                    "split it into faces of at most " + std::to_string(kMaxPolygonCorners));
    }
    std::array<VertexId, kMaxPolygonCorners> vertices;  // the first corners.size() are set
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const auto count = static_cast<std::int64_t>(mesh.mesh.positions.size());
        if (corners[i] < 0 || corners[i] >= count) {
            throw Error(file,
                        face + ": vertex index " + std::to_string(corners[i]) + " is not in 0.." +
                            std::to_string(count - 1),
                        "export the file again");
        }
        vertices[i] = static_cast<VertexId>(corners[i]);
    }
    triangulate(
        mesh.mesh.positions, std::span(vertices).first(corners.size()), mesh.mesh.triangles);
}

void triangulate(std::span<const Vec3> positions,
                 std::span<const VertexId> corners,
                 std::vector<Triangle>& triangles) {
    if (corners.size() < 3) {
        return;
    }
    if (corners.size() == 3) {
        triangles.push_back({corners[0], corners[1], corners[2]});
        return;
    }
    EarCutter cutter(projected(positions, corners));
    std::size_t position = 1;
    while (cutter.corner_count() >= 3) {
        const auto [a, b, c] = cutter.cut(position);
        triangles.push_back({corners[a], corners[b], corners[c]});
    }
}

}  // namespace earshot::io
