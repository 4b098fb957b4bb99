// SPDX-License-Identifier: MIT
#include "earshot/geometry/simplify.h"

#include "earshot/base/error.h"
#include "earshot/geometry/clean.h"
#include "earshot/geometry/internal/half_edge_mesh.h"
#include "earshot/geometry/internal/manifold_fans.h"
#include "earshot/geometry/internal/plane_placement.h"
#include "earshot/geometry/internal/surface_curves.h"
#include "earshot/geometry/mesh_topology.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace earshot::geometry {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr VertexId kUnused = 0xffffffffU;

/// The triangles that take part, by vertices that are used and welded.
SimplifiedMesh cleaned(const MeshView& mesh, Executor& executor) {
    const CleanMesh clean_mesh = clean(mesh, executor);
    SimplifiedMesh result;
    result.origins = clean_mesh.kept;
    std::vector<VertexId> number(mesh.positions.size(), kUnused);
    for (const TriangleId id : clean_mesh.kept) {
        Triangle triangle = mesh.triangles[id];
        for (VertexId& vertex : triangle) {
            VertexId& new_id = number[clean_mesh.weld[vertex]];
            if (new_id == kUnused) {
                new_id = static_cast<VertexId>(result.mesh.positions.size());
                result.mesh.positions.push_back(mesh.positions[clean_mesh.weld[vertex]]);
            }
            vertex = new_id;
        }
        result.mesh.triangles.push_back(triangle);
    }
    return result;
}

/// A surface as oriented manifold patches, and how they hang together.
struct Patches {
    ManifoldFans fans;
    std::vector<Vec3> positions;      // per fan
    std::vector<VertexId> vertex_of;  // per fan: the vertex that it is a part of
    std::vector<bool> is_locked;      // per fan
};

Patches patches_of(const Mesh& mesh) {
    Patches patches{.fans = split_fans(mesh.triangles, mesh.positions),
                    .positions = {},
                    .vertex_of = {},
                    .is_locked = {}};
    const std::size_t count = patches.fans.vertex_count;
    patches.vertex_of.resize(count);
    patches.is_locked.assign(count, false);
    for (TriangleId t = 0; t < mesh.triangles.size(); ++t) {
        for (std::size_t corner = 0; corner < 3; ++corner) {
            const std::size_t source = patches.fans.is_flipped[t] ? (3 - corner) % 3 : corner;
            patches.vertex_of[patches.fans.triangles[t][corner]] = mesh.triangles[t][source];
        }
    }
    // Fans of one vertex must stay together, and so must the borders of patches that meet.
    std::vector<std::uint8_t> fan_counts(mesh.positions.size(), 0);
    for (const VertexId vertex : patches.vertex_of) {
        patches.positions.push_back(mesh.positions[vertex]);
        fan_counts[vertex] = static_cast<std::uint8_t>(std::min(2, fan_counts[vertex] + 1));
    }
    for (VertexId fan = 0; fan < count; ++fan) {
        patches.is_locked[fan] = fan_counts[patches.vertex_of[fan]] > 1;
    }
    const std::span<const Triangle> triangles = patches.fans.triangles;
    for (HalfEdgeId h = 0; h < patches.fans.uses_of_border.size(); ++h) {
        if (patches.fans.uses_of_border[h] > 1) {
            patches.is_locked[start_of(triangles, h)] = true;
            patches.is_locked[end_of(triangles, h)] = true;
        }
    }
    return patches;
}

std::vector<std::uint32_t> labels_of(const SimplifiedMesh& part,
                                     std::span<const std::uint32_t> labels) {
    std::vector<std::uint32_t> picked;
    picked.reserve(part.origins.size());
    for (const TriangleId id : part.origins) {
        picked.push_back(labels[id]);
    }
    return picked;
}

/// Coplanar regions triangulated anew; origins stay those of the mesh that `part` came from.
SimplifiedMesh merged(const SimplifiedMesh& part,
                      std::span<const std::uint32_t> labels,
                      Executor& executor) {
    SimplifiedMesh result =
        merge_planar_regions(part.mesh.view(), labels_of(part, labels), executor);
    for (TriangleId& origin : result.origins) {
        origin = part.origins[origin];
    }
    return result;
}

/// Positions of the vertices that are left, moved onto the planes of large facets.
std::vector<Vec3> sharpened(std::span<const std::uint32_t> labels,
                            const Patches& patches,
                            std::span<const DecimatedTriangle> left,
                            double max_distance,
                            Executor& executor) {
    const MeshView surface{patches.positions, patches.fans.triangles};
    std::vector<VertexId> weld(surface.positions.size());
    std::iota(weld.begin(), weld.end(), VertexId{0});
    const Facets facets = find_facets(surface, weld, labels, executor);
    std::vector<bool> is_fixed = patches.is_locked;
    const SurfaceCurves curves(surface, labels, 0);
    for (VertexId vertex = 0; vertex < is_fixed.size(); ++vertex) {
        is_fixed[vertex] = is_fixed[vertex] || curves.is_on_curve(vertex);
    }
    return place_on_planes(
        {.mesh = surface, .facets = facets, .is_fixed = is_fixed}, left, max_distance);
}

/// What decimation has left of a mesh, with its windings.
SimplifiedMesh joined(const SimplifiedMesh& before,
                      const Patches& patches,
                      std::span<const DecimatedTriangle> left) {
    SimplifiedMesh result;
    std::vector<VertexId> number(before.mesh.positions.size(), kUnused);
    for (const DecimatedTriangle& one : left) {
        Triangle triangle = one.corners;
        if (patches.fans.is_flipped[one.origin]) {
            std::swap(triangle[1], triangle[2]);
        }
        for (VertexId& fan : triangle) {
            VertexId& new_id = number[patches.vertex_of[fan]];
            if (new_id == kUnused) {
                new_id = static_cast<VertexId>(result.mesh.positions.size());
                result.mesh.positions.push_back(patches.positions[fan]);
            }
            fan = new_id;
        }
        result.mesh.triangles.push_back(triangle);
        result.origins.push_back(before.origins[one.origin]);
    }
    return result;
}

}  // namespace

void validate(const SimplifyOptions& options) {
    const auto check = [](bool is_right, const char* subject, const char* range) {
        if (!is_right) {
            throw Error(subject, "is out of range", range);
        }
    };
    // Written so that what is not a number fails.
    check(options.max_distance >= 0.0 && options.max_distance <= 1e6,
          "distance of simplification",
          "give 0 to 1e6 metres");
    check(options.max_angle >= 0.0 && options.max_angle <= kPi,
          "angle of simplification",
          "give 0 to pi radians");
    check(options.max_aspect_ratio >= 1.0 && options.max_aspect_ratio <= 1e9,
          "aspect ratio of simplification",
          "give 1 to 1e9");
    check(options.samples_per_edge >= 0 && options.samples_per_edge <= 100,
          "samples per edge",
          "give 0 to 100");
}

bool simplify_available() noexcept {
    return topology_available();
}

SimplifiedMesh simplify(const MeshView& mesh,
                        std::span<const std::uint32_t> labels,
                        const SimplifyOptions& options,
                        Executor& executor) {
    validate(options);
    const SimplifiedMesh part = merged(cleaned(mesh, executor), labels, executor);
    Patches patches = patches_of(part.mesh);
    const std::vector<std::uint32_t> part_labels = labels_of(part, labels);
    const std::vector<DecimatedTriangle> left =
        decimate({.mesh = {patches.positions, patches.fans.triangles},
                  .labels = part_labels,
                  .is_locked = patches.is_locked},
                 {.max_distance = options.max_distance,
                  .max_angle = options.max_angle,
                  .max_aspect_ratio = options.max_aspect_ratio,
                  .samples_per_edge = options.samples_per_edge});
    if (options.sharpen) {
        patches.positions = sharpened(part_labels, patches, left, options.max_distance, executor);
    }
    return merged(joined(part, patches, left), labels, executor);
}

}  // namespace earshot::geometry
