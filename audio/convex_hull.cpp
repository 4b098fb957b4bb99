// SPDX-License-Identifier: MIT
#include "earshot/audio/internal/convex_hull.h"

#include "earshot/audio/internal/vector3.h"
#include "earshot/base/random.h"

#include <cmath>
#include <optional>

namespace earshot::audio {

namespace {

using Point = std::array<double, 3>;
using Corners = std::array<std::size_t, 3>;

// Points are moved along their radius by up to this factor, each by another amount, so that no four
// lie in one plane: regular grids of directions have many such. It is far above the rounding of a
// height over a triangle, and far below that by which a point 1e-3 away rises over its neighbours.
constexpr double kPerturbation = 1e-8;

std::vector<Point> perturbed(std::span<const Point> points) {
    std::vector<Point> result;
    result.reserve(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
        result.push_back(scaled(points[i], 1.0 + kPerturbation * random(0, 0, i)));
    }
    return result;
}

// The index of the largest value of f(point), the first of equals.
template <class Function>
std::size_t argmax(std::span<const Point> points, const Function& f) {
    std::size_t best = 0;
    double largest = -1.0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const double value = f(points[i]);
        if (value > largest) {
            largest = value;
            best = i;
        }
    }
    return best;
}

// Four points that span a volume, the fourth behind the triangle of the first three.
std::optional<std::array<std::size_t, 4>> first_tetrahedron(std::span<const Point> points,
                                                            double min_height) {
    const Point& a = points[0];
    const std::size_t b = argmax(points, [&](const Point& p) { return length(difference(p, a)); });
    const Point ab = difference(points[b], a);
    const std::size_t c =
        argmax(points, [&](const Point& p) { return length(cross(ab, difference(p, a))); });
    const Point normal = cross(ab, difference(points[c], a));
    const auto height = [&](const Point& p) { return dot(normal, difference(p, a)); };
    const std::size_t d = argmax(points, [&](const Point& p) { return std::abs(height(p)); });
    if (std::abs(height(points[d])) <= min_height * length(normal)) {
        return std::nullopt;
    }
    return height(points[d]) < 0.0 ? std::array{std::size_t{0}, b, c, d}
                                   : std::array{std::size_t{0}, c, b, d};
}

class Quickhull {
public:
    Quickhull(std::span<const Point> points, const std::array<std::size_t, 4>& first)
        : points_(points), face_from_(points.size()) {
        const auto [a, b, c, d] = first;
        // Neighbour k of a face lies across the edge from its corner k to the next.
        faces_ = {{{a, b, c}, {1, 2, 3}},
                  {{b, a, d}, {0, 3, 2}},
                  {{c, b, d}, {0, 1, 3}},
                  {{a, c, d}, {0, 2, 1}}};
        std::vector<std::size_t> others;
        for (std::size_t i = 0; i < points.size(); ++i) {
            if (i != a && i != b && i != c && i != d) {
                others.push_back(i);
            }
        }
        distribute(others, 0);
        for (std::size_t face = 0; face < faces_.size(); ++face) {
            while (faces_[face].alive && !faces_[face].outside.empty()) {
                add_farthest(face);
            }
        }
    }

    std::vector<Corners> triangles() const {
        std::vector<Corners> result;
        for (const Face& face : faces_) {
            if (face.alive) {
                result.push_back(face.corners);
            }
        }
        return result;
    }

private:
    struct Face {
        Corners corners;
        std::array<std::size_t, 3> neighbours;
        std::vector<std::size_t> outside{};  // points in front of it, each with one face only
        bool alive = true;
        bool visible = false;
    };

    double height(const Face& face, std::size_t point) const {
        const Point& a = points_[face.corners[0]];
        return dot(
            cross(difference(points_[face.corners[1]], a), difference(points_[face.corners[2]], a)),
            difference(points_[point], a));
    }

    // Gives each point to the first of the faces from `begin` on that it lies in front of. A point
    // in front of a removed face lies in front of one that replaces it, or inside.
    void distribute(std::span<const std::size_t> points, std::size_t begin) {
        for (const std::size_t point : points) {
            for (std::size_t face = begin; face < faces_.size(); ++face) {
                if (height(faces_[face], point) > 0.0) {
                    faces_[face].outside.push_back(point);
                    break;
                }
            }
        }
    }

    void add_farthest(std::size_t face) {
        std::size_t apex = 0;
        double largest = -1.0;
        for (const std::size_t point : faces_[face].outside) {
            const double value = height(faces_[face], point);
            if (value > largest) {
                largest = value;
                apex = point;
            }
        }
        // The faces that the apex lies in front of are connected.
        std::vector<std::size_t> visible{face};
        faces_[face].visible = true;
        for (std::size_t next = 0; next < visible.size(); ++next) {
            for (const std::size_t neighbour : faces_[visible[next]].neighbours) {
                if (!faces_[neighbour].visible && height(faces_[neighbour], apex) > 0.0) {
                    faces_[neighbour].visible = true;
                    visible.push_back(neighbour);
                }
            }
        }
        replace(visible, apex);
    }

    // Replaces the visible faces by a cone from their border to the apex.
    void replace(std::span<const std::size_t> visible, std::size_t apex) {
        const std::size_t begin = faces_.size();
        std::vector<std::size_t> points;
        for (const std::size_t removed : visible) {
            for (std::size_t k = 0; k < 3; ++k) {
                const std::size_t neighbour = faces_[removed].neighbours[k];
                if (faces_[neighbour].visible) {
                    continue;
                }
                const std::size_t from = faces_[removed].corners[k];
                const std::size_t to = faces_[removed].corners[(k + 1) % 3];
                for (std::size_t& back : faces_[neighbour].neighbours) {
                    back = back == removed ? faces_.size() : back;
                }
                face_from_[from] = faces_.size();
                faces_.push_back({{from, to, apex}, {neighbour, 0, 0}});
            }
        }
        for (std::size_t face = begin; face < faces_.size(); ++face) {
            const std::size_t next = face_from_[faces_[face].corners[1]];
            faces_[face].neighbours[1] = next;
            faces_[next].neighbours[2] = face;
        }
        for (const std::size_t removed : visible) {
            Face& face = faces_[removed];
            face.alive = false;
            face.visible = false;
            for (const std::size_t point : face.outside) {
                if (point != apex) {
                    points.push_back(point);
                }
            }
            face.outside = {};
        }
        distribute(points, begin);
    }

    std::span<const Point> points_;
    std::vector<Face> faces_;
    std::vector<std::size_t>
        face_from_;  // per point: the newest face whose border edge begins there
};

}  // namespace

std::vector<Corners> convex_hull(std::span<const Point> points, double min_height) {
    if (points.size() < 4) {
        return {};
    }
    const auto first = first_tetrahedron(points, min_height);
    const std::vector<Point> moved = perturbed(points);
    return first ? Quickhull(moved, *first).triangles() : std::vector<Corners>{};
}

}  // namespace earshot::audio
