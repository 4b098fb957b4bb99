// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/assert.h"
#include "earshot/base/parallel.h"
#include "earshot/base/stage_progress.h"
#include "earshot/frustum/internal/facet_index.h"
#include "earshot/frustum/internal/frustum.h"
#include "earshot/frustum/internal/kept_connections.h"
#include "earshot/frustum/internal/primary_facets.h"
#include "earshot/frustum/internal/visible_facets.h"
#include "earshot/frustum/path_finder.h"
#include "earshot/frustum/paths.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace earshot::frustum {

/// A node of a beam tree: a frustum and the facets that are visible in it.
struct BeamNode {
    Frustum frustum;
    std::size_t order = 0;  ///< reflections so far
    std::size_t visible_begin = 0, visible_end = 0;
    bool is_continued = false;   ///< the same frustum as that of another node, with further facets
    OccluderDepths occluders{};  ///< of a frustum that starts at a facet
};

/// A part of the beam tree of a point (Heckbert and Hanrahan 1984; Funkhouser et al. 1998). The
/// children of a node are its frustum mirrored in the facets that are visible in it:
///
///     source            order 0: the frusta around the source
///     |-- f1            order 1: mirrored in the facets that are visible there
///     |   |-- f2        order 2: mirrored in the facets visible through f1
///     |   `-- f3
///     `-- f2
///         |-- f1
///         `-- f4
///
/// Nodes are in depth-first order, each before its children.
struct BeamTree {
    std::vector<BeamNode> nodes;
    std::vector<VisibleFacet> visible;
    /// Of an updated tree, per visible facet: where it was visible through the same aperture of the
    /// same frustum before, counted over all parts of the tree; kNotBefore: nowhere. May be
    /// shorter.
    std::vector<std::uint32_t> visible_before{};

    std::span<const VisibleFacet> visible_in(const BeamNode& node) const {
        return std::span(visible).subspan(node.visible_begin,
                                          node.visible_end - node.visible_begin);
    }
    std::uint32_t position_before(std::size_t position) const noexcept {
        return position < visible_before.size() ? visible_before[position] : kNotBefore;
    }
};

class BeamRecorder;
class GeometryChange;

/// The parts of a beam tree that has been brought up to date.
struct UpdatedBeams {
    std::vector<BeamTree> parts;
    std::uint64_t kept_frusta = 0;  ///< that were not traced again
};

/// Traces the beam tree of a source down to a given order.
class BeamTracer {
public:
    /// `orders`: frusta of this order and above are not traced. `max_radius`: the largest distance
    /// of a source or listener from the origin, metres. Facets in whose plane an apex lies are
    /// never reflected in; those that are kept are visible.
    BeamTracer(const FacetIndex& index,
               const TraceOptions& options,
               double contact_radius,
               double max_radius,
               int orders,
               GrazingFacets grazing_facets = GrazingFacets::skip);

    /// Calls task.visit(search) for every frustum, depth first within a task, and task.push(facet)
    /// and task.pop() around those of higher order. Frusta around the source and the subtrees of
    /// order 1 are divided among tasks, made by make_task() and returned in order. `mask`: facets
    /// that may reflect first; empty: all. Reports the stage "tracing", subtree by subtree.
    /// If tasks have a member visit_more(search), the facets visible in a frustum around the source
    /// may be divided: it is called for all but the first of them, and occluders are not known.
    template <typename Task, typename MakeTask>
    std::vector<Task> trace(const geometry::Vec3& source,
                            std::span<const std::uint8_t> mask,
                            MakeTask&& make_task,
                            Executor& executor,
                            Progress* progress) const;

    /// The beam tree of a source, from that of the same source before a change. Only frusta are
    /// traced that swept boxes meet, or that are others than before. Preconditions: the change is
    /// not total; `before` is of a tracer with the same options and had no mask; all frusta are
    /// followed. Reports the stage "tracing".
    UpdatedBeams update(const geometry::Vec3& source,
                        std::span<const BeamTree> before,
                        const GeometryChange& change,
                        Executor& executor,
                        Progress* progress) const;

    VisibleFacets make_search() const;
    /// Follows a share of the frusta of an order only.
    void set_sample(const BeamSample& sample) { sample_ = sample; }

private:
    static constexpr std::size_t kGrain = 4;

    template <typename Task>
    static constexpr bool divides_facets() {
        return requires(Task & task, const VisibleFacets& search) {
            task.visit_more(search);
        };
    }

    std::vector<Frustum> frusta_around_source(const geometry::Vec3& source) const;
    /// The frusta around the source, and what they reflect.
    template <typename Task, typename MakeTask>
    std::vector<std::optional<Task>> trace_primary(std::span<const Frustum> primary,
                                                   std::span<const std::uint8_t> mask,
                                                   MakeTask&& make_task,
                                                   std::vector<std::vector<Frustum>>& reflections,
                                                   Executor& executor) const;
    bool may_reflect(const Frustum& frustum, const VisibleFacet& visible) const;
    /// Whether a frustum is of the share that is followed.
    bool is_followed(const Frustum& frustum, std::size_t order) const;
    template <typename Task>
    void trace_subtree(const Frustum& frustum,
                       std::vector<VisibleFacets>& searches,
                       Task& task) const;
    class Update;

    const FacetIndex& index_;
    TraceOptions options_;
    double contact_radius_;
    double max_radius_;
    int orders_;
    GrazingFacets grazing_facets_;
    int primary_pieces_;
    BeamSample sample_{};
};

/// A task of BeamTracer::trace that records the tree.
class BeamRecorder {
public:
    void push(geometry::FacetId) { ++order_; }
    void pop() { --order_; }
    std::size_t order() const { return order_; }
    void visit(const VisibleFacets& search) {
        record(search.frustum(), search.found(), search.occluder_depths());
    }
    void visit_more(const VisibleFacets& search) {
        record(search.frustum(), search.found(), {}, true);
    }
    /// `before`: see BeamTree::visible_before; empty: there was none of them.
    void record(const Frustum& frustum,
                std::span<const VisibleFacet> visible,
                const OccluderDepths& occluders,
                bool is_continued = false,
                std::span<const std::uint32_t> before = {});
    BeamTree take_tree() { return std::move(tree_); }

private:
    BeamTree tree_;
    std::size_t order_ = 0;
};

template <typename Task>
void BeamTracer::trace_subtree(const Frustum& frustum,
                               std::vector<VisibleFacets>& searches,
                               Task& task) const {
    VisibleFacets& search = searches[task.order()];
    search.search(frustum);
    task.visit(search);
    if (static_cast<int>(task.order()) + 1 >= orders_) {
        return;
    }
    for (const VisibleFacet& visible : search.found()) {
        if (may_reflect(search.frustum(), visible)) {
            const Frustum child = search.reflect(visible);
            if (is_followed(child, task.order() + 1)) {
                task.push(child.facet);
                trace_subtree(child, searches, task);
                task.pop();
            }
        }
    }
}

template <typename Task, typename MakeTask>
std::vector<std::optional<Task>> BeamTracer::trace_primary(
    std::span<const Frustum> primary,
    std::span<const std::uint8_t> mask,
    MakeTask&& make_task,
    std::vector<std::vector<Frustum>>& reflections,
    Executor& executor) const {
    const auto visit_and_reflect = [&](VisibleFacets& search, Task& task, bool is_first) {
        if constexpr (divides_facets<Task>()) {
            is_first ? task.visit(search) : task.visit_more(search);
        } else {
            task.visit(search);
        }
        std::vector<Frustum> reflected;
        for (const VisibleFacet& visible : search.found()) {
            if (orders_ > 1 && may_reflect(search.frustum(), visible)) {
                const Frustum child = search.reflect(visible);
                if (is_followed(child, 1)) {
                    reflected.push_back(child);
                }
            }
        }
        return reflected;
    };
    std::vector<std::optional<Task>> tasks;
    if constexpr (divides_facets<Task>()) {
        auto visible = find_primary_facets(
            primary, primary_pieces_, [&] { return make_search(); }, executor);
        for (std::vector<VisibleFacet>& facets : visible) {
            std::erase_if(facets, [&](const VisibleFacet& facet) {
                return !mask.empty() && mask[facet.facet] == 0;
            });
        }
        const std::vector<FacetRange> ranges = divide_facets(visible);
        reflections.resize(ranges.size());
        tasks.resize(ranges.size());
        executor.for_each(ranges.size(), 1, [&](std::size_t begin, std::size_t end) {
            VisibleFacets search = make_search();
            for (std::size_t i = begin; i < end; ++i) {
                const FacetRange& range = ranges[i];
                search.set_frustum(primary[range.frustum],
                                   std::span(visible[range.frustum])
                                       .subspan(range.begin, range.end - range.begin));
                reflections[i] =
                    visit_and_reflect(search, tasks[i].emplace(make_task()), range.begin == 0);
            }
        });
    } else {
        reflections.resize(primary.size());
        tasks.resize(primary.size());
        executor.for_each(primary.size(), 1, [&](std::size_t begin, std::size_t end) {
            VisibleFacets search = make_search();
            for (std::size_t i = begin; i < end; ++i) {
                search.search(primary[i]);
                if (!mask.empty()) {
                    search.filter(mask);
                }
                reflections[i] = visit_and_reflect(search, tasks[i].emplace(make_task()), true);
            }
        });
    }
    return tasks;
}

template <typename Task, typename MakeTask>
std::vector<Task> BeamTracer::trace(const geometry::Vec3& source,
                                    std::span<const std::uint8_t> mask,
                                    MakeTask&& make_task,
                                    Executor& executor,
                                    Progress* progress) const {
    EARSHOT_ASSERT(mask.empty() || mask.size() == index_.size());
    // The frusta around the source, and their reflections.
    std::vector<std::vector<Frustum>> reflections;
    auto root_tasks =
        trace_primary<Task>(frusta_around_source(source), mask, make_task, reflections, executor);
    // The subtrees of the reflections, in the order of the roots.
    std::vector<Frustum> subtrees;
    for (const auto& of_root : reflections) {
        subtrees.insert(subtrees.end(), of_root.begin(), of_root.end());
    }
    std::vector<std::optional<Task>> subtree_tasks(chunk_count(subtrees.size(), kGrain));
    StageProgress traced(progress, "tracing", subtrees.size());
    executor.for_each(subtrees.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        std::vector<VisibleFacets> searches;  // one per order
        for (int order = 0; order < orders_; ++order) {
            searches.push_back(make_search());
        }
        Task& task = subtree_tasks[begin / kGrain].emplace(make_task());
        for (std::size_t i = begin; i < end; ++i) {
            task.push(subtrees[i].facet);
            trace_subtree(subtrees[i], searches, task);
            task.pop();
        }
        traced.add(end - begin);
    });
    std::vector<Task> tasks;
    for (auto* some : {&root_tasks, &subtree_tasks}) {
        for (auto& task : *some) {
            tasks.push_back(std::move(*task));
        }
    }
    return tasks;
}

}  // namespace earshot::frustum
