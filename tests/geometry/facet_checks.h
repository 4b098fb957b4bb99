// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/clean.h"
#include "earshot/geometry/facets.h"

#include <gtest/gtest.h>

#include "geometry/made_meshes.h"
#include <algorithm>
#include <cmath>
#include <set>
#include <tuple>
#include <vector>

namespace earshot::geometry {

using Labels = std::vector<std::uint32_t>;

inline Facets facets_of(const Mesh& mesh, Labels labels = {}) {
    labels.resize(mesh.triangles.size(), 0);
    const CleanMesh cleaned = clean(mesh.view());
    EXPECT_EQ(cleaned.kept.size(), mesh.triangles.size());
    return find_facets(mesh.view(), cleaned.weld, labels);
}

/// Area by the shoelace formula, positive if counter-clockwise seen against the normal.
inline double signed_area(const Loop& loop, const Vec3& normal) {
    Vec3 sum(0.0);
    for (std::size_t i = 1; i + 1 < loop.size(); ++i) {
        sum += glm::cross(loop[i] - loop[0], loop[i + 1] - loop[0]);
    }
    return 0.5 * glm::dot(sum, normal);
}

inline double perimeter(const Loop& loop) {
    double sum = 0.0;
    for (std::size_t i = 0; i < loop.size(); ++i) {
        sum += glm::length(loop[(i + 1) % loop.size()] - loop[i]);
    }
    return sum;
}

inline double area_of(const Mesh& mesh, TriangleId t) {
    const auto [a, b, c] = mesh.triangles[t];
    const auto& p = mesh.positions;
    return 0.5 * glm::length(glm::cross(p[b] - p[a], p[c] - p[a]));
}

inline double area_of(const Mesh& mesh, const std::vector<TriangleId>& triangles) {
    double sum = 0.0;
    for (const TriangleId t : triangles) {
        sum += area_of(mesh, t);
    }
    return sum;
}

/// What must hold for the facets of any mesh.
inline void expect_sound(const Mesh& mesh, const Facets& result) {
    ASSERT_EQ(result.of_triangle.size(), mesh.triangles.size());
    std::size_t members = 0;
    TriangleId previous_first = 0;
    for (FacetId f = 0; f < result.facets.size(); ++f) {
        const Facet& facet = result.facets[f];
        ASSERT_FALSE(facet.triangles.empty());
        EXPECT_TRUE(std::is_sorted(facet.triangles.begin(), facet.triangles.end()));
        EXPECT_TRUE(f == 0 || facet.triangles.front() > previous_first);
        previous_first = facet.triangles.front();
        members += facet.triangles.size();
        double area_by_loops = 0.0;
        double border = 0.0;
        for (const Loop& loop : facet.loops) {
            EXPECT_GE(loop.size(), 3U);
            std::set<std::tuple<double, double, double>> seen;
            for (const Vec3& p : loop) {
                EXPECT_TRUE(seen.insert({p.x, p.y, p.z}).second) << "visits a vertex twice";
            }
            area_by_loops += signed_area(loop, facet.plane.normal);
            border += perimeter(loop);
        }
        // Corners within the tolerance of a straight run are left out; a tilt of the plane shortens
        // areas by its square only.
        EXPECT_NEAR(area_by_loops,
                    area_of(mesh, facet.triangles),
                    border * (result.tolerance + facet.deviation))
            << f;
        for (const TriangleId t : facet.triangles) {
            EXPECT_EQ(result.of_triangle[t], f);
        }
    }
    EXPECT_EQ(members, mesh.triangles.size());
}

inline glm::dmat3 some_rotation() {
    const double c = std::cos(0.7);
    const double s = std::sin(0.7);
    const glm::dmat3 about_z(c, s, 0.0, -s, c, 0.0, 0.0, 0.0, 1.0);
    return glm::dmat3(0.36, 0.48, -0.8, -0.8, 0.6, 0.0, 0.48, 0.64, 0.6) * about_z;
}

}  // namespace earshot::geometry
