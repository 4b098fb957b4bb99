// SPDX-License-Identifier: MIT
#include "support/oracle_facets.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <utility>

namespace earshot::support {

namespace {

using Corners = std::array<Point, 3>;

// Far below every margin that is reported as certain, far above the rounding of extended
// precision: a point on an edge shared by two triangles of a facet must be in one of them.
constexpr Real kSharedEdge = 1e-13L;

Point normal_of(const Corners& t) {
    return glm::cross(t[1] - t[0], t[2] - t[0]);
}

OraclePlane plane_of(const Corners& t) {
    const Point normal = glm::normalize(normal_of(t));
    return {.normal = normal, .offset = glm::dot(normal, t[0] + t[1] + t[2]) / 3.0L};
}

bool has_corner(const Corners& t, const Point& p) {
    return t[0] == p || t[1] == p || t[2] == p;
}

bool share_an_edge(const Corners& a, const Corners& b) {
    return static_cast<int>(has_corner(a, b[0])) + static_cast<int>(has_corner(a, b[1])) +
               static_cast<int>(has_corner(a, b[2])) >=
           2;
}

Real point_segment(const Point& p, const Point& a, const Point& b) {
    const Point ab = b - a;
    const Real length_squared = glm::dot(ab, ab);
    const Real t = length_squared > 0.0L ? glm::dot(p - a, ab) / length_squared : 0.0L;
    return glm::length(p - (a + std::clamp(t, 0.0L, 1.0L) * ab));
}

// The closest points of two segments are either both inside, where the lines are closest, or one
// of them is an end: all five cases are tried.
Real segment_segment(const Point& a, const Point& b, const Point& c, const Point& d) {
    Real closest = std::min({point_segment(a, c, d),
                             point_segment(b, c, d),
                             point_segment(c, a, b),
                             point_segment(d, a, b)});
    const Point u = b - a;
    const Point v = d - c;
    const Point across = glm::cross(u, v);
    const Real scale = glm::dot(across, across);
    if (scale > 0.0L) {
        const Real s = glm::dot(glm::cross(c - a, v), across) / scale;
        const Real t = glm::dot(glm::cross(c - a, u), across) / scale;
        if (s >= 0.0L && s <= 1.0L && t >= 0.0L && t <= 1.0L) {
            closest = std::min(closest, glm::length((a + s * u) - (c + t * v)));
        }
    }
    return closest;
}

bool contains(const Corners& t, const Point& normal, const Point& p) {
    const Real side = glm::dot(normal_of(t), normal) < 0.0L ? -1.0L : 1.0L;
    for (std::size_t i = 0; i < 3; ++i) {
        const Point edge = t[(i + 1) % 3] - t[i];
        const Real area = side * glm::dot(glm::cross(edge, p - t[i]), normal);
        if (area < -kSharedEdge * glm::length(edge)) {
            return false;
        }
    }
    return true;
}

bool contains(const OracleFacet& facet, const Point& p) {
    return std::any_of(facet.triangles.begin(), facet.triangles.end(), [&](const Corners& t) {
        return contains(t, facet.plane.normal, p);
    });
}

void find_border(OracleFacet& facet) {
    for (std::size_t i = 0; i < facet.triangles.size(); ++i) {
        const Corners& t = facet.triangles[i];
        for (std::size_t e = 0; e < 3; ++e) {
            const Point& a = t[e];
            const Point& b = t[(e + 1) % 3];
            bool is_shared = false;
            for (std::size_t j = 0; j < facet.triangles.size() && !is_shared; ++j) {
                is_shared = j != i && has_corner(facet.triangles[j], a) &&
                            has_corner(facet.triangles[j], b);
            }
            if (!is_shared) {
                facet.border.push_back({a, b});
            }
        }
    }
}

void find_ball(OracleFacet& facet) {
    Point lower{std::numeric_limits<Real>::max()};
    Point upper{std::numeric_limits<Real>::lowest()};
    for (const Corners& t : facet.triangles) {
        for (const Point& p : t) {
            lower = glm::min(lower, p);
            upper = glm::max(upper, p);
        }
    }
    facet.centre = 0.5L * (lower + upper);
    for (const Corners& t : facet.triangles) {
        for (const Point& p : t) {
            facet.radius = std::max(facet.radius, glm::length(p - facet.centre));
        }
    }
}

std::vector<Corners> corners_of(const geometry::MeshView& mesh) {
    std::vector<Corners> result;
    for (const geometry::Triangle& t : mesh.triangles) {
        result.push_back({Point(mesh.positions[t[0]]),
                          Point(mesh.positions[t[1]]),
                          Point(mesh.positions[t[2]])});
    }
    return result;
}

std::vector<std::size_t> largest_first(const std::vector<Corners>& soup) {
    std::vector<Real> areas;
    areas.reserve(soup.size());
    for (const Corners& t : soup) {
        areas.push_back(glm::length(normal_of(t)));
    }
    std::vector<std::size_t> order(soup.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        return areas[a] > areas[b];
    });
    return order;
}

}  // namespace

std::vector<OracleFacet> group_facets(const geometry::MeshView& mesh,
                                      std::span<const std::uint32_t> labels,
                                      Real tolerance) {
    const std::vector<Corners> soup = corners_of(mesh);
    std::vector<bool> is_taken(soup.size(), false);
    std::vector<OracleFacet> facets;
    for (const std::size_t seed : largest_first(soup)) {
        if (is_taken[seed]) {
            continue;
        }
        OracleFacet facet;
        facet.plane = plane_of(soup[seed]);
        facet.label = labels[seed];
        const auto belongs = [&](std::size_t i) {
            return labels[i] == facet.label &&
                   std::all_of(soup[i].begin(), soup[i].end(), [&](const Point& p) {
                       return std::abs(facet.plane.distance(p)) <= tolerance;
                   });
        };
        std::vector<std::size_t> members = {seed};
        is_taken[seed] = true;
        for (std::size_t next = 0; next < members.size(); ++next) {
            const Corners& grown_from = soup[members[next]];
            for (std::size_t i = 0; i < soup.size(); ++i) {
                if (!is_taken[i] && share_an_edge(grown_from, soup[i]) && belongs(i)) {
                    is_taken[i] = true;
                    members.push_back(i);
                }
            }
            facet.triangles.push_back(grown_from);
        }
        find_border(facet);
        find_ball(facet);
        facets.push_back(facet);
    }
    return facets;
}

Real depth_inside(const OracleFacet& facet, const Point& point) {
    Real border = std::numeric_limits<Real>::max();
    for (const auto& [a, b] : facet.border) {
        border = std::min(border, point_segment(point, a, b));
    }
    return contains(facet, point) ? border : -border;
}

Real clearance(const OracleFacet& facet, const Point& from, const Point& to) {
    if (point_segment(facet.centre, from, to) > facet.radius + kMarginCap) {
        return kMarginCap;
    }
    const Real d0 = facet.plane.distance(from);
    const Real d1 = facet.plane.distance(to);
    const bool crosses = (d0 <= 0.0L && d1 >= 0.0L) || (d0 >= 0.0L && d1 <= 0.0L);
    if (crosses && d0 != d1) {
        const Real depth = depth_inside(facet, from + (d0 / (d0 - d1)) * (to - from));
        if (depth >= 0.0L) {
            return -std::min({depth, std::abs(d0), std::abs(d1), kMarginCap});
        }
    }
    // They do not cross: the segment is closest to the border, or one of its ends to the inside.
    Real closest = kMarginCap;
    if (std::min(std::abs(d0), std::abs(d1)) > kMarginCap && !crosses) {
        return closest;
    }
    for (const auto& [end, d] : {std::pair{from, d0}, std::pair{to, d1}}) {
        if (contains(facet, end - d * facet.plane.normal)) {
            closest = std::min(closest, std::abs(d));
        }
    }
    for (const auto& [a, b] : facet.border) {
        closest = std::min(closest, segment_segment(from, to, a, b));
    }
    return closest;
}

}  // namespace earshot::support
