// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
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

/// A scene of two levels: parts, each a mesh with a hierarchy of its own, stand in the world as
/// often as one likes, and a small hierarchy over the instances' boxes finds them. Rigid parts move
/// by move(), which costs nothing per triangle; a mesh that deforms or comes and goes is a part
/// with one instance, and refit_part() touches no other. After changes, update() must be called
/// before questions are asked. Answers depend on what is in the scene, not on how it got there, but
/// for the ids: the lowest one that is free is given out.
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

    /// Puts a part into the world. The matrix is affine (its bottom row is taken as 0, 0, 0, 1) and
    /// leads from the part's space into the world. Throws Error if it is not finite or has no
    /// inverse.
    InstanceId insert(PartId part, const glm::dmat4& placement = glm::dmat4(1.0));

    /// Throws Error as insert() does. Precondition: the instance exists, here and in remove().
    void move(InstanceId instance, const glm::dmat4& placement);
    void remove(InstanceId instance);

    /// Brings the upper level up to date: rebuilt if instances came, went, or have moved so far
    /// that it costs 40 % more than when it was built (Lauterbach 2010), otherwise refitted.
    /// O(n log n) in the instances.
    void update(Executor& executor = Executor::serial());

    bool is_up_to_date() const noexcept { return change_ == Change::none; }

    struct Part {
        geometry::MeshView mesh{};
        WideTree tree{};
        std::size_t instances = 0;
        bool exists = false;  ///< was added and not removed
    };

    /// An instance in the world; a point p of the part stands at linear * p + origin.
    struct Instance {
        InstanceId id = 0;
        PartId part = 0;
        glm::dmat3 linear{1.0};
        glm::dmat3 inverse{1.0};  ///< of `linear`
        geometry::Vec3 origin{0.0};
        geometry::Aabb box{};  ///< holds the part, rounded outward

        /// The ray in the part's space; t means the same place.
        geometry::Ray into_part(const geometry::Ray& ray, double most) const noexcept {
            return {inverse * (ray.origin - origin), inverse * ray.direction, most};
        }
        geometry::Segment into_part(const geometry::Segment& segment) const noexcept {
            return {inverse * (segment.from - origin), inverse * (segment.to - origin)};
        }
    };

    /// The instances whose part has triangles, by id; what the upper level is built over.
    std::span<const Instance> placed() const noexcept { return placed_; }
    const Part& part(PartId id) const noexcept { return parts_[id]; }
    /// Primitive i is placed()[i].
    const Tree& upper_level() const noexcept { return upper_level_; }

private:
    enum class Change { none, moved, replaced };

    void note(Change change) noexcept { change_ = change > change_ ? change : change_; }

    std::vector<Part> parts_;
    std::vector<std::optional<Instance>> instances_;  // by id, their boxes not yet known
    std::vector<PartId> free_parts_;                  // heaps with the lowest on top
    std::vector<InstanceId> free_instances_;
    std::vector<Instance> placed_;
    Tree upper_level_;
    double built_cost_ = 0.0;
    Change change_ = Change::none;
};

/// The nearest hit; of hits at the same t the lowest InstanceId, then the lowest TriangleId.
///
/// The decision is made in the part's space, where the ray is carried by the inverse matrix without
/// being normalised: an instance is hit where closest_hit() of ray.h finds its part hit, at a t
/// moved into the ray's passage through the instance's box, which it must pass. So no upper level
/// changes an answer. Rounding the ray into the part's space shifts it by some 2^-50 of the
/// coordinates, times the ratio of the matrix's largest to its smallest scale: surfaces that meet
/// across instances are not watertight within that. Up to a ratio of 2^10 the padding of boxes
/// makes up for it (see geometry::Slabs); beyond, hits at the border of a box may be lost.
std::optional<InstanceHit> closest_hit(const Instances& scene, const geometry::Ray& ray) noexcept;

/// Whether the closed segment passes the box of an instance and shares a point with a triangle of
/// its part, decided exactly for the segment as rounded into the part's space. False if a
/// coordinate is not finite.
bool occluded(const Instances& scene, const geometry::Segment& segment) noexcept;

/// The same for many questions, in their order, the same for any executor.
std::vector<std::optional<InstanceHit>> closest_hits(const Instances& scene,
                                                     std::span<const geometry::Ray> rays,
                                                     Executor& executor = Executor::serial());
std::vector<std::uint8_t> occluded(const Instances& scene,
                                   std::span<const geometry::Segment> segments,
                                   Executor& executor = Executor::serial());

}  // namespace earshot::bvh
