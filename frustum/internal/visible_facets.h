// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/frustum/internal/facet_index.h"
#include "earshot/frustum/internal/frustum.h"

#include <vector>

namespace earshot::frustum {

/// A facet that a frustum can see.
struct VisibleFacet {
    geometry::FacetId facet = 0;
    Rect window;         ///< bounds of the part that can be seen, in (u, v)
    CellMask cells = 0;  ///< sub-frusta in which it can be seen
};

/// Finds the facets that sound in a frustum can reach first. Holds scratch memory, so one object
/// serves many frusta in turn, one thread at a time.
///
/// complete: the result is a superset of the facets on which a valid path through the frustum can
/// reflect next (docs/algorithms/frustum.md has the proof). A facet drops out only where another
/// facet, farther in front of it than `contact_reach`, fills a whole sub-frustum.
/// sampled: the facet nearest along the centre of each sub-frustum.
class VisibleFacets {
public:
    /// `contact_reach` in metres, as PathVerifier::contact_reach; `listener_reach`: the largest
    /// distance of a listener from the origin, metres.
    VisibleFacets(const FacetIndex& index, Mode mode, double contact_reach, double listener_reach);

    /// Makes this the current frustum without looking for facets: nothing hides anything in it.
    void enter(const Frustum& frustum);

    /// Makes this the current frustum and finds what it sees.
    void search(const Frustum& frustum);

    /// Facets that the current frustum sees, roughly nearest first.
    const std::vector<VisibleFacet>& found() const noexcept { return found_; }

    /// Whether sound in the current frustum may arrive at the point: false only if every
    /// sub-frustum that may hold it is dead or filled by a facet nearer than the point.
    bool may_reach(const geometry::Vec3& point) const noexcept;

    /// The part of the current frustum that a facet it sees reflects.
    Frustum reflect(const VisibleFacet& visible);

    /// The same with every sub-frustum of the window alive, without drawing the facet.
    Frustum reflect_whole(const VisibleFacet& visible) const noexcept;

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
        double centre = 0.0;  // of the sub-frustum
    };

    void visit_nodes();
    void visit_facet(geometry::FacetId facet);
    bool draw(const Frustum& frustum, CellRaster& raster, geometry::FacetId facet, Projected& out);
    bool clip(const Frustum& frustum, const CellRaster& raster, double moved);
    void add_cover(geometry::FacetId facet, const InverseDepth& depth, CellMask filled);
    void add_sample(geometry::FacetId facet, const InverseDepth& depth, CellMask centred);
    double depth_error(geometry::FacetId facet) const noexcept;
    CellMask cells_near(const Rect& bounds, double depth) const noexcept;
    bool everything_hides(double depth, CellMask cells) const noexcept;
    bool box_is_hidden(const geometry::Aabb& box) const noexcept;
    CellMask hidden_cells(geometry::FacetId facet,
                          const InverseDepth& depth,
                          CellMask cells) const noexcept;
    void collect_found();
    Rect bounds_of_cells(CellMask cells) const noexcept;

    const FacetIndex& index_;
    Mode mode_;
    double contact_reach_;
    double listener_reach_;

    Frustum frustum_;
    CellRaster raster_;
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
