// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/frustum/internal/beam_tree.h"
#include "earshot/frustum/internal/box_lattice.h"
#include "earshot/frustum/internal/candidate_sequences.h"
#include "earshot/frustum/internal/facet_index.h"
#include "earshot/frustum/internal/geometry_change.h"
#include "earshot/frustum/internal/path_order.h"
#include "earshot/frustum/internal/verdict_table.h"
#include "earshot/frustum/path_finder.h"
#include "earshot/frustum/path_verifier.h"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace earshot::frustum {

/// How deep beam trees are traced.
struct Depths {
    int source_orders = 0;        // frusta of this order and above are not traced
    int subpath_reflections = 0;  // of the listeners' beam trees
    int connecting_order() const { return subpath_reflections > 0 ? source_orders - 1 : -1; }
};

/// How deep beam trees must be for the options.
Depths depths_of(const FinderOptions& options, bool bidirectional);

/// See path_finder.h, of which these are the hidden parts.
struct SourceBeamTree::Kept {
    geometry::Vec3 source{0.0};
    std::vector<BeamTree> parts;  // one per task of the trace
    bool is_in_box = false;       // no beam tree is needed
    bool has_first_facets = false;
    std::uint64_t instant = 0;  // of the finder
    std::uint64_t kept_frusta = 0;
    TraceStamp stamp = new_stamp();
    TraceStamp stamp_before;  // of the tree that this one was updated from; null: none
};

struct ListenerBeamTree::Kept {
    std::vector<geometry::Vec3> listeners;
    std::optional<ListenerBeams> beams;
    std::optional<ListenerPoints> points;
    int connecting_order = -1;
    std::uint64_t instant = 0;  // of the finder
    TraceStamp stamp = new_stamp();
    TraceStamp stamp_before;  // of the trees that these were updated from; null: none

    ListenerSet set() const {
        return {.positions = listeners,
                .beams = beams ? &*beams : nullptr,
                .points = points ? &*points : nullptr,
                .connecting_order = connecting_order};
    }
};

struct KeptVerdicts::Kept {
    VerdictTable table;
    Connections connections;
    TraceStamp source_stamp, listener_stamp;  // of the beam trees that were connected
    geometry::Vec3 source{0.0};
    std::vector<geometry::Vec3> listeners;
    std::uint64_t instant = 0;  // of the finder; 0: none yet
};

struct PathFinder::State {
    State(const SceneView& the_scene, const FinderOptions& options, FacetIndex the_index)
        : scene(the_scene),
          index(std::move(the_index)),
          verifier(the_scene),
          trace(options.trace),
          bidirectional(options.trace.mode == Mode::complete && !options.forward_only),
          depths(depths_of(options, bidirectional)),
          max_radius(options.max_radius > 0.0 ? options.max_radius : 16.0 * index.extent()),
          tracer(index, trace, verifier.contact_radius(), max_radius, depths.source_orders),
          box(trace.box_lattice && trace.mode == Mode::complete
                  ? BoxLattice::make(the_scene, verifier, trace)
                  : std::nullopt),
          is_whole(options.sample.share >= 1.0) {
        tracer.set_sample(options.sample);
        if (options.track_changes) {
            snapshot.emplace(the_scene, index);
        }
    }

    /// The instant after `before`.
    void follow(const State& before, Executor& executor) {
        instant = before.instant + 1;
        if (snapshot && before.snapshot && traces_alike(before)) {
            change.emplace(*before.snapshot, *snapshot, executor);
            if (change->is_total()) {
                change.reset();
            }
        }
    }

    /// Whether what both trace differs by the geometry alone.
    bool traces_alike(const State& other) const {
        return trace == other.trace && trace.mode == Mode::complete && is_whole && other.is_whole &&
               bidirectional == other.bidirectional &&
               depths.source_orders == other.depths.source_orders &&
               depths.subpath_reflections == other.depths.subpath_reflections &&
               max_radius == other.max_radius;
    }

    /// Whether it is known what has changed since a beam tree was traced or updated.
    bool knows_change_since(std::uint64_t earlier) const {
        return change.has_value() && earlier + 1 == instant;
    }

    SceneView scene;
    FacetIndex index;
    PathVerifier verifier;
    TraceOptions trace;
    bool bidirectional;
    Depths depths;
    double max_radius;
    BeamTracer tracer;
    std::optional<BoxLattice> box;  // refers to the verifier
    bool is_whole;                  // all frusta are followed
    std::uint64_t instant = 1;
    std::optional<GeometrySnapshot> snapshot;
    std::optional<GeometryChange> change;  // since the instant before, unless it is total

    /// Whether frusta from the point are not needed, if those at the other end are not.
    bool is_in_box(const geometry::Vec3& point) const { return box && box->contains(point); }
    bool is_in_box(std::span<const geometry::Vec3> points) const {
        return std::all_of(points.begin(), points.end(), [&](const geometry::Vec3& point) {
            return is_in_box(point);
        });
    }

    ListenerBeamTree trace_beams(std::span<const geometry::Vec3> listeners,
                                 Executor& executor) const;
    /// The listeners with beam trees, which those in a box lack: then `traced`.
    const ListenerBeamTree& with_beams(const ListenerBeamTree& listeners,
                                       std::optional<ListenerBeamTree>& traced,
                                       Executor& executor) const;
    TaskResult find_by_frusta(const geometry::Vec3& source,
                              const ListenerSet& listeners,
                              FirstFacets first,
                              Executor& executor,
                              Progress* progress) const;
    TaskResult find_in_box(const geometry::Vec3& source,
                           std::span<const geometry::Vec3> listeners,
                           Executor& executor,
                           Progress* progress) const;

    CandidateGenerator generator(const geometry::Vec3& source, const ListenerSet& listeners) const {
        return {index, verifier, listeners, trace, max_radius, source};
    }

    /// What was connected before; null: nothing is kept.
    struct Former {
        FormerVerdicts verdicts;
        FormerConnections connections;
    };

    static FormerConnections former_connections(const KeptVerdicts::Kept& kept,
                                                const SourceBeamTree::Kept& source,
                                                const ListenerBeamTree::Kept& listeners);
    TaskResult find_direct(const geometry::Vec3& source,
                           const ListenerSet& listeners,
                           const Former* former) const {
        CandidateGenerator direct = generator(source, listeners);
        if (former != nullptr) {
            direct.keep(former->verdicts, former->connections);
        }
        direct.generate_direct();
        return direct.take_result();
    }

    TaskResult connect_beams(const SourceBeamTree& source,
                             const ListenerSet& listeners,
                             const Former* former,
                             Executor& executor) const;

    TraceResult finish(TaskResult result) const {
        sort_and_deduplicate(result.paths, scene.facets, verifier.extent());
        result.statistics.paths = result.paths.size();
        return {.paths = std::move(result.paths), .statistics = result.statistics};
    }
};

}  // namespace earshot::frustum
