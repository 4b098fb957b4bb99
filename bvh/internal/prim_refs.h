// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/large_array.h"
#include "earshot/bvh/internal/assemble.h"
#include "earshot/bvh/internal/binned_sah.h"

#include <span>

namespace earshot::bvh {

BuildBox united(const BuildBox& a, const BuildBox& b) noexcept;
Bounds united(const Bounds& a, const Bounds& b) noexcept;

/// The identity of united().
Bounds empty_bounds() noexcept;

/// The bounds of references.
Bounds bounds_of(std::span<const PrimRef> refs) noexcept;

geometry::Aabb to_aabb(const BuildBox& box) noexcept;

/// The references to all boxes, and a second array to partition them into.
class PrimRefs {
public:
    PrimRefs(std::span<const geometry::Aabb> boxes, Executor& executor);

    /// The range of all references, to be split and reordered.
    BuildRange root_range() noexcept;

    /// Whether some bounds exceed kMaxCoordinate and were clamped to it.
    bool are_clamped() const noexcept;

    /// Builds the subtrees of the tasks and joins them under the upper levels. The references
    /// are overwritten.
    Tree build_tree(std::span<const TopNode> top,
                    std::span<const BuildRange> tasks,
                    const SplitRule& rule,
                    Executor& executor) const;

private:
    std::span<const geometry::Aabb> boxes_;
    LargeArray<PrimRef> arrays_[2];
    Bounds bounds_;
};

}  // namespace earshot::bvh
