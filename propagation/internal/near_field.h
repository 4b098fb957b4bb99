// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/bands.h"
#include "earshot/bvh/mesh_bvh.h"
#include "earshot/propagation/internal/ray_surface.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace earshot::propagation {

/// Surfaces nearer than this are near a listener or source, metres.
inline constexpr double kNearDistance = 0.75;
/// Reflections on the way from such a surface, at most.
inline constexpr int kMaxNearReflections = 3;

/// The directions in which a listener looks for surfaces, on a spiral over the sphere.
inline constexpr std::size_t kProbeDirections = 16384;
geometry::Vec3 probe_direction(std::size_t i) noexcept;

/// What scattered energy of a cell of a surface contributes to a listener.
struct NearContribution {
    double weight = 0.0;        ///< times the scattered energy
    geometry::Vec3 point{0.0};  ///< of the surface, whose delay the contribution has
    geometry::Vec3 image{0.0};  ///< of that point, unfolded along the reflections to the listener
    geometry::Vec3 side{0.0};   ///< unit normal on the side that the listener sees
    std::uint32_t reflections = 0;  ///< index into NearField::reflection_factor()
};

/// The surfaces near the source, which listens to reversed rays. Diffuse rain weighs a point of a
/// surface with cos / (pi d^2): its variance grows without bound as the listener comes nearer. Here
/// the directions of the listener are integrated instead. A direction that first meets a surface at
/// q, nearer than kNearDistance (reflections unfolded), sees the scattered energy per area about q,
/// estimated from all rays that hit a disc of the plane about q; so no ray weighs more than that
/// disc allows, however near the surface is. Unbiased where the irradiance varies linearly over the
/// disc.
class NearField {
public:
    /// `surfaces` two per material: front and back. Reflected probes start `offset` metres from the
    /// surface.
    NearField(const bvh::MeshBvh& bvh,
              std::span<const std::uint32_t> material_of_triangle,
              std::span<const RaySurface> surfaces,
              const geometry::Vec3& listener,
              double offset);

    /// The contributions of the place that a ray hits.
    std::span<const NearContribution> contributions(const geometry::Hit& hit) const noexcept;
    /// Energy factor per band of the reflections of a contribution.
    const audio::Spectrum& reflection_factor(std::uint32_t reflections) const noexcept {
        return factors_[reflections];
    }
    /// Materials of those reflections, as often as each reflects.
    std::span<const std::uint32_t> reflection_materials(std::uint32_t reflections) const noexcept {
        return factor_materials_[reflections];
    }

private:
    class Builder;

    /// The cells of one triangle near the listener: cells of a triangle cut into n x n, in a range
    /// of rows (second weight) and columns (first weight), two to a square.
    struct Patch {
        geometry::TriangleId triangle = 0;
        std::uint32_t divisions = 1;
        std::uint32_t first_column = 0, columns = 0, first_row = 0, rows = 0;
        std::size_t first_cell = 0;

        std::size_t end_cell() const noexcept {
            return first_cell + std::size_t{2} * rows * columns;
        }
        /// The cell at two barycentric weights, counted from first_cell, or nothing.
        std::optional<std::size_t> cell_at(double u, double v) const noexcept;
    };

    std::vector<Patch> patches_;                // by triangle
    std::vector<std::uint32_t> first_of_cell_;  // into contributions_; one more than cells
    std::vector<NearContribution> contributions_;
    std::vector<audio::Spectrum> factors_;
    std::vector<std::vector<std::uint32_t>> factor_materials_;  // of each
};

}  // namespace earshot::propagation
