// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/frustum/internal/aperture_test.h"
#include "earshot/frustum/internal/facet_index.h"
#include "earshot/frustum/internal/facet_tree.h"
#include "earshot/frustum/internal/frustum.h"
#include "earshot/frustum/internal/occlusion_grid.h"
#include "earshot/frustum/internal/outline_view.h"
#include "earshot/frustum/paths.h"

#include <optional>
#include <span>
#include <vector>

namespace earshot::frustum {

/// A facet that may be visible in a frustum.
struct VisibleFacet {
    geometry::FacetId facet = 0;
    Rect aperture;       ///< bounds of its visible part, in (u, v)
    CellMask cells = 0;  ///< sub-frusta in which it may be visible
    /// The apex may lie in the facet's plane, so that the visible part of the facet is unknown and
    /// the aperture is the whole frustum. Only with GrazingFacets::keep.
    bool grazing = false;
};

/// Whether the straight line from a frustum's apex to an unfolded point (mirrored as often as the
/// path to it reflects) may pass a facet that is visible in the frustum. Conservative; occluders
/// between the facet and the point are ignored. `position_error`: of either end, metres.
bool may_pass(const Frustum& frustum,
              const VisibleFacet& visible,
              const geometry::Vec3& unfolded,
              double position_error) noexcept;

/// The treatment of facets whose plane contains a frustum's apex. A facet reflects no sound from a
/// source in its plane, so such facets are skipped in beam trees of sources. The last reflection on
/// a path to a listener may be in such a facet, so they are kept in beam trees of listeners.
enum class GrazingFacets { skip, keep };

/// Finds the facets that sound in a frustum can hit first. An object holds scratch memory and is
/// used for many frusta in sequence, by one thread at a time.
///
/// complete: the result is a superset of the facets on which a valid path through the frustum can
/// reflect next (docs/algorithms/frustum.md has the proof). A facet is left out only where another
/// facet, which lies more than `contact_radius` in front of it, covers a whole sub-frustum.
/// sampled: the closest facet along the centre of each sub-frustum.
class VisibleFacets {
public:
    /// `contact_radius` in metres, as PathVerifier::contact_radius; `max_radius`: the largest
    /// distance of a source or listener from the origin, metres.
    VisibleFacets(const FacetIndex& index,
                  Mode mode,
                  double contact_radius,
                  double max_radius,
                  GrazingFacets grazing_facets = GrazingFacets::skip);

    /// Makes this the current frustum without a search: it has no visible facets and no occluders.
    void set_frustum(const Frustum& frustum);

    /// The same with facets that are known to be visible in it.
    void set_frustum(const Frustum& frustum, std::span<const VisibleFacet> visible);

    /// Makes this the current frustum and finds the facets that are visible in it.
    void search(const Frustum& frustum);

    const Frustum& frustum() const noexcept { return frustum_; }

    /// The facets that are visible in the current frustum, approximately in order of depth.
    const std::vector<VisibleFacet>& found() const noexcept { return visible_facets_; }

    /// Removes from found() the facets whose entry in `mask` (one per facet of the scene) is 0.
    /// They still occlude.
    void filter(std::span<const std::uint8_t> mask);

    /// Whether sound in the current frustum may arrive at the point: false only if every
    /// sub-frustum that may contain it is inactive or occluded in front of the point.
    bool may_arrive_at(const geometry::Vec3& point) const noexcept;

    /// Whether may_arrive_at() some point of a straight line, conservatively.
    bool may_arrive_on(const geometry::Vec3& begin, const geometry::Vec3& end) const noexcept;

    /// A test that passes a superset of the points for which may_pass() is true, once it is given
    /// the aperture of a visible facet.
    ApertureTest aperture_test() const noexcept;

    /// Whether the straight line from the current frustum's apex to an unfolded point (mirrored as
    /// often as the path to it reflects) may pass a visible facet. Conservative; occluders between
    /// the facet and the point are ignored.
    bool may_pass(const VisibleFacet& visible, const geometry::Vec3& unfolded) const noexcept;

    /// Whether sound in the current frustum may arrive at the point after one more reflection, in a
    /// visible facet.
    bool may_reflect_to(const VisibleFacet& visible, const geometry::Vec3& point) const noexcept;

    /// Culls boxes that do not overlap the current frustum.
    BoxCull box_cull() const noexcept;

    /// Whether a box may overlap an active sub-frustum of the current frustum in front of its
    /// occluder, given that the frustum's box_cull() does not cull it.
    bool may_overlap(const geometry::Aabb& box, const OccluderDepths& occluders) const noexcept;

    /// Of the last search.
    OccluderDepths occluder_depths() const noexcept { return occlusion_.max_depths(); }

    /// The part of the current frustum that a visible facet reflects.
    Frustum reflect(const VisibleFacet& visible);

private:
    struct Projected {
        Coverage coverage;
        Rect bounds;                // of the drawn polygon, grown by its slack
        std::uint32_t crossed = 0;  // if it needs clipping: OutlineBounds::crossed
    };
    struct Candidate {
        geometry::FacetId facet = 0;
        InverseDepth depth;  // scaled up by its error
        CellMask outer = 0;
        Rect bounds;
    };

    /// What a frustum may contain of a node or facet: something in `cells`, no closer than
    /// `min_depth` (0: at any depth).
    struct Seen {
        std::uint32_t child = 0;                     // as in a FacetNode
        double centre_depth = 0.0, min_depth = 0.0;  // metres
        CellMask cells = 0;
    };

    void visit_nodes();
    void push_children(const FrustumBoxTest& test, const FacetNode& node);
    CellMask cells_with_centre_in(const ChildBounds& boxes, std::size_t i) const noexcept;
    bool is_occluded(const Seen& seen) const noexcept;
    void visit_facet(geometry::FacetId facet);
    OutlineView outline_view(const Frustum& frustum, const CoverageRaster& raster) const noexcept;
    bool draw(const OutlineView& view,
              const Rect& rect,
              CoverageRaster& raster,
              geometry::FacetId facet,
              bool centres_only,
              Projected& out);
    enum class DrawResult { outside, done, needs_clipping };
    DrawResult draw_whole(const OutlineView& view,
                          const Rect& rect,
                          CoverageRaster& raster,
                          geometry::FacetId facet,
                          double position_error,
                          bool centres_only,
                          Projected& out);
    bool draw_clipped(const OutlineView& view,
                      const Rect& rect,
                      CoverageRaster& raster,
                      geometry::FacetId facet,
                      double position_error,
                      bool centres_only,
                      Projected& out);
    struct ClipPlanes;
    std::span<const geometry::Vec3> local(const ClipPlanes& planes,
                                          std::span<const geometry::Vec3> vertices);
    std::span<const geometry::Vec3> clip(const ClipPlanes& planes,
                                         std::uint32_t half_spaces,
                                         std::span<const geometry::Vec3> polygon);
    bool is_near(const ClipPlanes& planes,
                 const Rect& rect,
                 const CoverageRaster& raster,
                 std::span<const geometry::Vec3> polygon) const noexcept;
    void add_occluder(geometry::FacetId facet,
                      double height,
                      const InverseDepth& depth,
                      CellMask inner);
    double max_grazing_height() const noexcept;
    double depth_error(double height) const noexcept;
    CellMask cells_overlapping(const Rect& bounds, double depth) const noexcept;
    bool all_occlude_depth(double depth, CellMask cells) const noexcept;
    struct BoxBounds {
        Rect bounds;             // in (u, v)
        double min_depth = 0.0;  // metres
    };
    std::optional<BoxBounds> bounds_of(const geometry::Aabb& box) const noexcept;
    void collect_found();
    Rect bounds_of_cells(CellMask cells) const noexcept;

    const FacetIndex& index_;
    Mode mode_;
    double contact_radius_;
    double max_radius_;
    GrazingFacets grazing_facets_;

    Frustum frustum_;
    CoverageRaster raster_;
    OutlineView outline_view_{};  // of both
    OcclusionGrid occlusion_;
    double position_error_ = 0.0;     // metres, of constructed points: rounding
    InverseDepth start_depth_limit_;  // an occluder must lie beyond it
    std::vector<Candidate> candidates_;
    std::vector<VisibleFacet> visible_facets_;
    std::vector<Seen> stack_;
    std::vector<geometry::Vec3> polygon_, clipped_;  // vertices along the frustum's axes
    std::vector<glm::dvec2> outline_;
};

}  // namespace earshot::frustum
