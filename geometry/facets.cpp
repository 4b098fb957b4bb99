// SPDX-License-Identifier: MIT
#include "earshot/geometry/facets.h"

#include "earshot/base/assert.h"
#include "earshot/base/error_free.h"
#include "earshot/geometry/internal/border_loops.h"
#include "earshot/geometry/tolerance.h"
#include "earshot/geometry/topology.h"
#include "earshot/geometry/vector.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

// The adjacency is a sorted table of edges (topology.h), not a half-edge mesh: scenes have edges
// with three and more triangles and neighbours of opposite winding, which a half-edge mesh such as
// OpenMesh's refuses to add, and the triangles that it refuses still reflect sound.

namespace earshot::geometry {
namespace {

constexpr FacetId kNoFacet = std::numeric_limits<FacetId>::max();

/// The corners from the smallest position on, so that nothing depends on which one a file names
/// first.
Corners sorted_corners(const MeshView& mesh, TriangleId id) noexcept {
    Corners found = corners(mesh, id);
    std::rotate(found.begin(),
                std::min_element(found.begin(), found.end(), lexicographic_less),
                found.end());
    return found;
}

/// a d - b c with products to twice the precision: a thin triangle's normal is a small difference
/// of large products.
double difference_of_products(double a, double d, double b, double c) noexcept {
    const DoublePair left = two_product(a, d);
    const DoublePair right = two_product(b, c);
    const DoublePair sum = two_sum(left.hi, -right.hi);
    return sum.hi + (sum.lo + (left.lo - right.lo));
}

/// Twice the area, along the normal.
Vec3 area_normal(const Corners& p) noexcept {
    const Vec3 u = p[1] - p[0];
    const Vec3 v = p[2] - p[0];
    return {difference_of_products(u.y, v.z, u.z, v.y),
            difference_of_products(u.z, v.x, u.x, v.z),
            difference_of_products(u.x, v.y, u.y, v.x)};
}

double longest_edge(const Corners& p) noexcept {
    const Vec3 a = p[1] - p[0];
    const Vec3 b = p[2] - p[1];
    const Vec3 c = p[0] - p[2];
    return std::sqrt(std::max({glm::dot(a, a), glm::dot(b, b), glm::dot(c, c)}));
}

/// Exact for axis-aligned triangles: a component of 0 stays 0 (never -0), the other becomes 1, and
/// the offset is the coordinate.
Plane plane_of(const Corners& corners, const Vec3& area_normal) noexcept {
    Vec3 normal = area_normal;
    Vec3 size = glm::abs(normal);
    if (size == Vec3(0.0)) {
        // Thinner than rounding: all planes through its line are as good as each other.
        const Vec3 along = corners[1] - corners[0];
        const Vec3 a = glm::abs(along);
        const Vec3 axis = a.x <= a.y && a.x <= a.z ? Vec3(1.0, 0.0, 0.0) : Vec3(0.0, 0.0, 1.0);
        normal = glm::cross(along, axis);
        size = glm::abs(normal);
    }
    // First to about 1, so that squares neither overflow nor underflow.
    normal /= std::max({size.x, size.y, size.z});
    normal /= std::sqrt(glm::dot(normal, normal));
    normal += 0.0;
    return {normal, glm::dot(normal, corners[0]) + 0.0};
}

/// What belongs to a facet, judged by its largest triangle alone, so that a chain of small
/// deviations cannot lead away from it.
class Membership {
public:
    /// `normal`: the seed's area_normal().
    Membership(const Corners& seed, const Vec3& normal, double tolerance)
        : plane_(plane_of(seed, normal)), origin_(seed[0]), tolerance_(tolerance) {
        // Moving the seed's vertices by their rounding tilts its plane by at most tolerance / h, h
        // its smallest height. A seed so thin that the tilt is no longer small has a plane only
        // near itself.
        constexpr double kSteepest = 0x1p-12;
        const double height = std::sqrt(glm::dot(normal, normal)) / longest_edge(seed);
        tilt_ = tolerance <= kSteepest * height ? tolerance / height : 0.0;
    }

    const Plane& plane() const noexcept { return plane_; }

    /// Whether a triangle with that corner may be included.
    bool admits(const Vec3& corner) const noexcept {
        return is_near(corner, plane_.distance(corner));
    }

    /// Slivers have no normal to speak of, so all tests are on distances of vertices.
    bool includes(const Corners& p) const noexcept {
        const std::array<double, 3> distance{
            plane_.distance(p[0]), plane_.distance(p[1]), plane_.distance(p[2])};
        for (std::size_t i = 0; i < 3; ++i) {
            if (!is_near(p[i], distance[i])) {
                return false;
            }
            // Far out, where the tilt allows more, small steps are still steps.
            const std::size_t j = (i + 1) % 3;
            if (std::abs(distance[i] - distance[j]) > allowed(p[i] - p[j])) {
                return false;
            }
        }
        // Folded back, and by more than the width that rounding may give a triangle of none.
        const double facing = glm::dot(glm::cross(p[1] - p[0], p[2] - p[0]), plane_.normal);
        return facing >= -tolerance_ * longest_edge(p);
    }

private:
    bool is_near(const Vec3& corner, double distance) const noexcept {
        return !(std::abs(distance) > allowed(corner - origin_));
    }
    double allowed(const Vec3& offset) const noexcept {
        return tolerance_ + tilt_ * std::sqrt(glm::dot(offset, offset));
    }

    Plane plane_;
    Vec3 origin_{0.0};
    double tolerance_ = 0.0;
    double tilt_ = 0.0;
};

std::vector<Vec3> area_normals(const MeshView& mesh, Executor& executor) {
    constexpr std::size_t kGrain = 4096;
    std::vector<Vec3> normals(mesh.triangles.size());
    executor.for_each(normals.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t t = begin; t < end; ++t) {
            normals[t] = area_normal(sorted_corners(mesh, static_cast<TriangleId>(t)));
        }
    });
    return normals;
}

/// Triangles from the largest to the smallest, the lowest index first among equals.
std::vector<TriangleId> by_descending_area(std::span<const Vec3> normals) {
    std::vector<std::pair<double, TriangleId>> keyed(normals.size());
    for (std::size_t t = 0; t < keyed.size(); ++t) {
        keyed[t] = {-glm::dot(normals[t], normals[t]), static_cast<TriangleId>(t)};
    }
    std::sort(keyed.begin(), keyed.end());
    std::vector<TriangleId> order(keyed.size());
    std::transform(
        keyed.begin(), keyed.end(), order.begin(), [](const auto& key) { return key.second; });
    return order;
}

/// Per facet, in the order they were grown.
struct Groups {
    std::vector<Plane> planes;
    std::vector<FacetId> of_triangle;
};

Groups grow_groups(const MeshView& mesh,
                   std::span<const HalfEdgeId> twins,
                   std::span<const std::uint32_t> labels,
                   double tolerance,
                   Executor& executor) {
    const std::vector<Vec3> normals = area_normals(mesh, executor);
    Groups groups;
    groups.of_triangle.assign(mesh.triangles.size(), kNoFacet);
    std::vector<TriangleId> stack;
    for (const TriangleId seed : by_descending_area(normals)) {
        if (groups.of_triangle[seed] != kNoFacet) {
            continue;
        }
        const Membership membership(sorted_corners(mesh, seed), normals[seed], tolerance);
        const auto facet = static_cast<FacetId>(groups.planes.size());
        groups.planes.push_back(membership.plane());
        groups.of_triangle[seed] = facet;
        stack.assign(1, seed);
        while (!stack.empty()) {
            const TriangleId member = stack.back();
            stack.pop_back();
            for (HalfEdgeId h = 3 * member; h < 3 * member + 3; ++h) {
                if (twins[h] == kNoHalfEdge) {
                    continue;
                }
                // The corner off the shared edge refuses most.
                const TriangleId next = triangle_of(twins[h]);
                const VertexId far = mesh.triangles[next][(twins[h] % 3 + 2) % 3];
                if (groups.of_triangle[next] == kNoFacet && labels[next] == labels[seed] &&
                    membership.admits(mesh.positions[far]) &&
                    membership.includes(sorted_corners(mesh, next))) {
                    groups.of_triangle[next] = facet;
                    stack.push_back(next);
                }
            }
        }
    }
    return groups;
}

/// The groups as facets, numbered by their lowest triangle; loops are still missing.
Facets numbered(const Groups& groups) {
    Facets result;
    result.facets.resize(groups.planes.size());
    result.of_triangle.resize(groups.of_triangle.size());
    std::vector<FacetId> number(groups.planes.size(), kNoFacet);
    std::vector<std::uint32_t> sizes(groups.planes.size(), 0);
    for (const FacetId group : groups.of_triangle) {
        ++sizes[group];
    }
    FacetId count = 0;
    for (std::size_t t = 0; t < groups.of_triangle.size(); ++t) {
        const FacetId group = groups.of_triangle[t];
        if (number[group] == kNoFacet) {
            number[group] = count++;
            result.facets[number[group]].plane = groups.planes[group];
            result.facets[number[group]].triangles.reserve(sizes[group]);
        }
        result.of_triangle[t] = number[group];
        result.facets[number[group]].triangles.push_back(static_cast<TriangleId>(t));
    }
    return result;
}

double deviation_of(const Facet& facet, const MeshView& mesh) noexcept {
    double deviation = 0.0;
    for (const TriangleId triangle : facet.triangles) {
        for (const VertexId vertex : mesh.triangles[triangle]) {
            const double distance = std::abs(facet.plane.distance(mesh.positions[vertex]));
            deviation = std::max(deviation, distance);
        }
    }
    return deviation;
}

void find_loops(Facet& facet, BorderWalk& walk, std::span<const Vec3> positions, double tolerance) {
    std::vector<Vec3> polygon;
    for (const std::vector<VertexId>& border : walk.loops(facet.triangles)) {
        polygon.clear();
        for (const VertexId vertex : border) {
            polygon.push_back(positions[vertex]);
        }
        facet.loops.push_back(corners_of(polygon, tolerance));
    }
    std::sort(facet.loops.begin(), facet.loops.end(), [&](const Loop& a, const Loop& b) {
        return std::lexicographical_compare(
            a.begin(), a.end(), b.begin(), b.end(), lexicographic_less);
    });
}

}  // namespace

double Plane::distance(const Vec3& point) const noexcept {
    return glm::dot(normal, point) - offset;
}

Vec3 Plane::mirror(const Vec3& point) const noexcept {
    for (int axis = 0; axis < 3; ++axis) {
        if (normal[(axis + 1) % 3] == 0.0 && normal[(axis + 2) % 3] == 0.0) {
            Vec3 image = point;
            image[axis] = 2.0 * offset * normal[axis] - point[axis];
            return image;
        }
    }
    return point - 2.0 * distance(point) * normal;
}

Facets find_facets(const MeshView& mesh,
                   std::span<const VertexId> weld,
                   std::span<const std::uint32_t> labels,
                   Executor& executor) {
    return FacetFinder(mesh, weld, labels).find(mesh, executor);
}

FacetFinder::FacetFinder(const MeshView& mesh,
                         std::span<const VertexId> weld,
                         std::span<const std::uint32_t> labels)
    : welded_(mesh.triangles.size()), labels_(labels.begin(), labels.end()) {
    EARSHOT_ASSERT(weld.size() == mesh.positions.size());
    EARSHOT_ASSERT(labels.size() == mesh.triangles.size());
    std::transform(
        mesh.triangles.begin(), mesh.triangles.end(), welded_.begin(), [&](const Triangle& t) {
            return Triangle{weld[t[0]], weld[t[1]], weld[t[2]]};
        });
    twins_ = twins_of(EdgeTable(welded_, mesh.positions.size()), welded_);
}

Facets FacetFinder::find(const MeshView& mesh, Executor& executor) const {
    EARSHOT_ASSERT(mesh.triangles.size() == welded_.size());
    const double tolerance = coplanar_tolerance(mesh);
    Facets result = numbered(grow_groups(mesh, twins_, labels_, tolerance, executor));
    result.tolerance = tolerance;
    // Few pieces, as each has a walk with marks for the whole mesh.
    constexpr std::size_t kMaxPieces = 16;
    constexpr std::size_t kMinGrain = 512;
    const std::size_t count = result.facets.size();
    const std::size_t grain = std::max(kMinGrain, chunk_count(count, kMaxPieces));
    executor.for_each(count, grain, [&](std::size_t begin, std::size_t end) {
        BorderWalk walk(welded_, twins_, result.of_triangle, mesh.positions.size());
        for (std::size_t i = begin; i < end; ++i) {
            Facet& facet = result.facets[i];
            facet.deviation = deviation_of(facet, mesh);
            find_loops(facet, walk, mesh.positions, tolerance);
        }
    });
    return result;
}

}  // namespace earshot::geometry
