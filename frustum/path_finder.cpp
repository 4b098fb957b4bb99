// SPDX-License-Identifier: MIT
#include "earshot/frustum/path_finder.h"

#include "earshot/base/assert.h"
#include "earshot/base/error.h"
#include "earshot/frustum/internal/beam_tree.h"
#include "earshot/frustum/internal/candidate_sequences.h"
#include "earshot/frustum/internal/facet_index.h"
#include "earshot/frustum/internal/path_order.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace earshot::frustum {

using geometry::FacetId;
using geometry::Vec3;

namespace {

constexpr int kMaxResolution = 1024;
constexpr int kMaxOrder = 64;

// Forward-only tracing in complete mode: beams are traced from up to so many listeners; more are
// looked up by position.
constexpr std::size_t kMaxListenersWithBeams = 64;

void validate(const TraceOptions& options) {
    if (options.max_order < 0 || options.max_order > kMaxOrder) {
        throw Error("order",
                    "must be 0 to " + std::to_string(kMaxOrder) + ", not " +
                        std::to_string(options.max_order));
    }
    if (!(options.max_length >= 0.0)) {
        throw Error("max_length", "must not be negative");
    }
    if (!(options.min_pressure >= 0.0)) {
        throw Error("min_pressure", "must not be negative");
    }
    if (options.resolution < 0 || options.resolution > kMaxResolution) {
        throw Error("resolution",
                    "must be 0 (the default) to " + std::to_string(kMaxResolution) + ", not " +
                        std::to_string(options.resolution));
    }
}

/// Frusta of this order and above are not traced: bidirectional tracing joins the beam trees of the
/// listeners two reflections before the end, forward-only tracing looks for listeners in the
/// reflections of the last frusta.
int orders_traced(int max_order, bool bidirectional) {
    return bidirectional ? std::max(max_order - 1, std::min(max_order, 1)) : max_order;
}

/// A task of BeamTracer::trace that generates candidates without recording the tree.
class CandidateTask {
public:
    explicit CandidateTask(CandidateGenerator generator) : generator_(std::move(generator)) {}
    void push(FacetId facet) { generator_.push(facet); }
    void pop() { generator_.pop(); }
    std::size_t order() const { return generator_.order(); }
    void visit(const VisibleFacets& search) {
        ++frusta_;
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

struct SourceBeamTree::Kept {
    Vec3 source{0.0};
    std::vector<BeamTree> parts;  // one per task of the trace
};

struct ListenerBeamTree::Kept {
    std::vector<Vec3> listeners;
    std::optional<ListenerBeams> beams;
    std::optional<ListenerPoints> points;

    ListenerSet set() const {
        return {.positions = listeners,
                .beams = beams ? &*beams : nullptr,
                .points = points ? &*points : nullptr};
    }
};

struct PathFinder::State {
    State(const SceneView& the_scene, const FinderOptions& options)
        : scene(the_scene),
          index(the_scene),
          verifier(the_scene),
          trace(options.trace),
          bidirectional(options.trace.mode == Mode::complete && !options.forward_only),
          max_radius(options.max_radius > 0.0 ? options.max_radius : 16.0 * index.extent()),
          tracer(index,
                 trace,
                 verifier.contact_radius(),
                 max_radius,
                 orders_traced(trace.max_order, bidirectional)) {}

    SceneView scene;
    FacetIndex index;
    PathVerifier verifier;
    TraceOptions trace;
    bool bidirectional;
    double max_radius;
    BeamTracer tracer;

    CandidateGenerator generator(const Vec3& source, const ListenerSet& listeners) const {
        return {index, verifier, listeners, trace, max_radius, source};
    }

    TaskResult find_direct(const Vec3& source, const ListenerSet& listeners) const {
        CandidateGenerator direct = generator(source, listeners);
        direct.generate_direct();
        return direct.take_result();
    }

    TraceResult finish(TaskResult result) const {
        sort_and_deduplicate(result.paths, scene.facets, verifier.extent());
        result.statistics.paths = result.paths.size();
        return {.paths = std::move(result.paths), .statistics = result.statistics};
    }
};

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
        count += part.nodes.size();
    }
    return count;
}

std::size_t SourceBeamTree::bytes() const noexcept {
    std::size_t bytes = 0;
    for (const BeamTree& part : kept_->parts) {
        bytes += part.nodes.size() * sizeof(BeamNode) + part.visible.size() * sizeof(VisibleFacet);
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

// In a concert hall of 3,754 facets both ways took equally long for 1, 12 and 50 listeners at
// orders 2, 3 and 4.
bool prefer_forward(std::size_t listener_count, int max_order) noexcept {
    constexpr std::size_t kMaxThreshold = 768;
    if (max_order <= 2) {
        return listener_count > 1;
    }
    const int steps = std::min(max_order - 3, 3);
    return listener_count > std::min(kMaxThreshold, std::size_t{12} << (2 * steps));
}

PathFinder::PathFinder(const SceneView& scene, const FinderOptions& options) {
    validate(options.trace);
    state_ = std::make_unique<State>(scene, options);
}

PathFinder::PathFinder(PathFinder&&) noexcept = default;
PathFinder& PathFinder::operator=(PathFinder&&) noexcept = default;
PathFinder::~PathFinder() = default;

double PathFinder::max_radius() const noexcept {
    return state_->max_radius;
}

SourceBeamTree PathFinder::trace_source(const Vec3& source,
                                        FirstFacets first,
                                        Executor& executor,
                                        Progress* progress) const {
    EARSHOT_ASSERT(glm::length(source) <= state_->max_radius);
    auto kept = std::make_unique<SourceBeamTree::Kept>();
    kept->source = source;
    if (state_->trace.max_order > 0) {
        for (BeamRecorder& task : state_->tracer.trace<BeamRecorder>(
                 source, first, [] { return BeamRecorder(); }, executor, progress)) {
            kept->parts.push_back(task.take_tree());
        }
    }
    return SourceBeamTree(std::move(kept));
}

ListenerBeamTree PathFinder::trace_listeners(std::span<const Vec3> listeners,
                                             Executor& executor) const {
    const State& state = *state_;
    auto kept = std::make_unique<ListenerBeamTree::Kept>();
    kept->listeners.assign(listeners.begin(), listeners.end());
    if (state.trace.max_order == 0) {
        return ListenerBeamTree(std::move(kept));
    }
    const bool are_few =
        state.trace.mode == Mode::complete && listeners.size() <= kMaxListenersWithBeams;
    if (!state.bidirectional && !are_few) {
        kept->points.emplace(listeners);
    } else {
        kept->beams.emplace(state.index,
                            state.verifier.contact_radius(),
                            state.max_radius,
                            kept->listeners,
                            state.bidirectional && state.trace.max_order > 1,
                            executor);
    }
    return ListenerBeamTree(std::move(kept));
}

TraceResult PathFinder::connect(const SourceBeamTree& source,
                                const ListenerBeamTree& listeners,
                                Executor& executor) const {
    const State& state = *state_;
    const ListenerSet set = listeners.kept_->set();
    const auto& parts = source.kept_->parts;
    TaskResult result = state.find_direct(source.source(), set);
    std::vector<TaskResult> results(parts.size());
    executor.for_each(parts.size(), 1, [&](std::size_t begin, std::size_t end) {
        VisibleFacets search = state.tracer.make_search();
        for (std::size_t i = begin; i < end; ++i) {
            CandidateGenerator generator = state.generator(source.source(), set);
            for (const BeamNode& node : parts[i].nodes) {
                // The nodes are in depth-first order: back up to the node's parent, then down.
                while (generator.order() >= std::max<std::size_t>(node.order, 1)) {
                    generator.pop();
                }
                if (node.order > 0) {
                    generator.push(node.frustum.facet);
                }
                search.set_frustum(node.frustum);
                generator.generate_from(search, parts[i].visible_in(node));
            }
            results[i] = generator.take_result();
        }
    });
    for (TaskResult& part : results) {
        result.append(std::move(part));
    }
    return state.finish(std::move(result));
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
    const ListenerSet set = listeners.kept_->set();
    TaskResult result = state.find_direct(source, set);
    if (state.trace.max_order > 0) {
        const auto make_task = [&] { return CandidateTask(state.generator(source, set)); };
        for (CandidateTask& task :
             state.tracer.trace<CandidateTask>(source, first, make_task, executor, progress)) {
            result.append(task.take_result());
        }
    }
    return state.finish(std::move(result));
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
