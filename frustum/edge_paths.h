// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/frustum/scene_view.h"
#include "earshot/geometry/interval.h"
#include "earshot/geometry/wedge.h"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <vector>

namespace earshot::frustum {

/// Ways from a source over facets that reflect to a part of an edge, and over facets on to a
/// listener: one contribution of edge diffraction.
struct EdgePath {
    std::size_t listener = 0;                 ///< index into the listeners asked for
    std::size_t wedge = 0;                    ///< index into the wedges
    std::vector<geometry::FacetId> before{};  ///< that reflect before the edge, source first
    std::vector<geometry::FacetId> after{};   ///< that reflect after it, edge first
    geometry::Vec3 source_image{0.0};         ///< the source mirrored in `before`
    geometry::Vec3 listener_image{0.0};       ///< the listener mirrored in `after`, from its end
    /// The part of the edge that both sides reach, metres from its beginning.
    geometry::Interval part{};
    double length = 0.0;  ///< of the shortest way over the part, metres
};

/// One end of possible paths over an edge: the source or a listener, mirrored in some facets. What
/// of the edge it reaches is not known yet.
struct EdgeEnd {
    geometry::WedgePoint image{};      ///< about the wedge
    double max_pressure_factor = 1.0;  ///< of the reflections
    std::uint32_t reflections = 0;
};

/// Tells what need not be looked for. Where it answers false nothing is reported; where it answers
/// true everything is, and the same whatever it answers elsewhere.
class EdgePathFilter {
public:
    virtual ~EdgePathFilter() = default;
    /// False if no path over any part of the wedge within `part` (metres from its beginning)
    /// between the two ends is wanted. `listener_index`: into the listeners asked for. Called from
    /// several threads.
    virtual bool may_be_wanted(const geometry::Wedge& wedge,
                               const geometry::Interval& part,
                               const EdgeEnd& source,
                               const EdgeEnd& listener,
                               std::size_t listener_index) const = 0;
};

struct EdgePathOptions {
    int max_reflections = 0;  ///< before and after the edge together, 0 ... 16
    /// Longer ways are left out, metres.
    double max_length = std::numeric_limits<double>::infinity();
    /// Ways are left out whose reflections multiply the pressure by less than this times the length
    /// in metres. 0: none.
    double min_pressure = 0.0;
    /// What sources reach is kept, too, until discard_unused(): for sources and listeners of which
    /// some move. Changes time and memory only.
    bool keep_traces = false;
};

/// Counts of work.
struct EdgeStatistics {
    std::uint64_t frusta = 0;      ///< traced from both sides, without what was kept
    std::uint64_t candidates = 0;  ///< likewise: wedges with a sequence of one side
    std::uint64_t pairs = 0;       ///< of candidates of both sides that passed the filter
};

struct EdgePathResult {
    /// By listener, wedge, number of reflections, facets before, facets after, place.
    std::vector<EdgePath> paths;
    EdgeStatistics statistics;
};

/// Finds every way over one edge and up to max_reflections reflections in one scene at one instant.
/// Parts of edges are decided exactly, by PathVerifier between places at which something changes;
/// frusta from both sides only generate candidates, of which a wedge on the border of a facet that
/// is visible to a frustum is one, if sound in the frustum may arrive at it. Only what pairs that
/// pass the filter need is verified. Sound that passes transmissive facets on its way to an edge is
/// left out, and so is an edge seen along a face that it borders.
///
/// What listeners reach is kept for the next source as far as memory allows, a GiB.
class EdgePathFinder {
public:
    /// Everything must outlive it. Throws Error if an option is out of range. Preconditions: the
    /// wedges are those of the scene's facets; no point lies on a surface (surface_points.h).
    EdgePathFinder(const SceneView& scene,
                   std::span<const geometry::Wedge> wedges,
                   const EdgePathOptions& options = {},
                   Executor& executor = Executor::serial());
    EdgePathFinder(EdgePathFinder&&) noexcept;
    EdgePathFinder& operator=(EdgePathFinder&&) noexcept;
    ~EdgePathFinder();

    EdgePathResult find(const geometry::Vec3& source,
                        std::span<const geometry::Vec3> listeners,
                        const EdgePathFilter* filter = nullptr,
                        Executor& executor = Executor::serial());

    /// With EdgePathOptions::keep_traces: discards what points reach that no call of find() has
    /// named since the last discard_unused().
    void discard_unused();

private:
    struct State;
    std::unique_ptr<State> state_;
};

/// The same for one source.
EdgePathResult find_edge_paths(const SceneView& scene,
                               std::span<const geometry::Wedge> wedges,
                               const geometry::Vec3& source,
                               std::span<const geometry::Vec3> listeners,
                               const EdgePathOptions& options = {},
                               Executor& executor = Executor::serial());

/// The same over all wedges and all sequences of facets, without frusta: a baseline.
EdgePathResult find_edge_paths_brute_force(const SceneView& scene,
                                           std::span<const geometry::Wedge> wedges,
                                           const geometry::Vec3& source,
                                           std::span<const geometry::Vec3> listeners,
                                           const EdgePathOptions& options = {});

/// The points of the shortest way over the part: source, reflections, apex, reflections, listener.
std::vector<geometry::Vec3> points_of(const EdgePath& path,
                                      const SceneView& scene,
                                      std::span<const geometry::Wedge> wedges,
                                      const geometry::Vec3& source,
                                      const geometry::Vec3& listener);

}  // namespace earshot::frustum
