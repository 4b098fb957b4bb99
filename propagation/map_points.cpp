// SPDX-License-Identifier: MIT
#include "earshot/propagation/map_points.h"

#include "earshot/base/error.h"
#include "earshot/geometry/disjoint_sets.h"
#include "earshot/geometry/mesh.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <string>

namespace earshot::propagation {

using geometry::Vec3;

namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
/// Of faces, from the vertical: the cosine of 60 degrees.
constexpr double kMinUpwardCosine = 0.5;
/// Faces above each other by less are one sheet, of which the upper face counts, metres: the front
/// and back of a board, not two storeys.
constexpr double kMinSheetDistance = 0.5;
/// Heights of neighbouring cells of one sheet differ by less, metres: a step, or a slope.
constexpr double kMaxRise = 0.5;
constexpr double kMaxCells = 1e6;

/// The height of a triangle above (x, z), edges included; NaN beside it.
double height_above(const geometry::Corners& corners, double x, double z) {
    const auto& [a, b, c] = corners;
    const auto cross = [](double ux, double uz, double vx, double vz) { return ux * vz - uz * vx; };
    const double area = cross(b.x - a.x, b.z - a.z, c.x - a.x, c.z - a.z);
    const double u = cross(x - a.x, z - a.z, c.x - a.x, c.z - a.z) / area;
    const double v = cross(b.x - a.x, b.z - a.z, x - a.x, z - a.z) / area;
    // What lies on an edge by rounding must not fall between two triangles.
    constexpr double kRounding = 1e-9;
    if (!(u >= -kRounding && v >= -kRounding && u + v <= 1.0 + kRounding)) {
        return kNone;
    }
    return a.y + u * (b.y - a.y) + v * (c.y - a.y);
}

void check_step(double step) {
    if (!(step > 0.0 && std::isfinite(step))) {
        throw Error("step of the map", "must be positive");
    }
}

}  // namespace

MapLattice::MapLattice(const MapRectangle& rectangle,
                       double step,
                       const AirTest& air,
                       Executor& executor)
    : height_(rectangle.height) {
    divide(std::min(rectangle.x0, rectangle.x1),
           std::min(rectangle.z0, rectangle.z1),
           std::max(rectangle.x0, rectangle.x1),
           std::max(rectangle.z0, rectangle.z1),
           step);
    find_sheets(executor);
    test_points(air, executor);
}

MapLattice::MapLattice(const Scene& scene,
                       double time,
                       const MapSurface& surface,
                       double step,
                       const AirTest& air,
                       Executor& executor)
    : height_(surface.height) {
    find_faces(scene, time, surface);
    double x0 = std::numeric_limits<double>::infinity(), z0 = x0, x1 = -x0, z1 = -x0;
    for (const geometry::Corners& face : faces_) {
        for (const Vec3& corner : {face[0], face[1], face[2]}) {
            x0 = std::min(x0, corner.x);
            x1 = std::max(x1, corner.x);
            z0 = std::min(z0, corner.z);
            z1 = std::max(z1, corner.z);
        }
    }
    divide(x0, z0, x1, z1, step);
    find_sheets(executor);
    test_points(air, executor);
}

void MapLattice::divide(double x0, double z0, double x1, double z1, double step) {
    check_step(step);
    const double width = x1 - x0, depth = z1 - z0;
    if (!(width > 0.0 && depth > 0.0 && std::isfinite(width) && std::isfinite(depth))) {
        throw Error("area of the map", "is empty", "give a rectangle with an area");
    }
    // A length that is a multiple of the step but for its rounding has no cell more.
    constexpr double kRounding = 1e-9;
    const double columns = std::max(1.0, std::ceil(width / step - kRounding));
    const double rows = std::max(1.0, std::ceil(depth / step - kRounding));
    if (!(columns * rows <= kMaxCells)) {
        throw Error("area of the map",
                    "needs more than a million cells of that step",
                    "give a larger step");
    }
    x0_ = x0;
    z0_ = z0;
    columns_ = static_cast<std::uint32_t>(columns);
    rows_ = static_cast<std::uint32_t>(rows);
    cell_width_ = width / columns;
    cell_depth_ = depth / rows;
}

void MapLattice::find_faces(const Scene& scene, double time, const MapSurface& surface) {
    const std::vector<Vec3> positions = scene.mesh.positions_at(time);
    const auto triangles = scene.mesh.triangles();
    std::vector<geometry::Corners> backs;
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        if (scene.material_of_triangle[i] != surface.material) {
            continue;
        }
        const geometry::Corners corners = geometry::corners(positions, triangles[i]);
        const Vec3 across = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
        const double length = glm::length(across);
        if (length > 0.0 && std::abs(across.y) >= kMinUpwardCosine * length) {
            (across.y > 0.0 ? faces_ : backs).push_back(corners);
        }
    }
    if (faces_.empty()) {
        faces_ = std::move(backs);
    }
    if (faces_.empty()) {
        throw Error("material " + scene.materials[surface.material].name,
                    "has no face that looks upwards",
                    "give a material of the floor, or a rectangle");
    }
}

std::vector<double> MapLattice::heights_at(double x, double z) const {
    if (faces_.empty()) {
        return {height_};
    }
    std::vector<double> all;
    for (const geometry::Corners& face : faces_) {
        const double height = height_above(face, x, z);
        if (!std::isnan(height)) {
            all.push_back(height + height_);
        }
    }
    std::sort(all.begin(), all.end(), std::greater<>());
    std::vector<double> heights;
    for (const double height : all) {
        if (heights.empty() || heights.back() - height > kMinSheetDistance) {
            heights.push_back(height);
        }
    }
    return heights;
}

// Sheets are connected parts of the points over all cells. A part that turns above itself, like a
// ramp, is several sheets.
void MapLattice::find_sheets(Executor& executor) {
    const std::size_t cells = std::size_t{columns_} * rows_;
    std::vector<std::vector<double>> heights(cells);
    executor.for_each(rows_, 1, [&](std::size_t row, std::size_t end) {
        for (; row < end; ++row) {
            for (std::uint32_t column = 0; column < columns_; ++column) {
                heights[row * columns_ + column] =
                    heights_at(x_at(column + 0.5), z_at(static_cast<double>(row) + 0.5));
            }
        }
    });
    std::vector<std::size_t> first(cells + 1, 0);
    for (std::size_t cell = 0; cell < cells; ++cell) {
        first[cell + 1] = first[cell] + heights[cell].size();
    }
    geometry::DisjointSets sets(first.back());
    const auto join = [&](std::size_t cell, std::size_t other) {
        for (std::size_t i = 0; i < heights[cell].size(); ++i) {
            for (std::size_t k = 0; k < heights[other].size(); ++k) {
                if (std::abs(heights[cell][i] - heights[other][k]) <= kMaxRise) {
                    sets.unite(static_cast<std::uint32_t>(first[cell] + i),
                               static_cast<std::uint32_t>(first[other] + k));
                }
            }
        }
    };
    for (std::uint32_t row = 0; row < rows_; ++row) {
        for (std::uint32_t column = 0; column < columns_; ++column) {
            if (column + 1 < columns_) {
                join(index(column, row), index(column + 1, row));
            }
            if (row + 1 < rows_) {
                join(index(column, row), index(column, row + 1));
            }
        }
    }
    std::map<std::uint32_t, std::vector<std::size_t>> sheets_of_set;
    for (std::size_t cell = 0; cell < cells; ++cell) {
        for (std::size_t i = 0; i < heights[cell].size(); ++i) {
            std::vector<std::size_t>& own =
                sheets_of_set[sets.find(static_cast<std::uint32_t>(first[cell] + i))];
            auto free = std::find_if(own.begin(), own.end(), [&](std::size_t sheet) {
                return std::isnan(sheets_[sheet].height[cell]);
            });
            if (free == own.end()) {
                free = own.insert(free, sheets_.size());
                sheets_.push_back({.height = std::vector<double>(cells, kNone),
                                   .is_valid = std::vector<std::uint8_t>(cells, 0)});
            }
            sheets_[*free].height[cell] = heights[cell][i];
        }
    }
}

void MapLattice::test_points(const AirTest& air, Executor& executor) {
    std::vector<ExclusionCounts> counts(rows_);
    executor.for_each(rows_, 1, [&](std::size_t begin, std::size_t end) {
        for (auto row = static_cast<std::uint32_t>(begin); row < end; ++row) {
            for (Sheet& sheet : sheets_) {
                for (std::uint32_t column = 0; column < columns_; ++column) {
                    const double height = sheet.height[index(column, row)];
                    if (std::isnan(height)) {
                        continue;
                    }
                    const PointExclusion exclusion =
                        air.exclusion_at({x_at(column + 0.5), height, z_at(row + 0.5)});
                    sheet.is_valid[index(column, row)] = exclusion == PointExclusion::none ? 1 : 0;
                    counts[row].add(exclusion);
                }
            }
        }
    });
    for (const ExclusionCounts& of_row : counts) {
        excluded_.outside += of_row.outside;
        excluded_.in_solid += of_row.in_solid;
        excluded_.near_surface += of_row.near_surface;
    }
}

std::optional<Vec3> MapLattice::point_at(double x, double y, double z, const AirTest& air) const {
    std::optional<Vec3> closest;
    for (const double height : heights_at(x, z)) {
        const double apart = std::abs(height - y);
        if (apart <= kMaxRise && (!closest || apart < std::abs(closest->y - y))) {
            closest = Vec3(x, height, z);
        }
    }
    if (closest && air.exclusion_at(*closest) != PointExclusion::none) {
        closest.reset();
    }
    return closest;
}

}  // namespace earshot::propagation
