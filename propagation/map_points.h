// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/bvh/mesh_bvh.h"
#include "earshot/propagation/scene.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>
#include <variant>
#include <vector>

namespace earshot::propagation {

/// A rectangle in the plane of x and z at one height (y), metres; which corner is the lower one is
/// not looked at.
struct MapRectangle {
    double x0 = 0.0, z0 = 0.0, x1 = 0.0, z1 = 0.0;
    double height = 1.2;
};

/// Points at a height above the faces of a material. Faces count whose front looks upwards, at most
/// 60 degrees from the vertical; if the material has none, those whose back does.
struct MapSurface {
    std::uint32_t material = 0;  ///< index into Scene::materials
    double height = 1.2;         ///< metres above the faces
};

/// Points in any order.
using MapPointList = std::vector<geometry::Vec3>;

/// Where a map is asked for.
using MapArea = std::variant<MapRectangle, MapSurface, MapPointList>;

/// Why a point has no value.
enum class PointExclusion : std::uint8_t {
    none,          ///< it has
    outside,       ///< outside of the closed surface around the sources, or of the scene
    in_solid,      ///< inside a closed surface that holds no source
    near_surface,  ///< nearer to a surface than the clearance
};

/// "outside", "in_solid", "near_surface"; empty for none.
std::string_view name_of(PointExclusion exclusion) noexcept;

/// How many points have no value, by reason.
struct ExclusionCounts {
    std::size_t outside = 0, in_solid = 0, near_surface = 0;

    void add(PointExclusion exclusion) noexcept;
    std::size_t total() const noexcept { return outside + in_solid + near_surface; }
};

/// Tells which points lie in the air that the sources of a scene fill.
class AirTest {
public:
    /// `bvh` over the scene's triangles at `time`; it and the scene must outlive the test.
    /// `clearance`: of points to surfaces, metres, 0 or more.
    AirTest(const Scene& scene, double time, const bvh::MeshBvh& bvh, double clearance);
    ~AirTest();
    AirTest(const AirTest&) = delete;
    AirTest& operator=(const AirTest&) = delete;

    /// O(triangles of the surfaces about the point).
    PointExclusion exclusion_at(const geometry::Vec3& point) const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

/// A lattice of equal cells over the plane of x and z. Where faces lie above each other it has
/// several sheets, each of which has at most one point per cell.
class MapLattice {
public:
    /// Without a cell.
    MapLattice() = default;
    /// Cells of at most `step` metres, of which those take part whose middle passes the test.
    /// Throws Error if the area is empty or needs more than a million cells.
    MapLattice(const MapRectangle& rectangle,
               double step,
               const AirTest& air,
               Executor& executor = Executor::serial());
    MapLattice(const Scene& scene,
               double time,
               const MapSurface& surface,
               double step,
               const AirTest& air,
               Executor& executor = Executor::serial());

    std::uint32_t columns() const noexcept { return columns_; }  ///< along x
    std::uint32_t rows() const noexcept { return rows_; }        ///< along z
    std::size_t sheets() const noexcept { return sheets_.size(); }
    double cell_width() const noexcept { return cell_width_; }  ///< along x, metres
    double cell_depth() const noexcept { return cell_depth_; }  ///< along z, metres
    double x_at(double column) const noexcept { return x0_ + column * cell_width_; }
    double z_at(double row) const noexcept { return z0_ + row * cell_depth_; }

    /// Whether the middle of a cell takes part.
    bool is_valid(std::size_t sheet, std::uint32_t column, std::uint32_t row) const noexcept {
        return sheets_[sheet].is_valid[index(column, row)] != 0;
    }
    /// The height of a sheet in the middle of a cell. Precondition: it takes part.
    double height(std::size_t sheet, std::uint32_t column, std::uint32_t row) const noexcept {
        return sheets_[sheet].height[index(column, row)];
    }
    /// The point of a sheet above (x, z), the one nearest to height `y`; nothing where there is
    /// none within half a metre, or where it does not pass the test.
    std::optional<geometry::Vec3> point_at(double x, double y, double z, const AirTest& air) const;

    const ExclusionCounts& excluded() const noexcept { return excluded_; }  ///< middles of cells

private:
    struct Sheet {
        std::vector<double> height;  // y per cell; NaN where the sheet has none
        std::vector<std::uint8_t> is_valid;
    };

    std::size_t index(std::uint32_t column, std::uint32_t row) const noexcept {
        return std::size_t{row} * columns_ + column;
    }
    void divide(double x0, double z0, double x1, double z1, double step);
    void find_faces(const Scene& scene, double time, const MapSurface& surface);
    std::vector<double> heights_at(double x, double z) const;
    void find_sheets(Executor& executor);
    void test_points(const AirTest& air, Executor& executor);

    double x0_ = 0.0, z0_ = 0.0, cell_width_ = 1.0, cell_depth_ = 1.0;
    std::uint32_t columns_ = 0, rows_ = 0;
    std::vector<Sheet> sheets_;
    std::vector<geometry::Corners> faces_;  // of a surface; none of a rectangle
    double height_ = 0.0;                   // above faces, or of the rectangle
    ExclusionCounts excluded_;
};

}  // namespace earshot::propagation
