// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/bvh/better_hit.h"
#include "earshot/bvh/tree.h"
#include "earshot/bvh/wide_tree.h"
#include "earshot/geometry/mesh.h"
#include "earshot/geometry/types.h"

#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace earshot::bvh {

using PartId = std::uint32_t;
using InstanceId = std::uint32_t;

/// Where a ray meets an instance.
struct InstanceHit {
    InstanceId instance = 0;
    geometry::Hit
        hit{};  ///< triangle, u and v are the part's; t is in multiples of the ray as asked

    friend bool operator==(const InstanceHit&, const InstanceHit&) = default;
};

/// The order of hits of instances: by t, then by InstanceId, then by TriangleId.
constexpr bool better_hit(const InstanceHit& a, const InstanceHit& b) noexcept {
    return a.hit.t == b.hit.t && a.instance != b.instance ? a.instance < b.instance
                                                          : better_hit(a.hit, b.hit);
}

/// A two-level hierarchy. On the bottom level every part, a mesh, has a hierarchy of its own; the
/// top level is a hierarchy over the boxes of instances, each of which is a part and a transform
/// into the world. Rigid parts move by set_transform(), which costs nothing per triangle; a mesh
/// that deforms or comes and goes is a part with one instance, and refit_part() touches no other.
/// After changes update() must be called before queries. Answers depend on the scene, not on its
/// history, but for the ids: the lowest free one is given out.
class Instances {
public:
    /// Takes O(n log n). Precondition: the mesh's arrays stay where they are until the part is
    /// removed or refitted to others. Throws Error as Tree::build() and WideTree::build() do.
    PartId add_part(const geometry::MeshView& mesh,
                    const BuildOptions& options = {},
                    Executor& executor = Executor::serial());

    /// Moves a part's triangles to where the mesh's vertices are now. O(n) of that part.
    /// Precondition: the mesh has the part's triangles.
    void refit_part(PartId part,
                    const geometry::MeshView& mesh,
                    Executor& executor = Executor::serial());

    /// Precondition: no instance of it is left.
    void remove_part(PartId part);

    /// Adds an instance of a part. The matrix is affine (its bottom row is taken as 0, 0, 0, 1) and
    /// leads from the part's space into the world. Throws Error if it is not finite or has no
    /// inverse.
    InstanceId add_instance(PartId part, const glm::dmat4& transform = glm::dmat4(1.0));

    /// Throws Error as add_instance() does. Precondition: the instance exists, here and in
    /// remove_instance().
    void set_transform(InstanceId instance, const glm::dmat4& transform);
    void remove_instance(InstanceId instance);

    /// Brings the top level up to date: rebuilt if instances were added or removed, or have moved
    /// so far that its SAH cost is 40 % greater than when it was built (Lauterbach 2010), otherwise
    /// refitted. O(n log n) in the instances.
    void update(Executor& executor = Executor::serial());

    bool is_up_to_date() const noexcept { return change_ == Change::none; }

    struct Part {
        geometry::MeshView mesh{};
        WideTree tree{};
        std::size_t instances = 0;
        bool exists = false;  ///< was added and not removed
    };

    /// An instance in the world; a point p of the part stands at linear * p + translation.
    struct Instance {
        InstanceId id = 0;
        PartId part = 0;
        glm::dmat3 linear{1.0};
        glm::dmat3 inverse_linear{1.0};
        geometry::Vec3 translation{0.0};
        geometry::Aabb box{};  ///< of the part in the world, rounded outward

        /// The ray in the part's space; the same t is the same point.
        geometry::Ray to_local(const geometry::Ray& ray, double t_max) const noexcept {
            return {
                inverse_linear * (ray.origin - translation), inverse_linear * ray.direction, t_max};
        }
        geometry::Segment to_local(const geometry::Segment& segment) const noexcept {
            return {inverse_linear * (segment.from - translation),
                    inverse_linear * (segment.to - translation)};
        }
    };

    /// The instances whose part has triangles, by id: the primitives of the top level.
    std::span<const Instance> active_instances() const noexcept { return active_instances_; }
    const Part& part(PartId id) const noexcept { return parts_[id]; }
    /// Primitive i is active_instances()[i].
    const Tree& top_level() const noexcept { return top_level_; }

private:
    /// What has happened since the last update, the less costly first.
    enum class Change { none, moved, added_or_removed };

    void note(Change change) noexcept { change_ = change > change_ ? change : change_; }

    std::vector<Part> parts_;
    std::vector<std::optional<Instance>> instances_;  // by id, without boxes
    std::vector<PartId> free_parts_;                  // heaps with the lowest on top
    std::vector<InstanceId> free_instances_;
    std::vector<Instance> active_instances_;
    Tree top_level_;
    double built_sah_cost_ = 0.0;  // of the top level when it was built
    Change change_ = Change::none;
};

/// The closest hit; of hits at the same t the lowest InstanceId, then the lowest TriangleId.
///
/// The decision is made in the part's space, where the ray is carried by the inverse matrix without
/// being normalised: an instance is hit where closest_hit() of ray.h finds its part hit, at a t
/// clamped to the interval of the ray in the instance's box, which must not be empty. So no top
/// level changes an answer. Rounding the ray into the part's space shifts it by some 2^-50 of the
/// coordinates, times the ratio of the matrix's largest to its smallest scale: surfaces that meet
/// across instances are not watertight within that. Up to a ratio of 2^10 the padding of boxes
/// makes up for it (see geometry::SlabTest); beyond, hits at the border of a box may be lost.
std::optional<InstanceHit> closest_hit(const Instances& instances,
                                       const geometry::Ray& ray) noexcept;

/// Whether the closed segment crosses the box of an instance and shares a point with a triangle of
/// its part, decided exactly for the segment as rounded into the part's space. False if a
/// coordinate is not finite.
bool occluded(const Instances& instances, const geometry::Segment& segment) noexcept;

/// The closest hits of many rays and the occlusion of many segments, in their order; the same for
/// any executor.
std::vector<std::optional<InstanceHit>> closest_hits(const Instances& instances,
                                                     std::span<const geometry::Ray> rays,
                                                     Executor& executor = Executor::serial());
std::vector<std::uint8_t> occluded(const Instances& instances,
                                   std::span<const geometry::Segment> segments,
                                   Executor& executor = Executor::serial());

}  // namespace earshot::bvh
