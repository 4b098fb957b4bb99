// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/frustum/internal/facet_index.h"
#include "earshot/frustum/internal/frustum.h"

#include <cstdint>
#include <span>
#include <vector>

namespace earshot::frustum {

/// A facet that may send sound on to a listener.
struct LastReflection {
    geometry::FacetId facet = 0;
    std::size_t listener = 0;
};

/// Finds the last reflections of paths through a frustum without drawing what it sees: for a given
/// listener only the point in which a facet would reflect matters, and whether that lies in the
/// facet's box and in the frustum costs a few products. What stands in the way is left to the
/// verification. Pays where listeners are few. Holds scratch memory; one thread at a time.
class LastReflections {
public:
    /// `listener_reach`: the largest distance of a listener from the origin, metres.
    LastReflections(const FacetIndex& index, double listener_reach)
        : index_(index), listener_reach_(listener_reach) {}

    /// A superset of the true last reflections, in the order of the hierarchy. The result lives
    /// until the next call.
    std::span<const LastReflection> find(const Frustum& frustum,
                                         std::span<const geometry::Vec3> listeners);

private:
    bool may_reflect(const Frustum& frustum,
                     geometry::FacetId facet,
                     const geometry::Vec3& listener,
                     double moved) const noexcept;

    const FacetIndex& index_;
    double listener_reach_;
    std::vector<LastReflection> found_;
};

}  // namespace earshot::frustum
