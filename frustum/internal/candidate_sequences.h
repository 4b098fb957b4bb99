// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/frustum/internal/kept_connections.h"
#include "earshot/frustum/internal/listener_beams.h"
#include "earshot/frustum/internal/listener_points.h"
#include "earshot/frustum/internal/verdict_table.h"
#include "earshot/frustum/internal/visible_facets.h"
#include "earshot/frustum/path_verifier.h"

#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace earshot::frustum {

/// The result of one task of a search.
struct TaskResult {
    std::vector<SpecularPath> paths;
    TraceStatistics statistics;
    VerdictTable verdicts{};    ///< if they are kept, in no order
    Connections connections{};  ///< likewise, of the visible facets that were passed, in order

    void append(TaskResult&& other);
};

struct BeamNode;
struct BeamTree;

/// The listeners of a search, and the structure that finds them.
struct ListenerSet {
    std::span<const geometry::Vec3> positions;
    const ListenerBeams* beams = nullptr;    ///< their beam trees, if there are any
    const ListenerPoints* points = nullptr;  ///< a hierarchy over them otherwise
    /// Of the source's frusta that are connected with the listeners' subpaths; -1: none are.
    int connecting_order = -1;
};

/// Generates candidate facet sequences (visibility sequences) from the nodes of the source's beam
/// tree and passes them to a PathVerifier. An object stores the facets and the image sources on the
/// path from the root of the tree to the current node, so every task uses its own.
class CandidateGenerator {
public:
    CandidateGenerator(const FacetIndex& index,
                       const PathVerifier& verifier,
                       const ListenerSet& listeners,
                       const TraceOptions& options,
                       double max_radius,
                       const geometry::Vec3& source);

    /// Appends a facet to the sequence.
    void push(geometry::FacetId facet);
    void pop();
    std::size_t order() const noexcept { return sequence_.size(); }

    /// The direct path to every listener.
    void generate_direct();

    /// Generates the candidates of paths whose next reflection is in a facet visible in the current
    /// frustum of `search`: their last one, or followed by a subpath of a listener. Precondition:
    /// the frustum was reflected in this sequence.
    void generate_from(const VisibleFacets& search, std::span<const VisibleFacet> visible_facets);

    /// The same for a node of a part of a beam tree; `first`: visible facets of the parts before.
    void generate_from(const VisibleFacets& search,
                       const BeamTree& part,
                       const BeamNode& node,
                       std::size_t first);

    /// Keeps verdicts and connections, and takes over those of before that still hold, which must
    /// outlive it.
    void keep(const FormerVerdicts& verdicts, const FormerConnections& connections) {
        former_ = &verdicts;
        former_connections_ = &connections;
    }

    TaskResult take_result() { return std::move(result_); }

private:
    void connect_last_reflections(const VisibleFacets& search, const VisibleFacet& visible);
    void connect_subpaths(const VisibleFacets& search,
                          const VisibleFacet& visible,
                          std::uint32_t position_before);
    void take_over_connections(const VisibleFacet& visible, std::uint32_t position_before);
    void find_connections(const VisibleFacets& search, const VisibleFacet& visible, bool only_new);
    void verify_connection(std::uint32_t subpath);
    void verify_listeners_in_frusta(const VisibleFacets& search,
                                    std::span<const VisibleFacet> visible_facets);
    void verify_candidate(std::size_t listener);
    std::optional<SpecularPath> path_to(std::size_t listener);
    bool within_limits(double length) const noexcept;

    const FacetIndex& index_;
    const PathVerifier& verifier_;
    const ListenerSet& listeners_;
    TraceOptions options_;
    double max_radius_;
    std::vector<geometry::FacetId> sequence_;
    std::vector<geometry::Vec3> images_;
    ApertureTest aperture_test_;  // of the current frustum
    std::vector<std::uint8_t> inside_masks_;
    std::vector<std::uint32_t> subpaths_;                    // scratch
    std::vector<std::uint32_t> connected_;                   // with the current visible facet
    std::size_t taken_over_ = 0;                             // of these, the first ones
    const FormerVerdicts* former_ = nullptr;                 // null: verdicts are not kept
    const FormerConnections* former_connections_ = nullptr;  // likewise
    TaskResult result_;
};

}  // namespace earshot::frustum
