// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/frustum/internal/facet_index.h"
#include "earshot/frustum/internal/frustum.h"
#include "earshot/frustum/internal/visible_facets.h"
#include "earshot/frustum/internal/window_sight.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace earshot::frustum {

/// Items that are kept for a facet, each with a point; a multiple of eight, filled up with points
/// that are not numbers.
template <typename Item>
class PerFacet {
public:
    /// `items`: with their facets, in any order; those of a facet keep theirs.
    struct Entry {
        geometry::FacetId facet = 0;
        geometry::Vec3 point{0.0};
        Item item;
    };
    PerFacet() = default;
    PerFacet(std::size_t facets, std::span<const Entry> entries);

    std::span<const Item> items(geometry::FacetId facet) const noexcept {
        return std::span(items_).subspan(kWidth * first_[facet],
                                         kWidth * (first_[facet + 1] - first_[facet]));
    }
    std::span<const PointBlock> points(geometry::FacetId facet) const noexcept {
        return std::span(points_).subspan(first_[facet], first_[facet + 1] - first_[facet]);
    }

private:
    static constexpr std::size_t kWidth = PointBlock::kWidth;
    std::vector<std::uint32_t> first_;  // block of each facet, and one past the last
    std::vector<Item> items_;
    std::vector<PointBlock> points_;
};

/// The last reflection on the way to a listener, known by where it is kept: with the listener
/// mirrored in the facet.
struct LastFacet {
    std::uint32_t listener = 0;
};

/// The last two reflections on the way to a listener, the last but one known by where it is kept:
/// with the listener mirrored in the last facet, then in the one before.
struct LastPair {
    geometry::FacetId last = 0;
    std::uint32_t listener = 0;
    std::uint32_t frustum = 0;  ///< of the listener's, mirrored in the last facet
    Rect window;                ///< where it sees the facet before
    bool grazes = false;        ///< it may see it anywhere
};

/// What frusta from the listeners see: sound comes the way it goes, so the facets that a frustum
/// from a listener sees, and those that it sees in them, are the only ones in which paths to it can
/// end (complete mode). Where a frustum from the source and one from the listener see the same
/// facet, they meet there, and neither needs to be followed further.
class ListenerSide {
public:
    /// `reach`: the largest distance of a source or listener from the origin, metres. `with_pairs`:
    /// whether the last but one reflections are wanted.
    ListenerSide(const FacetIndex& index,
                 double contact_reach,
                 double reach,
                 std::span<const geometry::Vec3> listeners,
                 bool with_pairs,
                 Executor& executor);

    /// The listeners that may see a facet.
    const PerFacet<LastFacet>& last() const noexcept { return last_; }

    /// The ways on from a facet to every listener.
    const PerFacet<LastPair>& pairs() const noexcept { return pairs_; }

    /// Facets in whose plane a listener lies, as far as rounding can tell: no frustum leads there,
    /// so any facet may come before.
    struct Grazed {
        geometry::FacetId facet = 0;
        std::uint32_t listener = 0;
    };
    std::span<const Grazed> grazed() const noexcept { return grazed_; }

    /// Whether sound from an image source, its last mirror the facet that `pair` is kept for, may
    /// come from within the listener's frustum.
    bool may_come_from(const LastPair& pair, const geometry::Vec3& image_source) const noexcept;

    std::size_t frusta() const noexcept { return frusta_.size(); }

private:
    struct Seen {
        std::uint32_t listener = 0;
        geometry::FacetId facet = 0;
    };
    struct Mirrored {
        std::uint32_t listener = 0;
        Frustum frustum;
    };

    void look_around(std::span<const geometry::Vec3> listeners,
                     double contact_reach,
                     Executor& executor);
    void look_into_facets(std::span<const geometry::Vec3> listeners,
                          double contact_reach,
                          Executor& executor);

    const FacetIndex& index_;
    double reach_;
    std::vector<Mirrored> frusta_;
    PerFacet<LastFacet> last_;
    PerFacet<LastPair> pairs_;
    std::vector<Grazed> grazed_;
};

}  // namespace earshot::frustum
