// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/base/progress.h"
#include "earshot/bvh/mesh_bvh.h"
#include "earshot/geometry/types.h"
#include "earshot/visibility/triangle_sides.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace earshot::visibility {

struct AirCutOptions {
    std::uint64_t seed = 1;
    std::uint64_t rays_per_node = 16;  ///< RperN; of a cluster per triangle
    std::size_t random_samples = 5;    ///< RS: points within a triangle that meets others
    std::size_t border_samples = 6;    ///< BS: points along its edges
    bool cluster = true;               ///< one node per side of connected triangles
    /// The part of its front's weight that ties the back of a side to the solid: the larger it is,
    /// the larger an opening has to be so that what lies behind it counts as air.
    double lambda = 0.01;
    /// Weights that are small among those of their node fade (the crack filter).
    bool filter_cracks = false;
    /// What lies beyond the scene counts as air if a larger share of the sound goes there.
    double open_share = 0.25;
    std::uint64_t rays_per_point = 16384;
    std::uint64_t max_rays = 12'000'000;  ///< rays_per_node shrinks, down to 2, to keep it
    double tolerance = 0.0;               ///< metres: triangles nearer to each other meet
    Progress* progress = nullptr;         ///< receives "leaks" and "openings"
};

/// A surface without triangles that sound may pass through: the cap of a hole, or a strip beside an
/// open edge.
struct Opening {
    std::vector<std::array<geometry::Vec3, 3>> cap;
    std::uint32_t rays = 256;
    bool is_strip = false;  ///< its flow is measured, but is no part of the graph
};

/// What passes an opening, by rays through it that are uniform over its area and distributed by
/// Lambert's law about its normal.
struct OpeningFlow {
    double area = 0.0;  ///< square metres, of the cap
    std::uint32_t rays = 0;
    std::uint32_t blocked = 0;   ///< at a place where a triangle lies in the cap
    std::uint32_t leaking = 0;   ///< between air and what is no air
    std::uint32_t escaping = 0;  ///< of these, those that leave the scene
    geometry::Vec3 lower{0.0};   ///< bounding box of the places that leaking rays pass, metres
    geometry::Vec3 upper{0.0};
};

enum class SideLabel : std::uint8_t {
    solid,
    air,
    mixed  ///< the samples of a triangle that meets others disagree: a part of it faces the air
};

struct AirCut {
    std::vector<SideLabel> label_of_side;  ///< two per triangle
    bool is_open = false;                  ///< what lies beyond the scene counts as air
    std::vector<OpeningFlow> openings;     ///< in the order given
    /// Of rays between sides of different labels, the sum of their weights: square metres of
    /// openings. Includes those through openings that were given.
    double leak_area = 0.0;
    double flow = 0.0;  ///< of the cut, square metres
    std::size_t clusters = 0;
    std::size_t sampled_triangles = 0;  ///< that meet others
    std::size_t nodes = 0;
    std::size_t edges = 0;
    std::uint64_t rays = 0;
    double cluster_seconds = 0.0, sampling_seconds = 0.0, cut_seconds = 0.0;
};

/// Parts the sides of a mesh into those that face the air of `points` and the rest (Zhou et al.
/// 2008, visibility-driven mesh analysis): sides are nodes of a graph whose weights are the power
/// that they exchange, estimated by rays; the minimum cut between air and solid parts them where
/// little is exchanged. The points play the outside of the paper: the sides that they see are tied
/// to the air, the backs of these by `lambda` to the solid. Without points what lies beyond the
/// scene is the outside, as printed. The same for any executor but for the seconds. Preconditions:
/// triangles name welded vertices, and each has an area.
AirCut cut_air(const bvh::MeshBvh& bvh,
               std::span<const geometry::Vec3> points,
               std::span<const Opening> openings,
               const AirCutOptions& options = {},
               Executor& executor = Executor::serial());

}  // namespace earshot::visibility
