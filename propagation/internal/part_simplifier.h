// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/floating_point.h"
#include "earshot/propagation/internal/mesh_parts.h"
#include "earshot/propagation/model_simplification.h"

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace earshot::propagation {

/// A mesh of the scene and one of its materials: triangles of different ones stay apart.
struct SurfaceLabel {
    std::uint32_t mesh = 0;
    std::uint32_t material = 0;
    friend auto operator<=>(const SurfaceLabel&, const SurfaceLabel&) = default;
};

/// How many sides of a part's triangles of a material sound can reach.
double reached_sides(bool is_closed, const Material& material);

/// What stands for a part.
struct SimplifiedPart {
    geometry::Mesh mesh;
    std::vector<std::uint32_t> labels;  ///< per triangle
    bool is_closed = false;
    double volume = 0.0;  ///< as of MeshPart
    std::size_t triangles_before = 0;
    bool is_tightened = false;                 ///< by less than the distance, to keep it
    bool is_kept = false;                      ///< as it was
    SurfaceChange change;                      ///< the largest of its labels
    std::optional<geometry::OrientedBox> box;  ///< which the mesh is
    /// Per label of the part, ascending: sides that sound can reach, square metres, and how rough
    /// the original is against what stands for it.
    struct LabelUse {
        std::uint32_t label = 0;
        double area_before = 0.0;
        double area_after = 0.0;
        double rms_distance = 0.0;
        std::size_t triangles_before = 0;
        std::size_t triangles_after = 0;
    };
    std::vector<LabelUse> uses;
};

/// Simplifies the connected parts of a scene one by one, each until its measured distance is kept.
class PartSimplifier {
public:
    /// All outlive it. `points`: of sources and listeners, which no box may hold.
    PartSimplifier(const Scene& scene,
                   std::span<const SurfaceLabel> labels,
                   std::span<const geometry::Vec3> points,
                   const SimplificationOptions& options);

    /// May be called from many threads.
    SimplifiedPart simplify(const MeshPart& part) const;

private:
    std::optional<SimplifiedPart> as_box(const MeshPart& part) const;
    SimplifiedPart decimated(const MeshPart& part) const;
    bool may_be_box(const MeshPart& part, const geometry::OrientedBox& box) const;
    /// Whether a box of this surface can absorb as much as the part, in every octave.
    bool can_absorb(const SimplifiedPart& box) const;
    void measure_labels(const MeshPart& part, SimplifiedPart& simplified) const;

    const Scene& scene_;
    std::span<const SurfaceLabel> labels_;
    std::span<const geometry::Vec3> points_;
    SimplificationOptions options_;
};

}  // namespace earshot::propagation
