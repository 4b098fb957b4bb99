// SPDX-License-Identifier: MIT
#include "earshot/frustum/path_finder.h"

#include "earshot/base/assert.h"
#include "earshot/base/error.h"
#include "earshot/frustum/internal/facet_index.h"
#include "earshot/frustum/internal/path_order.h"
#include "earshot/frustum/internal/proposer.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace earshot::frustum {

using geometry::Vec3;

namespace {

// Complete mode: one frustum per cube face was fastest in scenes of 6 to 3,000 facets, by a tenth
// to a third over 32 sub-frusta and more.
constexpr int kCompleteResolution = 8;
constexpr int kSampledResolution = 32;
constexpr int kMaxResolution = 1024;
constexpr int kMaxOrder = 64;

// Of so many listeners at most it is known which facets they see; more are looked for by place.
constexpr std::size_t kFewListeners = 64;

constexpr std::size_t kGrain = 4;

void check_options(const TraceOptions& options) {
    if (options.max_order < 0 || options.max_order > kMaxOrder) {
        throw Error("order",
                    "must be 0 to " + std::to_string(kMaxOrder) + ", not " +
                        std::to_string(options.max_order));
    }
    if (!(options.max_length >= 0.0)) {
        throw Error("longest path", "must not be negative");
    }
    if (!(options.min_pressure >= 0.0)) {
        throw Error("least pressure", "must not be negative");
    }
    if (options.resolution < 0 || options.resolution > kMaxResolution) {
        throw Error("resolution",
                    "must be 0 (the default) to " + std::to_string(kMaxResolution) + ", not " +
                        std::to_string(options.resolution));
    }
}

/// A frustum that was traced, and what it saw.
struct Look {
    Frustum frustum;
    std::size_t order = 0;
    std::size_t seen_begin = 0, seen_end = 0;
};

/// Looks in the order in which they were made: a frustum stands before those that it leads to.
struct Looks {
    std::vector<Look> looks;
    std::vector<VisibleFacet> seen;

    void append(const Looks& others) {
        for (Look look : others.looks) {
            look.seen_begin += seen.size();
            look.seen_end += seen.size();
            looks.push_back(look);
        }
        seen.insert(seen.end(), others.seen.begin(), others.seen.end());
    }
};

}  // namespace

struct SourceBeamTree::Kept {
    Vec3 source{0.0};
    std::vector<Looks> parts;  // of a few subtrees each, for a task each
};

struct ListenerBeamTree::Kept {
    std::vector<Vec3> listeners;
    std::optional<ListenerSide> side;
    std::optional<ListenerPoints> points;
};

struct PathFinder::State {
    State(const SceneView& the_scene, const FinderOptions& options)
        : scene(the_scene),
          index(the_scene),
          verifier(the_scene),
          trace(options.trace),
          is_half_way(options.trace.mode == Mode::complete && !options.forward_only),
          max_radius(options.max_radius > 0.0 ? options.max_radius : 16.0 * index.scale()) {}

    SceneView scene;
    FacetIndex index;
    PathVerifier verifier;
    TraceOptions trace;
    bool is_half_way;
    double max_radius;

    /// Frusta of this order and above are not traced: listeners are met before.
    int orders_traced() const {
        return is_half_way ? std::max(trace.max_order - 1, std::min(trace.max_order, 1))
                           : trace.max_order;
    }

    std::vector<Frustum> roots(const Vec3& source) const {
        const int default_resolution =
            trace.mode == Mode::complete ? kCompleteResolution : kSampledResolution;
        const int resolution = trace.resolution > 0 ? trace.resolution : default_resolution;
        const int cells = std::min(resolution, kGridSide);
        const int pieces = (resolution + cells - 1) / cells;
        const double least_depth = 0.5 * kRounding * index.scale();
        return frusta_around(source, pieces, cells, least_depth);
    }

    VisibleFacets new_search() const {
        return {index, trace.mode, verifier.contact_reach(), max_radius};
    }

    /// Calls use(task, search, frustum) for every frustum from the source, depth first within a
    /// task, and enter(task, frustum), leave(task) around those of higher order. Returns the tasks.
    template <typename Task, typename MakeTask>
    std::vector<Task> walk(const Vec3& source,
                           FirstFacets first,
                           MakeTask&& make_task,
                           Executor& executor) const;

    template <typename Task>
    void follow(const Frustum& frustum, std::vector<VisibleFacets>& searches, Task& task) const;

    /// Whether a path over the facet can be within the limits: it is at least as long as the way
    /// from the image source to the facet's box.
    bool leads_on(const Frustum& frustum, const VisibleFacet& visible) const {
        constexpr double kRoom = 1.0 - 0x1p-30;  // for the rounding of this bound
        const geometry::Aabb& box = index.box(visible.facet);
        Vec3 nearest;
        for (int k = 0; k < 3; ++k) {
            const auto axis = static_cast<std::size_t>(k);
            nearest[k] = std::clamp(frustum.apex[k],
                                    static_cast<double>(box.lower[axis]),
                                    static_cast<double>(box.upper[axis]));
        }
        const double length = kRoom * glm::distance(frustum.apex, nearest);
        const double factor =
            frustum.max_pressure_factor * index.max_pressure_factor(visible.facet);
        return length <= trace.max_length && !(factor < kRoom * trace.min_pressure * length);
    }

    Proposer proposer(const Vec3& source, const Audience& audience) const {
        return {index, verifier, audience, trace, max_radius, source};
    }

    TraceResult finish(Harvest harvest) const {
        sort_and_unify(harvest.paths, scene.facets, verifier.scale());
        harvest.statistics.paths = harvest.paths.size();
        return {.paths = std::move(harvest.paths), .statistics = harvest.statistics};
    }
};

namespace {

Audience audience_of(std::span<const Vec3> listeners,
                     const std::optional<ListenerSide>& side,
                     const std::optional<ListenerPoints>& points) {
    return {.listeners = listeners,
            .side = side ? &*side : nullptr,
            .points = points ? &*points : nullptr};
}

/// Proposes paths as it goes.
class Finding {
public:
    explicit Finding(Proposer proposer) : proposer_(std::move(proposer)) {}
    void enter(const Frustum& frustum) { proposer_.push(frustum.facet); }
    void leave() { proposer_.pop(); }
    std::size_t order() const { return proposer_.order(); }
    void see(const VisibleFacets& search) {
        ++frusta_;
        proposer_.propose_from(search, search.found());
    }
    Harvest take_harvest() {
        Harvest harvest = proposer_.take_harvest();
        harvest.statistics.frusta += frusta_;
        return harvest;
    }

private:
    Proposer proposer_;
    std::uint64_t frusta_ = 0;
};

/// Writes down what was seen.
class Keeping {
public:
    void enter(const Frustum&) { ++order_; }
    void leave() { --order_; }
    std::size_t order() const { return order_; }
    void see(const VisibleFacets& search) {
        const std::size_t begin = looks.seen.size();
        looks.seen.insert(looks.seen.end(), search.found().begin(), search.found().end());
        looks.looks.push_back({search.frustum(), order_, begin, looks.seen.size()});
    }

    Looks looks;

private:
    std::size_t order_ = 0;
};

}  // namespace

template <typename Task>
void PathFinder::State::follow(const Frustum& frustum,
                               std::vector<VisibleFacets>& searches,
                               Task& task) const {
    VisibleFacets& search = searches[task.order()];
    search.search(frustum);
    task.see(search);
    if (static_cast<int>(task.order()) + 1 >= orders_traced()) {
        return;
    }
    for (const VisibleFacet& visible : search.found()) {
        if (leads_on(search.frustum(), visible)) {
            const Frustum child = search.reflect(visible);
            task.enter(child);
            follow(child, searches, task);
            task.leave();
        }
    }
}

template <typename Task, typename MakeTask>
std::vector<Task> PathFinder::State::walk(const Vec3& source,
                                          FirstFacets first,
                                          MakeTask&& make_task,
                                          Executor& executor) const {
    EARSHOT_ASSERT(first.empty() || first.size() == scene.facets.facets.size());
    const auto around = roots(source);
    std::vector<std::vector<Frustum>> reflections(around.size());
    std::vector<std::optional<Task>> of_roots(chunk_count(around.size(), kGrain));
    executor.for_each(around.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        VisibleFacets search = new_search();
        Task& task = of_roots[begin / kGrain].emplace(make_task());
        for (std::size_t i = begin; i < end; ++i) {
            search.search(around[i]);
            if (!first.empty()) {
                search.leave_out(first);
            }
            task.see(search);
            for (const VisibleFacet& visible : search.found()) {
                if (orders_traced() > 1 && leads_on(search.frustum(), visible)) {
                    reflections[i].push_back(search.reflect(visible));
                }
            }
        }
    });
    std::vector<Frustum> second;
    for (const auto& of_root : reflections) {
        second.insert(second.end(), of_root.begin(), of_root.end());
    }
    std::vector<std::optional<Task>> of_second(chunk_count(second.size(), kGrain));
    executor.for_each(second.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        std::vector<VisibleFacets> searches;
        for (int order = 0; order < orders_traced(); ++order) {
            searches.push_back(new_search());
        }
        Task& task = of_second[begin / kGrain].emplace(make_task());
        for (std::size_t i = begin; i < end; ++i) {
            task.enter(second[i]);
            follow(second[i], searches, task);
            task.leave();
        }
    });
    std::vector<Task> tasks;
    for (auto* some : {&of_roots, &of_second}) {
        for (auto& task : *some) {
            tasks.push_back(std::move(*task));
        }
    }
    return tasks;
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
    for (const Looks& part : kept_->parts) {
        count += part.looks.size();
    }
    return count;
}

std::size_t SourceBeamTree::bytes() const noexcept {
    std::size_t bytes = 0;
    for (const Looks& part : kept_->parts) {
        bytes += part.looks.size() * sizeof(Look) + part.seen.size() * sizeof(VisibleFacet);
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
    return kept_->side ? kept_->side->frusta() : 0;
}

// In a concert hall of 3,754 facets both ways took equally long for 1, 12 and 50 listeners at
// orders 2, 3 and 4.
bool prefer_forward(std::size_t listeners, int max_order) noexcept {
    constexpr std::size_t kMost = 768;
    if (max_order <= 2) {
        return listeners > 1;
    }
    const int steps = std::min(max_order - 3, 3);
    return listeners > std::min(kMost, std::size_t{12} << (2 * steps));
}

PathFinder::PathFinder(const SceneView& scene, const FinderOptions& options) {
    check_options(options.trace);
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
                                        Executor& executor) const {
    EARSHOT_ASSERT(glm::length(source) <= state_->max_radius);
    auto kept = std::make_unique<SourceBeamTree::Kept>();
    kept->source = source;
    if (state_->trace.max_order > 0) {
        for (Keeping& task : state_->walk<Keeping>(
                 source, first, [] { return Keeping(); }, executor)) {
            kept->parts.push_back(std::move(task.looks));
        }
    }
    return SourceBeamTree(std::move(kept));
}

ListenerBeamTree PathFinder::trace_listeners(std::span<const Vec3> listeners,
                                             Executor& executor) const {
    const State& state = *state_;
    auto kept = std::make_unique<ListenerBeamTree::Kept>();
    kept->listeners.assign(listeners.begin(), listeners.end());
    const bool are_few = state.trace.mode == Mode::complete && listeners.size() <= kFewListeners;
    if (state.trace.max_order == 0) {
        return ListenerBeamTree(std::move(kept));
    }
    if (!state.is_half_way && !are_few) {
        kept->points.emplace(listeners);
    } else {
        kept->side.emplace(state.index,
                           state.verifier.contact_reach(),
                           state.max_radius,
                           kept->listeners,
                           state.is_half_way && state.trace.max_order > 1,
                           executor);
    }
    return ListenerBeamTree(std::move(kept));
}

TraceResult PathFinder::connect(const SourceBeamTree& source,
                                const ListenerBeamTree& listeners,
                                Executor& executor) const {
    const State& state = *state_;
    const ListenerBeamTree::Kept& to = *listeners.kept_;
    const Audience audience = audience_of(to.listeners, to.side, to.points);
    const auto& parts = source.kept_->parts;
    Proposer direct = state.proposer(source.source(), audience);
    direct.propose_direct();
    Harvest harvest = direct.take_harvest();
    std::vector<Harvest> harvests(parts.size());
    executor.for_each(parts.size(), 1, [&](std::size_t begin, std::size_t end) {
        VisibleFacets search = state.new_search();
        for (std::size_t i = begin; i < end; ++i) {
            Proposer proposer = state.proposer(source.source(), audience);
            for (const Look& look : parts[i].looks) {
                while (proposer.order() >= std::max<std::size_t>(look.order, 1)) {
                    proposer.pop();
                }
                if (look.order > 0) {
                    proposer.push(look.frustum.facet);
                }
                search.enter(look.frustum);
                proposer.propose_from(
                    search,
                    std::span(parts[i].seen)
                        .subspan(look.seen_begin, look.seen_end - look.seen_begin));
            }
            harvests[i] = proposer.take_harvest();
        }
    });
    for (Harvest& part : harvests) {
        harvest.append(std::move(part));
    }
    return state.finish(std::move(harvest));
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
                             Executor& executor) const {
    EARSHOT_ASSERT(glm::length(source) <= state_->max_radius);
    const State& state = *state_;
    const ListenerBeamTree::Kept& to = *listeners.kept_;
    const Audience audience = audience_of(to.listeners, to.side, to.points);
    Proposer direct = state.proposer(source, audience);
    direct.propose_direct();
    Harvest harvest = direct.take_harvest();
    if (state.trace.max_order > 0) {
        const auto make_task = [&] { return Finding(state.proposer(source, audience)); };
        for (Finding& task : state.walk<Finding>(source, first, make_task, executor)) {
            harvest.append(task.take_harvest());
        }
    }
    return state.finish(std::move(harvest));
}

}  // namespace earshot::frustum
