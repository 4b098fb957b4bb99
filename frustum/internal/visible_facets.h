// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/frustum/internal/facet_index.h"
#include "earshot/frustum/internal/frustum.h"
#include "earshot/frustum/internal/window_sight.h"
#include "earshot/frustum/paths.h"

#include <span>
#include <vector>

namespace earshot::frustum {

/// Room for rounding in (u, v), in cells, beyond what follows from a polygon's distance.
inline constexpr double kCellSlack = 0x1p-30;

/// How far a point moves across (forward + u right), in metres per metre that it is off, and how
/// far in u at depth 1: at most 1 + |u|, |u| <= 1 in the grid. Twice that, because outlines are
/// moved along a coordinate axis, up to sqrt(3) times as far as their distance from the plane.
inline constexpr double kSpread = 4.0;

/// A facet that a frustum can see.
struct VisibleFacet {
    geometry::FacetId facet = 0;
    Rect window;         ///< bounds of the part that can be seen, in (u, v)
    CellMask cells = 0;  ///< sub-frusta in which it can be seen
    /// The apex lies in the facet's plane, as far as can be told: only with Grazing::keep.
    bool grazes = false;
};

/// Whether the line from a frustum's apex to an unfolded point may pass a window of the frustum.
/// `moved`: metres by which either end may be off.
bool may_pass_window(const Frustum& frustum,
                     const Rect& window,
                     const geometry::Vec3& unfolded,
                     double moved) noexcept;

/// What becomes of facets in whose plane a frustum's apex lies, so that nothing is known of where
/// they are seen: nothing reflects there on the way from a source, but paths may end there.
enum class Grazing { drop, keep };

/// Finds the facets that sound in a frustum can reach first. Holds scratch memory, so one object
/// serves many frusta in turn, one thread at a time.
///
/// complete: the result is a superset of the facets on which a valid path through the frustum can
/// reflect next (docs/algorithms/frustum.md has the proof). A facet drops out only where another
/// facet, farther in front of it than `contact_reach`, fills a whole sub-frustum.
/// sampled: the facet nearest along the centre of each sub-frustum.
class VisibleFacets {
public:
    /// `contact_reach` in metres, as PathVerifier::contact_reach; `reach`: the largest distance of
    /// a source or listener from the origin, metres.
    VisibleFacets(const FacetIndex& index,
                  Mode mode,
                  double contact_reach,
                  double reach,
                  Grazing grazing = Grazing::drop);

    /// Makes this the current frustum without looking for facets: nothing hides anything in it.
    void enter(const Frustum& frustum);

    /// Makes this the current frustum and finds what it sees.
    void search(const Frustum& frustum);

    const Frustum& frustum() const noexcept { return frustum_; }

    /// Facets that the current frustum sees, roughly nearest first.
    const std::vector<VisibleFacet>& found() const noexcept { return found_; }

    /// Forgets those that have a 0, of one number per facet. They hide what they hide.
    void leave_out(std::span<const std::uint8_t> is_wanted);

    /// Whether sound in the current frustum may arrive at the point: false only if every
    /// sub-frustum that may hold it is dead or filled by a facet nearer than the point.
    bool may_reach(const geometry::Vec3& point) const noexcept;

    /// To find a superset of the points that may_pass() lets through, once it is given the window
    /// of a visible facet.
    WindowSight sight() const noexcept;

    /// Whether a straight line from the current frustum's apex to a point, mirrored as often as the
    /// way to it reflects, may pass a facet that the frustum sees. Conservative like may_reach, but
    /// for what stands between.
    bool may_pass(const VisibleFacet& visible, const geometry::Vec3& unfolded) const noexcept;

    /// Whether sound in the current frustum may arrive at the point after one more reflection, in a
    /// facet that the frustum sees.
    bool may_reach_mirrored(const VisibleFacet& visible,
                            const geometry::Vec3& point) const noexcept;

    /// The part of the current frustum that a facet it sees reflects.
    Frustum reflect(const VisibleFacet& visible);

private:
    struct Projected {
        Coverage coverage;
        Rect bounds;  // of the drawn polygon, grown by its slack
    };
    struct Candidate {
        geometry::FacetId facet = 0;
        InverseDepth depth;  // scaled up by its error
        CellMask touched = 0;
        Rect bounds;
    };
    struct Cover {
        geometry::FacetId facet = 0;
        InverseDepth depth;   // scaled down by its error and the contact reach
        double centre = 0.0;  // in the middle of the sub-frustum
        double size = 0.0;    // of the coefficients
    };

    void visit_nodes();
    void visit_facet(geometry::FacetId facet);
    bool draw(const Frustum& frustum,
              CellRaster& raster,
              geometry::FacetId facet,
              bool only_samples,
              Projected& out);
    enum class Drawing { outside, done, needs_clipping };
    Drawing draw_whole(const Frustum& frustum,
                       CellRaster& raster,
                       geometry::FacetId facet,
                       double moved,
                       bool only_samples,
                       Projected& out);
    bool clip(const Frustum& frustum, const CellRaster& raster, double moved);
    void add_cover(geometry::FacetId facet, const InverseDepth& depth, CellMask filled);
    void add_sample(geometry::FacetId facet, const InverseDepth& depth, CellMask centred);
    double grazing_height() const noexcept;
    double depth_error(geometry::FacetId facet) const noexcept;
    CellMask cells_near(const Rect& bounds, double depth) const noexcept;
    bool everything_hides(double depth, CellMask cells) const noexcept;
    bool samples_pass(const Rect& bounds, double nearest) const noexcept;
    bool box_is_hidden(const geometry::Aabb& box) const noexcept;
    bool is_nearer(const Cover& cover,
                   const InverseDepth& depth,
                   double size,
                   int cell) const noexcept;
    glm::dvec2 centre_of(int cell) const noexcept;
    double half_change(const InverseDepth& a, const InverseDepth& b) const noexcept;
    CellMask hidden_cells(geometry::FacetId facet,
                          const InverseDepth& depth,
                          CellMask cells) const noexcept;
    void collect_found();
    Rect bounds_of_cells(CellMask cells) const noexcept;

    const FacetIndex& index_;
    Mode mode_;
    double contact_reach_;
    double reach_;
    Grazing grazing_;

    Frustum frustum_;
    CellRaster raster_;
    glm::dvec2 first_centre_{0.0};
    double moved_ = 0.0;  // metres of rounding in constructed points
    CellMask covered_ = 0;
    InverseDepth start_limit_;  // a cover must lie beyond it
    std::array<Cover, 64> covers_;
    std::vector<Candidate> candidates_;
    std::vector<VisibleFacet> found_;
    std::vector<std::uint32_t> stack_;
    std::vector<geometry::Vec3> polygon_, clipped_;
    std::vector<glm::dvec2> outline_;
};

}  // namespace earshot::frustum
