// SPDX-License-Identifier: MIT
#include "earshot/frustum/path_finder.h"

#include "earshot/base/assert.h"
#include "earshot/base/error.h"
#include "earshot/base/stage_progress.h"
#include "earshot/frustum/internal/box_arrivals.h"
#include "earshot/frustum/internal/path_finder_state.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

namespace earshot::frustum {

using geometry::FacetId;
using geometry::Vec3;

namespace {

// Forward-only tracing in complete mode: beams are traced from up to so many listeners; more are
// looked up by position.
constexpr std::size_t kMaxListenersWithBeams = 64;

/// A task of BeamTracer::trace that generates candidates without recording the tree.
class CandidateTask {
public:
    explicit CandidateTask(CandidateGenerator generator) : generator_(std::move(generator)) {}
    void push(FacetId facet) { generator_.push(facet); }
    void pop() { generator_.pop(); }
    std::size_t order() const { return generator_.order(); }
    void visit(const VisibleFacets& search) {
        ++frusta_;
        visit_more(search);
    }
    void visit_more(const VisibleFacets& search) {
        generator_.generate_from(search, search.found());
    }
    TaskResult take_result() {
        TaskResult result = generator_.take_result();
        result.statistics.frusta += frusta_;
        return result;
    }

private:
    CandidateGenerator generator_;
    std::uint64_t frusta_ = 0;
};

}  // namespace

// Forward-only tracing looks for listeners in the reflections of the last frusta. Bidirectional
// tracing connects facets visible in the source's last frusta with subpaths of the listeners. A
// second reflection of subpaths costs each listener what it spares every source: about 16 times as
// many frusta of the highest order.
Depths depths_of(const FinderOptions& options, bool bidirectional) {
    const int order = options.trace.max_order;
    if (!bidirectional || order < 2) {
        return {.source_orders = order};
    }
    constexpr int kReflectionsPerFrustum = 16;
    constexpr std::size_t kMaxListeners = 64;
    std::size_t max_listeners = order < 3 ? 0 : 1;
    for (int i = 3; i < order && max_listeners < kMaxListeners; ++i) {
        max_listeners *= kReflectionsPerFrustum;
    }
    const int subpath_reflections =
        options.listener_count <= std::min(max_listeners, kMaxListeners) ? 2 : 1;
    return {.source_orders = order - subpath_reflections,
            .subpath_reflections = subpath_reflections};
}

SourceBeamTree::SourceBeamTree(std::unique_ptr<Kept> kept) : kept_(std::move(kept)) {}
SourceBeamTree::SourceBeamTree(SourceBeamTree&&) noexcept = default;
SourceBeamTree& SourceBeamTree::operator=(SourceBeamTree&&) noexcept = default;
SourceBeamTree::~SourceBeamTree() = default;

const Vec3& SourceBeamTree::source() const noexcept {
    return kept_->source;
}

std::size_t SourceBeamTree::frusta() const noexcept {
    std::size_t count = 0;
    for (const BeamTree& part : kept_->parts) {
        count += static_cast<std::size_t>(
            std::count_if(part.nodes.begin(), part.nodes.end(), [](const BeamNode& node) {
                return !node.is_continued;
            }));
    }
    return count;
}

std::size_t SourceBeamTree::kept_frusta() const noexcept {
    return kept_->kept_frusta;
}

std::size_t SourceBeamTree::bytes() const noexcept {
    std::size_t bytes = 0;
    for (const BeamTree& part : kept_->parts) {
        bytes += part.nodes.size() * sizeof(BeamNode) + part.visible.size() * sizeof(VisibleFacet) +
                 part.visible_before.size() * sizeof(std::uint32_t);
    }
    return bytes;
}

ListenerBeamTree::ListenerBeamTree(std::unique_ptr<Kept> kept) : kept_(std::move(kept)) {}
ListenerBeamTree::ListenerBeamTree(ListenerBeamTree&&) noexcept = default;
ListenerBeamTree& ListenerBeamTree::operator=(ListenerBeamTree&&) noexcept = default;
ListenerBeamTree::~ListenerBeamTree() = default;

std::span<const Vec3> ListenerBeamTree::listeners() const noexcept {
    return kept_->listeners;
}

std::size_t ListenerBeamTree::frusta() const noexcept {
    return kept_->beams ? kept_->beams->frusta() : 0;
}

std::size_t ListenerBeamTree::kept_frusta() const noexcept {
    return kept_->beams ? kept_->beams->kept_frusta() : 0;
}

std::size_t ListenerBeamTree::bytes() const noexcept {
    return kept_->beams ? kept_->beams->bytes() : 0;
}

// In a concert hall of 3,754 facets bidirectional tracing is the faster way to up to 1, 12 and 50
// listeners at orders 2, 3 and 4.
bool prefer_forward(std::size_t listener_count, int max_order) noexcept {
    constexpr std::size_t kMaxThreshold = 768;
    if (max_order <= 2) {
        return listener_count > 1;
    }
    const int steps = std::min(max_order - 3, 3);
    return listener_count > std::min(kMaxThreshold, std::size_t{12} << (2 * steps));
}

PathFinder::PathFinder(const SceneView& scene, const FinderOptions& options, Executor& executor) {
    validate(options.trace);
    state_ = std::make_unique<State>(scene, options, FacetIndex(scene, executor));
}

void PathFinder::move_to(const SceneView& scene,
                         const FinderOptions& options,
                         double queries,
                         Executor& executor) {
    validate(options.trace);
    auto moved = std::make_unique<State>(
        scene, options, FacetIndex(scene, std::move(state_->index), queries, executor));
    moved->follow(*state_, executor);
    state_ = std::move(moved);
}

std::uint64_t PathFinder::hierarchies_built() const noexcept {
    return state_->index.hierarchies_built();
}

const bvh::UpdateStatistics& PathFinder::updates() const noexcept {
    return state_->index.updates();
}

PathFinder::PathFinder(PathFinder&&) noexcept = default;
PathFinder& PathFinder::operator=(PathFinder&&) noexcept = default;
PathFinder::~PathFinder() = default;

double PathFinder::max_radius() const noexcept {
    return state_->max_radius;
}

std::optional<PathArrivals> PathFinder::find_arrivals(const Vec3& source,
                                                      const Vec3& listener) const {
    if (!state_->is_in_box(source) || !state_->is_in_box(listener) || !state_->box->is_straight()) {
        return std::nullopt;
    }
    auto arrivals = std::make_unique<BoxArrivals>(*state_->box, source, listener);
    return arrivals->is_complete() ? std::optional(PathArrivals(std::move(arrivals)))
                                   : std::nullopt;
}

bool PathFinder::is_box() const noexcept {
    return state_->box.has_value();
}

SourceBeamTree PathFinder::trace_source(const Vec3& source,
                                        FirstFacets first,
                                        Executor& executor,
                                        Progress* progress) const {
    EARSHOT_ASSERT(glm::length(source) <= state_->max_radius);
    auto kept = std::make_unique<SourceBeamTree::Kept>();
    kept->source = source;
    kept->instant = state_->instant;
    kept->has_first_facets = !first.empty();
    kept->is_in_box = first.empty() && state_->is_in_box(source);
    if (state_->trace.max_order > 0 && !kept->is_in_box) {
        for (BeamRecorder& task : state_->tracer.trace<BeamRecorder>(
                 source, first, [] { return BeamRecorder(); }, executor, progress)) {
            kept->parts.push_back(task.take_tree());
        }
    }
    return SourceBeamTree(std::move(kept));
}

ListenerBeamTree PathFinder::trace_listeners(std::span<const Vec3> listeners,
                                             Executor& executor) const {
    if (state_->trace.max_order > 0 && !state_->is_in_box(listeners)) {
        return state_->trace_beams(listeners, executor);
    }
    auto kept = std::make_unique<ListenerBeamTree::Kept>();
    kept->listeners.assign(listeners.begin(), listeners.end());
    kept->instant = state_->instant;
    return ListenerBeamTree(std::move(kept));
}

ListenerBeamTree PathFinder::State::trace_beams(std::span<const Vec3> listeners,
                                                Executor& executor) const {
    auto kept = std::make_unique<ListenerBeamTree::Kept>();
    kept->listeners.assign(listeners.begin(), listeners.end());
    kept->instant = instant;
    const bool are_few = trace.mode == Mode::complete && listeners.size() <= kMaxListenersWithBeams;
    if (!bidirectional && !are_few) {
        kept->points.emplace(listeners);
    } else {
        kept->beams.emplace(index,
                            verifier.contact_radius(),
                            max_radius,
                            trace.max_order,
                            kept->listeners,
                            depths.subpath_reflections,
                            executor);
        kept->connecting_order = depths.connecting_order();
    }
    return ListenerBeamTree(std::move(kept));
}

const ListenerBeamTree& PathFinder::State::with_beams(const ListenerBeamTree& listeners,
                                                      std::optional<ListenerBeamTree>& traced,
                                                      Executor& executor) const {
    const bool lacks_beams = !listeners.kept_->beams && !listeners.kept_->points;
    if (trace.max_order == 0 || !lacks_beams) {
        return listeners;
    }
    traced.emplace(trace_beams(listeners.listeners(), executor));
    return *traced;
}

TaskResult PathFinder::State::find_by_frusta(const Vec3& source,
                                             const ListenerSet& listeners,
                                             FirstFacets first,
                                             Executor& executor,
                                             Progress* progress) const {
    TaskResult result = find_direct(source, listeners, nullptr);
    if (trace.max_order > 0) {
        const auto make_task = [&] { return CandidateTask(generator(source, listeners)); };
        for (CandidateTask& task :
             tracer.trace<CandidateTask>(source, first, make_task, executor, progress)) {
            result.append(task.take_result());
        }
    }
    return result;
}

// By the lattice; what it leaves to frusta, by frusta.
TaskResult PathFinder::State::find_in_box(const Vec3& source,
                                          std::span<const Vec3> listeners,
                                          Executor& executor,
                                          Progress* progress) const {
    std::vector<std::optional<BoxLattice::Paths>> found(listeners.size());
    StageProgress traced(progress, "tracing", listeners.size());
    executor.for_each(listeners.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            if (box->contains(listeners[i])) {
                found[i] = box->find(source, listeners[i]);
            }
        }
        traced.add(end - begin);
    });
    TaskResult result;
    const auto append = [&](std::vector<SpecularPath>& paths, auto&& number_of) {
        for (SpecularPath& path : paths) {
            path.listener = number_of(path);
            result.paths.push_back(std::move(path));
        }
    };
    std::vector<std::size_t> left;
    std::vector<Vec3> positions_left;
    for (std::size_t i = 0; i < listeners.size(); ++i) {
        if (found[i]) {
            append(found[i]->paths, [&](const SpecularPath&) { return i; });
            result.statistics.candidates += found[i]->candidates;
        } else {
            left.push_back(i);
            positions_left.push_back(listeners[i]);
        }
    }
    if (!left.empty()) {
        const ListenerBeamTree beams = trace_beams(positions_left, executor);
        TaskResult rest = find_by_frusta(source, beams.kept_->set(), {}, executor, nullptr);
        append(rest.paths, [&](const SpecularPath& path) { return left[path.listener]; });
        rest.paths.clear();
        rest.statistics.frusta += beams.frusta();
        result.append(std::move(rest));
    }
    return result;
}

void PathFinder::for_each_listener(const SourceBeamTree& source,
                                   std::span<const Vec3> listeners,
                                   const VisitPaths& visit,
                                   Executor& executor) const {
    constexpr std::size_t kBlock = 4096;
    for (std::size_t first = 0; first < listeners.size(); first += kBlock) {
        const auto some = listeners.subspan(first, std::min(kBlock, listeners.size() - first));
        const TraceResult found = connect(source, trace_listeners(some, executor), executor);
        auto begin = found.paths.begin();
        for (std::size_t i = 0; i < some.size(); ++i) {
            const auto end = std::find_if(begin, found.paths.end(), [&](const SpecularPath& path) {
                return path.listener != i;
            });
            visit(first + i, {begin, end});
            begin = end;
        }
    }
}

TraceResult PathFinder::find(const Vec3& source,
                             const ListenerBeamTree& listeners,
                             FirstFacets first,
                             Executor& executor,
                             Progress* progress) const {
    EARSHOT_ASSERT(glm::length(source) <= state_->max_radius);
    const State& state = *state_;
    if (first.empty() && state.is_in_box(source)) {
        return state.finish(state.find_in_box(source, listeners.listeners(), executor, progress));
    }
    std::optional<ListenerBeamTree> traced;
    const ListenerSet set = state.with_beams(listeners, traced, executor).kept_->set();
    return state.finish(state.find_by_frusta(source, set, first, executor, progress));
}

TraceResult PathFinder::find(const PlacedPairs& pairs,
                             FirstFacets first,
                             Executor& executor) const {
    EARSHOT_ASSERT(!pairs.undecided);
    TraceResult result;
    for (const PlacedListeners& group : pairs.groups) {
        const ListenerBeamTree listeners = trace_listeners(group.positions, executor);
        TraceResult found = find(group.source, listeners, first, executor);
        for (SpecularPath& path : found.paths) {
            path.listener = group.numbers[path.listener];
            result.paths.push_back(std::move(path));
        }
        result.statistics.frusta += found.statistics.frusta + listeners.frusta();
        result.statistics.candidates += found.statistics.candidates;
        result.statistics.paths += found.statistics.paths;
    }
    std::stable_sort(
        result.paths.begin(), result.paths.end(), [](const SpecularPath& a, const SpecularPath& b) {
            return a.listener < b.listener;
        });
    return result;
}

}  // namespace earshot::frustum
