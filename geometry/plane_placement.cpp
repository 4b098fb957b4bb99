// SPDX-License-Identifier: MIT
#include "earshot/geometry/internal/plane_placement.h"

#include "earshot/geometry/vector.h"

#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>
#include <optional>

namespace earshot::geometry {
namespace {

constexpr FacetId kNoFacet = 0xffffffffU;

/// Triangles of other directions than this are no part of a facet's plane, though they replace a
/// vertex of it: half of the turn of a right angle, and some.
constexpr double kMinFacing = 0.6;

/// Three unit normals whose determinant is less meet so flatly that their corner is far away or
/// anywhere; so do two of which the cross product is shorter.
constexpr double kMinDeterminant = 0.1;

Vec3 normal_of(std::span<const Vec3> positions, const Triangle& triangle) {
    const auto [a, b, c] = corners(positions, triangle);
    return normalized_or_zero(glm::cross(b - a, c - a));
}

class Placement {
public:
    Placement(const PlacementInput& input,
              std::span<const DecimatedTriangle> triangles,
              double max_distance)
        : input_(input), triangles_(triangles), max_distance_(max_distance) {
        positions_.assign(input.mesh.positions.begin(), input.mesh.positions.end());
        find_areas();
        list_facets_of_vertices();
        choose_planes();
    }

    std::vector<Vec3> run() {
        std::vector<std::vector<std::size_t>> beside(positions_.size());
        for (std::size_t t = 0; t < triangles_.size(); ++t) {
            for (const VertexId vertex : triangles_[t].corners) {
                beside[vertex].push_back(t);
            }
        }
        for (VertexId vertex = 0; vertex < positions_.size(); ++vertex) {
            if (!beside[vertex].empty() && !input_.is_fixed[vertex]) {
                place(vertex, beside[vertex]);
            }
        }
        return std::move(positions_);
    }

private:
    void find_areas() {
        for (const Facet& facet : input_.facets.facets) {
            double area = 0.0;
            for (const TriangleId id : facet.triangles) {
                const auto [a, b, c] = corners(input_.mesh, id);
                area += 0.5 * glm::length(glm::cross(b - a, c - a));
            }
            areas_.push_back(area);
        }
    }

    /// Of those that are large enough.
    void list_facets_of_vertices() {
        constexpr double kMinWidth = 3.0;  // in distances
        const double min_area = kMinWidth * kMinWidth * max_distance_ * max_distance_;
        facets_of_.resize(positions_.size());
        for (TriangleId id = 0; id < input_.mesh.triangles.size(); ++id) {
            const FacetId facet = input_.facets.of_triangle[id];
            for (const VertexId vertex : input_.mesh.triangles[id]) {
                std::vector<FacetId>& known = facets_of_[vertex];
                if (areas_[facet] >= min_area &&
                    std::find(known.begin(), known.end(), facet) == known.end()) {
                    known.push_back(facet);
                }
            }
        }
    }

    /// Per triangle the largest facet, of those that its samples lie on, which faces as it does.
    void choose_planes() {
        for (const DecimatedTriangle& triangle : triangles_) {
            const Vec3 normal = normal_of(positions_, triangle.corners);
            FacetId best = kNoFacet;
            const auto consider = [&](VertexId vertex) {
                for (const FacetId facet : facets_of_[vertex]) {
                    const bool is_larger = best == kNoFacet || areas_[facet] > areas_[best] ||
                                           (areas_[facet] == areas_[best] && facet < best);
                    if (is_larger &&
                        glm::dot(normal, input_.facets.facets[facet].plane.normal) > kMinFacing) {
                        best = facet;
                    }
                }
            };
            std::for_each(triangle.samples.begin(), triangle.samples.end(), consider);
            std::for_each(triangle.corners.begin(), triangle.corners.end(), consider);
            plane_of_.push_back(best);
        }
    }

    /// The point on all the planes that is closest to `from`, if they are one, two or three.
    std::optional<Vec3> meeting_point(std::span<const FacetId> facets, const Vec3& from) const {
        const auto plane = [&](std::size_t i) { return input_.facets.facets[facets[i]].plane; };
        if (facets.size() == 1) {
            return from - plane(0).distance(from) * plane(0).normal;
        }
        if (facets.size() != 2 && facets.size() != 3) {
            return std::nullopt;
        }
        Vec3 third = glm::cross(plane(0).normal, plane(1).normal);
        double third_offset = 0.0;
        if (facets.size() == 3) {
            third = plane(2).normal;
            third_offset = plane(2).offset;
        } else {
            if (glm::length(third) < kMinDeterminant) {
                return std::nullopt;
            }
            third = normalized_or_zero(third);
            third_offset = glm::dot(third, from);
        }
        const glm::dmat3 rows = glm::transpose(glm::dmat3(plane(0).normal, plane(1).normal, third));
        if (std::abs(glm::determinant(rows)) < kMinDeterminant) {
            return std::nullopt;
        }
        return glm::inverse(rows) * Vec3(plane(0).offset, plane(1).offset, third_offset);
    }

    void place(VertexId vertex, std::span<const std::size_t> beside) {
        std::vector<FacetId> facets;
        for (const std::size_t t : beside) {
            const FacetId facet = plane_of_[t];
            if (facet != kNoFacet &&
                std::find(facets.begin(), facets.end(), facet) == facets.end()) {
                facets.push_back(facet);
            }
        }
        std::sort(facets.begin(), facets.end());
        const Vec3 before = positions_[vertex];
        const std::optional<Vec3> found = meeting_point(facets, before);
        // A vertex at one end of an arc moves farther than the corner is from the arc.
        constexpr double kMaxShift = 2.0;
        if (!found || !(glm::length(*found - before) <= kMaxShift * max_distance_)) {
            return;
        }
        std::vector<Vec3> normals;
        for (const std::size_t t : beside) {
            normals.push_back(normal_of(positions_, triangles_[t].corners));
        }
        positions_[vertex] = *found;
        for (std::size_t i = 0; i < beside.size(); ++i) {
            constexpr double kMaxTurn = 0.5;  // cosine
            const Vec3 after = normal_of(positions_, triangles_[beside[i]].corners);
            if (!(glm::dot(normals[i], after) > kMaxTurn)) {
                positions_[vertex] = before;
                return;
            }
        }
    }

    const PlacementInput& input_;
    std::span<const DecimatedTriangle> triangles_;
    double max_distance_;
    std::vector<Vec3> positions_;
    std::vector<double> areas_;                    // per facet
    std::vector<std::vector<FacetId>> facets_of_;  // per vertex
    std::vector<FacetId> plane_of_;                // per triangle that is left
};

}  // namespace

std::vector<Vec3> place_on_planes(const PlacementInput& input,
                                  std::span<const DecimatedTriangle> triangles,
                                  double max_distance) {
    return Placement(input, triangles, max_distance).run();
}

}  // namespace earshot::geometry
