// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/geometry/mesh.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace earshot::visibility {

using ObjectId = std::uint32_t;

/// The objects that visible sets consist of: groups of triangles, each triangle in one. Sets of
/// larger objects are smaller, are complete after fewer rays, and are less precise.
class Objects {
public:
    /// Every triangle is an object of its own.
    static Objects triangles(std::size_t count);

    /// Groups of neighbours, at most `max_triangles` triangles each: the subtrees of a binned_sah
    /// tree over the mesh, in its order. They depend on the mesh alone. Precondition:
    /// max_triangles > 0.
    static Objects groups(const geometry::MeshView& mesh,
                          std::size_t max_triangles,
                          Executor& executor = Executor::serial());

    /// From a grouping made elsewhere. Throws Error unless each number from 0 to the largest
    /// occurs.
    explicit Objects(std::vector<ObjectId> object_of_triangle);

    std::size_t size() const noexcept { return first_.size() - 1; }
    std::span<const ObjectId> object_of_triangle() const noexcept { return object_of_triangle_; }
    ObjectId of(geometry::TriangleId triangle) const noexcept {
        return object_of_triangle_[triangle];
    }
    /// Ascending.
    std::span<const geometry::TriangleId> triangles_of(ObjectId object) const noexcept {
        return std::span(members_).subspan(first_[object], first_[object + 1] - first_[object]);
    }

    friend bool operator==(const Objects&, const Objects&) = default;

private:
    std::vector<ObjectId> object_of_triangle_;
    std::vector<std::size_t> first_;  // per object, and one past the last: its place in members_
    std::vector<geometry::TriangleId> members_;
};

}  // namespace earshot::visibility
