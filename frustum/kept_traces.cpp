// SPDX-License-Identifier: MIT
//
// The part of PathFinder that keeps beam trees and verdicts from instant to instant.

#include "earshot/frustum/internal/path_finder_state.h"

#include <algorithm>
#include <utility>

namespace earshot::frustum {

using geometry::Vec3;

KeptVerdicts::KeptVerdicts() : kept_(std::make_unique<Kept>()) {}
KeptVerdicts::KeptVerdicts(KeptVerdicts&&) noexcept = default;
KeptVerdicts& KeptVerdicts::operator=(KeptVerdicts&&) noexcept = default;
KeptVerdicts::~KeptVerdicts() = default;

std::size_t KeptVerdicts::size() const noexcept {
    return kept_->table.size();
}

std::size_t KeptVerdicts::connections() const noexcept {
    return kept_->connections.size();
}

std::size_t KeptVerdicts::kept_connections() const noexcept {
    return kept_->connections.kept();
}

std::size_t KeptVerdicts::bytes() const noexcept {
    return kept_->table.bytes() + kept_->connections.bytes();
}

bool PathFinder::is_current(const SourceBeamTree& source) const noexcept {
    return source.kept_->instant == state_->instant;
}

bool PathFinder::is_current(const ListenerBeamTree& listeners) const noexcept {
    return listeners.kept_->instant == state_->instant;
}

void PathFinder::update(SourceBeamTree& source,
                        FirstFacets first,
                        Executor& executor,
                        Progress* progress) const {
    SourceBeamTree::Kept& kept = *source.kept_;
    if (is_current(source)) {
        return;
    }
    if (!state_->knows_change_since(kept.instant) || kept.parts.empty() || !first.empty() ||
        kept.has_first_facets || state_->is_in_box(kept.source)) {
        source = trace_source(kept.source, first, executor, progress);
        return;
    }
    UpdatedBeams updated =
        state_->tracer.update(kept.source, kept.parts, *state_->change, executor, progress);
    kept.parts = std::move(updated.parts);
    kept.kept_frusta = updated.kept_frusta;
    kept.instant = state_->instant;
    kept.stamp_before = std::exchange(kept.stamp, new_stamp());
}

void PathFinder::update(ListenerBeamTree& listeners, Executor& executor) const {
    const State& state = *state_;
    ListenerBeamTree::Kept& kept = *listeners.kept_;
    if (is_current(listeners)) {
        return;
    }
    if (!state.knows_change_since(kept.instant) || !kept.beams || state.is_in_box(kept.listeners)) {
        const std::vector<Vec3> positions = std::move(kept.listeners);
        listeners = trace_listeners(positions, executor);
        return;
    }
    const ListenerBeams before = std::move(*kept.beams);
    kept.beams.emplace(state.index,
                       state.verifier.contact_radius(),
                       state.max_radius,
                       state.trace.max_order,
                       kept.listeners,
                       state.depths.subpath_reflections,
                       before,
                       *state.change,
                       executor);
    kept.instant = state.instant;
    kept.stamp_before = std::exchange(kept.stamp, new_stamp());
}

// Of the same beam trees, or of those from which both have been updated.
FormerConnections PathFinder::State::former_connections(const KeptVerdicts::Kept& kept,
                                                        const SourceBeamTree::Kept& source,
                                                        const ListenerBeamTree::Kept& listeners) {
    if (kept.source_stamp == nullptr) {
        return {};
    }
    if (source.stamp == kept.source_stamp && listeners.stamp == kept.listener_stamp) {
        return {&kept.connections, true};
    }
    if (source.stamp_before == kept.source_stamp && listeners.stamp_before == kept.listener_stamp) {
        return {&kept.connections, false};
    }
    return {};
}

TraceResult PathFinder::connect(const SourceBeamTree& source,
                                const ListenerBeamTree& listeners,
                                Executor& executor) const {
    const State& state = *state_;
    if (source.kept_->is_in_box) {
        return state.finish(
            state.find_in_box(source.source(), listeners.listeners(), executor, nullptr));
    }
    std::optional<ListenerBeamTree> traced;
    const ListenerSet set = state.with_beams(listeners, traced, executor).kept_->set();
    return state.finish(state.connect_beams(source, set, nullptr, executor));
}

TraceResult PathFinder::connect(const SourceBeamTree& source,
                                const ListenerBeamTree& listeners,
                                KeptVerdicts& verdicts,
                                Executor& executor) const {
    const State& state = *state_;
    KeptVerdicts::Kept& kept = *verdicts.kept_;
    if (source.kept_->is_in_box) {
        kept = {};
        return connect(source, listeners, executor);
    }
    const std::span<const Vec3> positions = listeners.listeners();
    const bool is_same_instant = kept.instant == state.instant;
    const bool are_known =
        (is_same_instant || state.knows_change_since(kept.instant)) &&
        kept.source == source.source() &&
        std::equal(
            positions.begin(), positions.end(), kept.listeners.begin(), kept.listeners.end());
    if (!are_known) {
        kept.table = {};
    }
    std::optional<ListenerBeamTree> traced;
    const ListenerBeamTree::Kept& beams = *state.with_beams(listeners, traced, executor).kept_;
    const State::Former former = {
        .verdicts = {kept.table, are_known && !is_same_instant ? &*state.change : nullptr},
        .connections = are_known ? State::former_connections(kept, *source.kept_, beams)
                                 : FormerConnections{}};
    TaskResult result = state.connect_beams(source, beams.set(), &former, executor);
    kept.table = std::move(result.verdicts);
    kept.table.finish();
    kept.connections = std::move(result.connections);
    kept.source_stamp = source.kept_->stamp;
    kept.listener_stamp = beams.stamp;
    kept.source = source.source();
    kept.listeners.assign(positions.begin(), positions.end());
    kept.instant = state.instant;
    return state.finish(std::move(result));
}

TaskResult PathFinder::State::connect_beams(const SourceBeamTree& source,
                                            const ListenerSet& listeners,
                                            const Former* former,
                                            Executor& executor) const {
    const auto& parts = source.kept_->parts;
    TaskResult result = find_direct(source.source(), listeners, former);
    std::vector<std::size_t> first_visible;  // per part
    for (std::size_t count = 0; const BeamTree& part : parts) {
        first_visible.push_back(count);
        count += part.visible.size();
    }
    std::vector<TaskResult> results(parts.size());
    executor.for_each(parts.size(), 1, [&](std::size_t begin, std::size_t end) {
        VisibleFacets search = tracer.make_search();
        for (std::size_t i = begin; i < end; ++i) {
            CandidateGenerator of_part = generator(source.source(), listeners);
            if (former != nullptr) {
                of_part.keep(former->verdicts, former->connections);
            }
            for (const BeamNode& node : parts[i].nodes) {
                // The nodes are in depth-first order: back up to the node's parent, then down.
                while (of_part.order() >= std::max<std::size_t>(node.order, 1)) {
                    of_part.pop();
                }
                if (node.order > 0) {
                    of_part.push(node.frustum.facet);
                }
                search.set_frustum(node.frustum);
                of_part.generate_from(search, parts[i], node, first_visible[i]);
            }
            results[i] = of_part.take_result();
        }
    });
    for (TaskResult& part : results) {
        result.append(std::move(part));
    }
    return result;
}

}  // namespace earshot::frustum
