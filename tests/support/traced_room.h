// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/bvh/deformable_bvh.h"
#include "earshot/frustum/paths.h"
#include "earshot/frustum/surface_points.h"
#include "earshot/geometry/clean.h"
#include "earshot/geometry/facets.h"

#include "support/path_facts.h"
#include "support/rooms.h"
#include <cstdint>
#include <span>
#include <vector>

namespace earshot::support {

/// A mesh made ready for the tracer the way a scene is: cleaned, grouped into facets, put into a
/// hierarchy. Triangles of the paths are numbered as in the mesh given.
class TracedRoom {
public:
    /// `one_sided_labels`: per label 1 if its triangles reflect on their front only; missing
    /// labels reflect on both sides.
    TracedRoom(const geometry::Mesh& mesh,
               std::span<const std::uint32_t> labels,
               std::span<const std::uint8_t> one_sided_labels = {});
    explicit TracedRoom(const Room& room) : TracedRoom(room.mesh, room.labels) {}

    frustum::TraceResult trace(const geometry::Vec3& source,
                               std::span<const geometry::Vec3> listeners,
                               const frustum::TraceOptions& options = {},
                               Executor& executor = Executor::serial()) const;

    /// The same for points that may lie on surfaces.
    frustum::TraceResult trace_placed(const frustum::PlacedPairs& pairs,
                                      const frustum::TraceOptions& options = {}) const;
    frustum::PlacedPairs place(const geometry::Vec3& source,
                               std::span<const geometry::Vec3> listeners) const;

    /// The paths of one listener.
    std::vector<frustum::SpecularPath> paths(const geometry::Vec3& source,
                                             const geometry::Vec3& listener,
                                             const frustum::TraceOptions& options = {}) const;

    const geometry::Facets& facets() const { return facets_; }
    /// Of the triangles that take part, by their numbers as given.
    std::span<const geometry::TriangleId> numbers() const { return number_; }

private:
    frustum::SceneView scene_view() const;
    frustum::TraceResult renumbered(frustum::TraceResult result) const;

    geometry::Mesh mesh_;
    std::vector<geometry::TriangleId> number_;  // per triangle of mesh_: its index as given
    geometry::Facets facets_;
    std::vector<std::uint8_t> one_sided_;
    bvh::DeformableBvh bvh_;
};

/// The facts of traced paths; `labels` are those of the mesh's triangles.
std::vector<PathFacts> facts_of(std::span<const frustum::SpecularPath> paths,
                                std::span<const std::uint32_t> labels);

}  // namespace earshot::support
