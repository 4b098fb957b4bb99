// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/frustum/internal/facet_index.h"
#include "earshot/frustum/internal/frustum.h"
#include "earshot/frustum/internal/points_by_facet.h"
#include "earshot/frustum/internal/visible_facets.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace earshot::frustum {

/// A facet that may be the last reflection on the path to a listener. It is stored under that facet
/// with the listener mirrored in it as its point.
struct LastReflection {
    std::uint32_t listener = 0;
};

/// Two facets that may be the last two reflections on the path to a listener. They are stored under
/// the last but one, with the listener mirrored in the last facet, then in the last but one, as
/// their point.
struct LastTwoReflections {
    geometry::FacetId last = 0;
    std::uint32_t listener = 0;
    std::uint32_t beam = 0;  ///< the listener's frustum, mirrored in the last facet
    Rect aperture;           ///< where the last but one facet is visible in that frustum
    bool grazing = false;    ///< the aperture is unknown, see VisibleFacet::grazing
};

/// The beam trees of some listeners, two reflections deep, for bidirectional tracing. Sound paths
/// are reversible, so the facets visible from a listener, and those visible in its mirrored frusta,
/// are the only ones in which paths to it can end (complete mode):
///
///     source --> f1 --> ... --> f(n-2) --> f(n-1) <-- f(n) <-- listener
///     |  beam tree of the source  |          |   beam tree   |
///
/// Where a frustum from the source and one from a listener have a visible facet in common, the two
/// trees are connected, and neither is traced further.
class ListenerBeams {
public:
    /// `max_radius`: the largest distance of a source or listener from the origin, metres.
    /// `two_reflections`: whether the last but one reflections are wanted too.
    ListenerBeams(const FacetIndex& index,
                  double contact_radius,
                  double max_radius,
                  std::span<const geometry::Vec3> listeners,
                  bool two_reflections,
                  Executor& executor);

    const PointsByFacet<LastReflection>& last_reflections() const noexcept {
        return last_reflections_;
    }

    const PointsByFacet<LastTwoReflections>& last_two_reflections() const noexcept {
        return last_two_reflections_;
    }

    /// A facet in whose plane a listener lies, as far as rounding can tell: no frustum leads there,
    /// so any facet may be the last but one.
    struct GrazingFacet {
        geometry::FacetId facet = 0;
        std::uint32_t listener = 0;
    };
    std::span<const GrazingFacet> grazing_facets() const noexcept { return grazing_facets_; }

    /// Whether sound from an image source, last mirrored in the facet that `reflections` is stored
    /// under, may arrive through the aperture in the listener's frustum.
    bool may_arrive_from(const LastTwoReflections& reflections,
                         const geometry::Vec3& image_source) const noexcept;

    std::size_t frusta() const noexcept { return beams_.size(); }

private:
    struct VisiblePair {
        std::uint32_t listener = 0;
        geometry::FacetId facet = 0;
    };
    struct ReflectedBeam {
        std::uint32_t listener = 0;
        Frustum frustum;
    };

    void trace_first_beams(std::span<const geometry::Vec3> listeners,
                           double contact_radius,
                           Executor& executor);
    void trace_reflected_beams(std::span<const geometry::Vec3> listeners,
                               double contact_radius,
                               Executor& executor);

    const FacetIndex& index_;
    double max_radius_;
    std::vector<ReflectedBeam> beams_;
    PointsByFacet<LastReflection> last_reflections_;
    PointsByFacet<LastTwoReflections> last_two_reflections_;
    std::vector<GrazingFacet> grazing_facets_;
};

}  // namespace earshot::frustum
