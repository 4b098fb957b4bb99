// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/frustum/scene_view.h"
#include "earshot/geometry/interval.h"
#include "earshot/geometry/wedge.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace earshot::frustum {

/// Parts of two edges, each of which is visible from every point of the other. Metres from the
/// beginning of each edge.
struct EdgeLink {
    geometry::Interval first{};
    geometry::Interval second{};
};

/// Ways from a source straight to an edge, to a second edge and to a listener: one contribution of
/// second-order diffraction.
struct EdgePairPath {
    std::size_t listener = 0;  ///< index into the listeners asked for
    std::size_t first = 0;     ///< index into the wedges: the edge that the source reaches
    std::size_t second = 0;    ///< and the one that the listener reaches
    /// Disjoint, not empty.
    std::vector<EdgeLink> links{};
    /// Set if the ways run along a face of both: which one of each wedge, 0 or 1.
    std::optional<std::array<int, 2>> common_face{};
    /// Some of the links were decided by samples of the edges.
    bool is_sampled = false;
};

/// Tells which ways over two edges need not be looked for. Where it answers false nothing is
/// reported; where it answers true everything is, and the same whatever it answers elsewhere.
class EdgePairFilter {
public:
    virtual ~EdgePairFilter() = default;
    /// False if no way over any points of two parts (metres from the beginning of their edges) is
    /// wanted, through the air or along a face of both. `listener`: index into the listeners asked
    /// for. Called from several threads.
    virtual bool may_be_wanted(const geometry::Wedge& first,
                               const geometry::Interval& of_first,
                               const geometry::Wedge& second,
                               const geometry::Interval& of_second,
                               const std::optional<std::array<int, 2>>& common_face,
                               std::size_t listener) const = 0;
};

/// Counts of work.
struct EdgePairStatistics {
    std::uint64_t pairs = 0;    ///< of parts of edges, whose links were looked for
    std::uint64_t sampled = 0;  ///< of these, decided by samples
};

struct EdgePairResult {
    /// By listener, first wedge, second wedge, face, places.
    std::vector<EdgePairPath> paths;
    EdgePairStatistics statistics;
};

/// Every way over two edges without reflections, through free air or along one face that both
/// border on. What source and listener reach of the edges is exact (edge_paths.h). All points of
/// one part see all points of the other if nothing meets the convex hull of both; where something
/// does, ways from samples of the first edge decide. Sound that passes transmissive facets is left
/// out. `filter`: none if every way is wanted. Preconditions: as for find_edge_paths().
EdgePairResult find_edge_pair_paths(const SceneView& scene,
                                    std::span<const geometry::Wedge> wedges,
                                    const geometry::Vec3& source,
                                    std::span<const geometry::Vec3> listeners,
                                    const EdgePairFilter* filter = nullptr,
                                    Executor& executor = Executor::serial());

}  // namespace earshot::frustum
