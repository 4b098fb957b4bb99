// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/frustum/internal/frustum.h"
#include "earshot/frustum/internal/geometry_change.h"
#include "earshot/frustum/internal/visible_facets.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace earshot::frustum {

/// Whether the facets that were visible in a frustum at the instant before a change are still a
/// superset of those that sound in it can hit first: none of them has changed, and no swept box
/// overlaps an active sub-frustum in front of its occluder. Then nothing that has changed hid or
/// hides, was or is visible there. `search` has the frustum, by the numbers of now, as its current
/// one. `occluders`: of the instant before.
bool are_still_visible(const VisibleFacets& search,
                       std::span<const VisibleFacet> visible_before,
                       const OccluderDepths& occluders,
                       const GeometryChange& change);

/// Appends unchanged facets under their numbers of now.
void append_renumbered(std::span<const VisibleFacet> visible_before,
                       const GeometryChange& change,
                       std::vector<VisibleFacet>& visible);

/// Appends for each facet that is visible in a frustum where in `visible_before` it is, visible
/// through the same aperture, or kNotBefore. The frustum is the same as before.
void append_positions_before(std::span<const VisibleFacet> visible,
                             std::span<const VisibleFacet> visible_before,
                             const GeometryChange& change,
                             std::vector<std::uint32_t>& positions);

/// The facets visible in each of the frusta around a point.
struct PrimaryFacets {
    std::vector<std::vector<VisibleFacet>> visible;
    std::vector<std::uint8_t> is_kept{};  ///< per frustum: 1 if it was not searched again
    std::size_t kept_frusta() const noexcept;
};

/// find_primary_facets() after a change, which only searches the frusta that it concerns.
PrimaryFacets update_primary_facets(std::span<const Frustum> frusta,
                                    std::span<const std::vector<VisibleFacet>> visible_before,
                                    const GeometryChange& change,
                                    int pieces,
                                    const std::function<VisibleFacets()>& make_search,
                                    Executor& executor);

/// The frusta that a frustum reflected at the instant before, looked up by what it reflects now.
class FrustumLookup {
public:
    /// `number`: what find() returns. Frusta that start at a changed facet are left out.
    void add(const Frustum& before, std::size_t number, const GeometryChange& change);
    void finish();  ///< to be called after the last add()
    void clear() { entries_.clear(); }

    /// The number of the frustum that is the same in every respect.
    std::optional<std::size_t> find(const Frustum& now) const;

private:
    struct Entry {
        Frustum frustum;  // by the numbers of now
        std::size_t number = 0;
    };
    std::vector<Entry> entries_;  // sorted by facet
};

}  // namespace earshot::frustum
