// SPDX-License-Identifier: MIT
#include "earshot/propagation/internal/path_facets.h"

#include "earshot/base/error.h"
#include "earshot/geometry/vector.h"
#include "earshot/propagation/internal/segment_distance.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <set>
#include <string>
#include <utility>

namespace earshot::propagation {

using geometry::Plane;
using geometry::TriangleId;
using geometry::Vec3;

namespace {

// Planes of one facet agree in normal and offset (metres) but for this: an image 50 m away is moved
// by 1e-5 m, at 1 kHz 74 dB below its sound.
constexpr double kPlaneResolution = 1e-7;
// Of the coordinates of points, relative to the largest; some roundings.
constexpr double kRounding = 1e-14;
// Of the plane of an edge, which mirrors nothing: that of a reflection is better.
constexpr double kEdgeQuality = 1e-30;

/// The digits of a plane in which planes of one facet agree.
using PlaneKey = std::array<std::int64_t, 4>;

PlaneKey key_of(const Plane& plane) {
    const auto rounded = [](double value) {
        return static_cast<std::int64_t>(std::floor(value / kPlaneResolution + 0.5));
    };
    return {rounded(plane.normal.x),
            rounded(plane.normal.y),
            rounded(plane.normal.z),
            rounded(plane.offset)};
}

/// Of two normals of a plane the one whose first large component is positive.
Vec3 without_side(const Vec3& normal) {
    const double largest = geometry::max_abs(normal);
    for (int axis = 0; axis < 3; ++axis) {
        // Components of equal size differ by rounding.
        if (std::abs(normal[axis]) > largest - 1e-6) {
            return normal[axis] < 0.0 ? -normal : normal;
        }
    }
    return normal;
}

Plane plane_through(const Vec3& point, const Vec3& normal) {
    const Vec3 unit = without_side(glm::normalize(normal));
    return {.normal = unit, .offset = glm::dot(unit, point)};
}

/// Which of the path's interactions is at its edge.
std::size_t edge_interaction(const Path& path) {
    const std::array<Vec3, 2>& edge = path.edges.front();
    std::size_t nearest = 0;
    double distance = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < path.triangles.size(); ++i) {
        const double away = distance_to_segment(path.points[i + 1], edge);
        if (away < distance) {
            distance = away;
            nearest = i;
        }
    }
    return nearest;
}

/// A plane that contains an edge.
Plane plane_along(const std::array<Vec3, 2>& edge) {
    const Vec3 along = geometry::direction_between(edge[0], edge[1]);
    int axis = 0;
    for (int other = 1; other < 3; ++other) {
        axis = std::abs(along[other]) < std::abs(along[axis]) ? other : axis;
    }
    Vec3 across(0.0);
    across[axis] = 1.0;
    return plane_through(edge[0], across - glm::dot(across, along) * along);
}

}  // namespace

PathFacets::PathFacets(const PathFrames& frames) : frames_(frames) {
    for (const PathFrame& frame : frames.instants) {
        for (const Path& path : frame.paths) {
            for (const Vec3& point : path.points) {
                extent_ = std::max(extent_, geometry::max_abs(point));
            }
        }
    }
    for (std::size_t instant = 0; instant < frames.instants.size(); ++instant) {
        for (const Path& path : frames.instants[instant].paths) {
            observe(instant, path);
        }
    }
    for (auto& [triangle, surface] : surfaces_) {
        finish(triangle, surface);
    }
    join_fixed();
    join_moving();
}

void PathFacets::observe(std::size_t instant, const Path& path) {
    const std::size_t edge = path.edges.empty() ? path.triangles.size() : edge_interaction(path);
    for (std::size_t i = 0; i < path.triangles.size(); ++i) {
        Surface& surface = surfaces_[path.triangles[i]];
        const Vec3& point = path.points[i + 1];
        if (i == edge) {
            add(instant,
                {.plane = plane_along(path.edges.front()), .point = point, .quality = kEdgeQuality},
                surface);
        } else if (path.transmitted.empty() || path.transmitted[i] == 0) {
            surface.reflects = true;
            const double leg = std::min(glm::distance(path.points[i], point),
                                        glm::distance(point, path.points[i + 2]));
            const Vec3 turn = geometry::direction_between(point, path.points[i + 2]) -
                              geometry::direction_between(path.points[i], point);
            const double quality = glm::length(turn) * leg;
            if (quality > kRounding * extent_) {
                add(instant,
                    {.plane = plane_through(point, turn), .point = point, .quality = quality},
                    surface);
            }
        }
    }
}

void PathFacets::add(std::size_t instant, const Observation& observation, Surface& surface) {
    for (Observation* known : {&surface.best, &surface.at[instant]}) {
        if (observation.quality > known->quality) {
            *known = observation;
        }
    }
}

void PathFacets::finish(TriangleId triangle, Surface& surface) const {
    const bool has_plane = surface.best.quality > kEdgeQuality;
    if (surface.reflects && !has_plane) {
        throw Error(frames_.name,
                    "has no reflection at triangle " + std::to_string(triangle) +
                        " whose points tell its plane",
                    "render the scene itself");
    }
    surface.first_triangle = triangle;
    surface.is_fixed =
        has_plane && std::all_of(surface.at.begin(), surface.at.end(), [&](const auto& of_instant) {
            return agree(surface.best, of_instant.second);
        });
}

bool PathFacets::agree(const Observation& best, const Observation& observation) const {
    const double of_best = kRounding * extent_ / best.quality;
    const double max_sine = kPlaneResolution + of_best + kRounding * extent_ / observation.quality;
    return observation.quality == kEdgeQuality ||
           (glm::length(glm::cross(best.plane.normal, observation.plane.normal)) <= max_sine &&
            std::abs(best.plane.distance(observation.point)) <=
                kPlaneResolution + extent_ * (kRounding + of_best));
}

void PathFacets::join_fixed() {
    std::map<PlaneKey, std::vector<TriangleId>> facets;
    for (const auto& [triangle, surface] : surfaces_) {
        if (surface.is_fixed) {
            facets[key_of(surface.best.plane)].push_back(triangle);
        }
    }
    for (const auto& of_plane : facets) {
        const std::vector<TriangleId>& triangles = of_plane.second;
        Observation best;
        for (const TriangleId triangle : triangles) {
            const Observation& own = surfaces_[triangle].best;
            best = own.quality > best.quality ? own : best;
        }
        for (const TriangleId triangle : triangles) {
            surfaces_[triangle].best = best;
            surfaces_[triangle].first_triangle = triangles.front();
        }
    }
}

// Triangles that move are a facet if they are in one plane at every instant at which two of them
// are met.
void PathFacets::join_moving() {
    std::map<std::pair<std::size_t, PlaneKey>, std::vector<TriangleId>> groups;
    for (const auto& [triangle, surface] : surfaces_) {
        for (const auto& [instant, observation] : surface.at) {
            if (!surface.is_fixed && observation.quality > kEdgeQuality) {
                groups[{instant, key_of(observation.plane)}].push_back(triangle);
            }
        }
    }
    std::map<TriangleId, TriangleId> parents;  // of the forest of joined triangles; roots have none
    const auto first_of = [&](TriangleId triangle) {
        for (auto parent = parents.find(triangle); parent != parents.end();
             parent = parents.find(triangle)) {
            triangle = parent->second;
        }
        return triangle;
    };
    for (const auto& of_plane : groups) {
        for (const TriangleId triangle : of_plane.second) {
            const TriangleId a = first_of(triangle), b = first_of(of_plane.second.front());
            if (a != b) {
                parents[std::max(a, b)] = std::min(a, b);
            }
        }
    }
    std::map<std::pair<std::size_t, TriangleId>, PlaneKey> planes;
    std::set<TriangleId> broken;
    for (const auto& [place, triangles] : groups) {
        const TriangleId first = first_of(triangles.front());
        const auto known = planes.try_emplace({place.first, first}, place.second).first;
        if (known->second != place.second) {
            broken.insert(first);
        }
    }
    for (const auto& of_triangle : parents) {
        const TriangleId first = first_of(of_triangle.first);
        if (broken.count(first) == 0) {
            surfaces_[of_triangle.first].first_triangle = first;
        }
    }
}

FacetTable PathFacets::at(std::size_t instant) const {
    std::map<TriangleId, FacetTriangle> met;
    for (const Path& path : frames_.instants[instant].paths) {
        for (const TriangleId triangle : path.triangles) {
            const Surface& surface = surfaces_.at(triangle);
            const auto own = surface.at.find(instant);
            const bool is_best = surface.is_fixed || own == surface.at.end();
            met[triangle] = {.triangle = triangle,
                             .first_triangle = surface.first_triangle,
                             .plane = (is_best ? surface.best : own->second).plane};
        }
    }
    std::vector<FacetTriangle> triangles;
    for (const auto& of_triangle : met) {
        triangles.push_back(of_triangle.second);
    }
    return FacetTable(triangles);
}

}  // namespace earshot::propagation
