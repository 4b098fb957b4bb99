// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/large_array.h"
#include "earshot/bvh/internal/assemble.h"
#include "earshot/bvh/internal/bin_cuts.h"

#include <span>

namespace earshot::bvh {

WideBox joined(const WideBox& a, const WideBox& b) noexcept;
Bounds joined(const Bounds& a, const Bounds& b) noexcept;

/// What every joined() replaces.
Bounds no_bounds() noexcept;

/// The bounds of a run of references.
Bounds bounds_of(std::span<const WideBox> refs) noexcept;

geometry::Aabb finished(const WideBox& box) noexcept;

/// The references to all boxes, and a second array to part them into.
class References {
public:
    References(std::span<const geometry::Aabb> boxes, Executor& executor);

    /// The range of all of them, to be cut and reordered.
    Subtree all() noexcept;

    /// Whether some bounds are not those of the boxes, but kFarthest.
    bool are_clamped() const noexcept;

    /// Builds the subtrees of the tasks and joins them under the top. Uses up the references.
    Tree build(std::span<const TopNode> top,
               std::span<const Subtree> tasks,
               const CutRule& rule,
               Executor& executor) const;

private:
    std::span<const geometry::Aabb> boxes_;
    LargeArray<WideBox> arrays_[2];
    Bounds bounds_;
};

}  // namespace earshot::bvh
