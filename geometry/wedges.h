// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/floating_point.h"
#include "earshot/geometry/facets.h"
#include "earshot/geometry/wedge.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace earshot::geometry {

/// Which facets make wedges. Both spans are per facet or empty.
struct WedgeOptions {
    /// 1 where sound sees the front side only. Empty: both sides are surfaces everywhere.
    std::span<const std::uint8_t> one_sided{};
    /// 1 where sound passes: such a facet is no face of a wedge and bounds no air.
    std::span<const std::uint8_t> transmissive{};
};

/// |sin(pi^2 / open angle)| up to which an edge is left out: the images in a corner of pi / n are
/// the whole field, and at a whole pi there is no edge. What is left out would diffract less than
/// a thousandth of a half plane.
inline constexpr double kMinWedgeSine = 1e-3;

/// The edges that diffract: borders of facets at which the air takes up an angle other than pi / n.
/// These are outer edges, borders of thin plates and, for other angles, inner corners. On every
/// line where facets end, the half-planes of all facets there are sorted by angle, also of those
/// that lie beside and pass through it, and each gap between two is a sector of air. So
/// T-junctions, three and more facets at an edge and bodies that stand on a floor need no rule of
/// their own; coplanar neighbours make no edge; pieces of a line between the same faces are one
/// wedge.
///
/// The result depends on the facets alone, and is the same bits however axis-aligned walls are cut
/// into triangles. Ordered by the lowest facet of the line, then along the line, then by angle.
/// O(n log n) in the edges of outlines unless many facets lie in one place.
std::vector<Wedge> find_wedges(const Facets& facets, const WedgeOptions& options = {});

/// find_wedges() for facets that move: what their positions leave alone is kept.
class WedgeFinder {
public:
    WedgeFinder();
    WedgeFinder(WedgeFinder&&) noexcept;
    WedgeFinder& operator=(WedgeFinder&&) noexcept;
    ~WedgeFinder();

    /// The bits of find_wedges(), whatever was found before; valid until the next call. An edge
    /// whose ends stay is not sought again among the others, and a line is kept with its wedges
    /// while all facets that touch it stay as they are and where they are.
    const std::vector<Wedge>& find(const Facets& facets, const WedgeOptions& options = {});

    /// Of the last call: lines with outline edges, and how many of these were kept.
    std::size_t lines() const noexcept;
    std::size_t kept_lines() const noexcept;

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace earshot::geometry
