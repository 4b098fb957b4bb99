// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/frustum/internal/listener_points.h"
#include "earshot/frustum/internal/listener_side.h"
#include "earshot/frustum/internal/visible_facets.h"
#include "earshot/frustum/path_verifier.h"

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace earshot::frustum {

/// What one task of a search brings home.
struct Harvest {
    std::vector<SpecularPath> paths;
    TraceStatistics statistics;

    void append(Harvest&& other);
};

/// The listeners of a search, and how they are found.
struct Audience {
    std::span<const geometry::Vec3> listeners;
    const ListenerSide* side = nullptr;      ///< meets the source's frusta half-way
    const ListenerPoints* points = nullptr;  ///< where there is no side
};

/// Turns what frusta see into facet sequences for the listeners, and has them verified. Follows one
/// way through the tree of frusta; one object per thread of work.
class Proposer {
public:
    Proposer(const FacetIndex& index,
             const PathVerifier& verifier,
             const Audience& audience,
             const TraceOptions& options,
             double reach,
             const geometry::Vec3& source);

    /// Makes the way one facet longer.
    void push(geometry::FacetId facet);
    void pop();
    std::size_t order() const noexcept { return sequence_.size(); }

    /// The direct path to every listener.
    void propose_direct();

    /// Proposes paths that end in the current frustum of `search`, or in a facet that it sees, or
    /// one after. `seen`: what it found. Precondition: the way led to this frustum.
    void propose_from(const VisibleFacets& search, std::span<const VisibleFacet> seen);

    Harvest take_harvest() { return std::move(harvest_); }

private:
    /// Calls meet(item) for what is kept for a visible facet, where a line to its point may pass
    /// what is seen of the facet.
    template <typename Item, typename Meet>
    void for_each_in_sight(const VisibleFacets& search,
                           const VisibleFacet& visible,
                           const PerFacet<Item>& kept,
                           Meet&& meet);
    void meet_listeners(const VisibleFacets& search, const VisibleFacet& visible);
    void meet_pairs(const VisibleFacets& search, const VisibleFacet& visible);
    void meet_grazed(const VisibleFacets& search, const VisibleFacet& visible);
    void look_for_listeners(const VisibleFacets& search, std::span<const VisibleFacet> seen);
    void propose(std::size_t listener);
    bool is_wanted(double length) const noexcept;

    const FacetIndex& index_;
    const PathVerifier& verifier_;
    const Audience& audience_;
    TraceOptions options_;
    double reach_;
    std::vector<geometry::FacetId> sequence_;
    std::vector<geometry::Vec3> images_;
    WindowSight sight_;  // of the current frustum
    std::vector<std::uint8_t> in_sight_;
    Harvest harvest_;
};

}  // namespace earshot::frustum
