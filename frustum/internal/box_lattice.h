// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/frustum/internal/box_room.h"
#include "earshot/frustum/internal/wall_triangles.h"
#include "earshot/frustum/path_verifier.h"
#include "earshot/frustum/paths.h"
#include "earshot/frustum/scene_view.h"

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

namespace earshot::frustum {

/// The paths of a room that is a box, without frusta: its images form a lattice (Allen and Berkley
/// 1979), and the straight line from an image to a listener crosses the lattice's planes in the
/// order in which the walls reflect. The lattice proposes sequences; points and lengths come from
/// the same routine as PathVerifier's. Where the line passes an edge so close that rounding, or
/// what the room misses of an ideal box, could change the order, PathVerifier decides on every
/// order.
class BoxLattice {
public:
    /// Nothing if the scene is no box. The verifier must outlive the lattice.
    static std::optional<BoxLattice> make(const SceneView& scene,
                                          const PathVerifier& verifier,
                                          const TraceOptions& options);

    /// Whether a point is inside, and so far from every wall that neither rounding nor the room's
    /// errors could put its images on the wrong side of one.
    bool contains(const geometry::Vec3& point) const noexcept;

    /// BoxRoom::is_straight().
    bool is_straight() const noexcept { return room_.is_straight(); }

    /// Every path from a source to a listener, in no order. Nothing if it must be left to frusta:
    /// too many orders are possible. Precondition: both are contained.
    struct Paths {
        std::vector<SpecularPath> paths;
        std::uint64_t candidates = 0;
    };
    std::optional<Paths> find(const geometry::Vec3& source, const geometry::Vec3& listener) const;

    /// One source and one listener: box_search.h.
    struct Search;

private:
    friend class BoxArrivals;

    BoxLattice(const SceneView& scene,
               const PathVerifier& verifier,
               const TraceOptions& options,
               const BoxRoom& room);
    double image_error(int order, double length) const noexcept;

    SceneView scene_;
    const PathVerifier* verifier_;
    TraceOptions options_;
    BoxRoom room_;
    std::array<std::array<WallTriangles, 2>, 3> triangles_;
    double diagonal_ = 0.0;
    double max_length_ = 0.0;  ///< metres: of any path up to the highest order
    double border_ = 0.0;      ///< metres: points of a wall closer to its border may be another's
    double min_height_ = 0.0;  ///< metres above every wall of sources and listeners
};

}  // namespace earshot::frustum
