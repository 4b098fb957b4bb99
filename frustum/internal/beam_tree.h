// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/assert.h"
#include "earshot/base/parallel.h"
#include "earshot/base/stage_progress.h"
#include "earshot/frustum/internal/facet_index.h"
#include "earshot/frustum/internal/frustum.h"
#include "earshot/frustum/internal/visible_facets.h"
#include "earshot/frustum/path_finder.h"
#include "earshot/frustum/paths.h"

#include <cstddef>
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

    std::span<const VisibleFacet> visible_in(const BeamNode& node) const {
        return std::span(visible).subspan(node.visible_begin,
                                          node.visible_end - node.visible_begin);
    }
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
    template <typename Task, typename MakeTask>
    std::vector<Task> trace(const geometry::Vec3& source,
                            std::span<const std::uint8_t> mask,
                            MakeTask&& make_task,
                            Executor& executor,
                            Progress* progress) const;

    VisibleFacets make_search() const;
    /// Follows a share of the frusta of an order only.
    void set_sample(const BeamSample& sample) { sample_ = sample; }

private:
    static constexpr std::size_t kGrain = 4;

    std::vector<Frustum> frusta_around_source(const geometry::Vec3& source) const;
    bool may_reflect(const Frustum& frustum, const VisibleFacet& visible) const;
    /// Whether a frustum is of the share that is followed.
    bool is_followed(const Frustum& frustum, std::size_t order) const;
    template <typename Task>
    void trace_subtree(const Frustum& frustum,
                       std::vector<VisibleFacets>& searches,
                       Task& task) const;

    const FacetIndex& index_;
    TraceOptions options_;
    double contact_radius_;
    double max_radius_;
    int orders_;
    GrazingFacets grazing_facets_;
    BeamSample sample_{};
};

/// A task of BeamTracer::trace that records the tree.
class BeamRecorder {
public:
    void push(geometry::FacetId) { ++order_; }
    void pop() { --order_; }
    std::size_t order() const { return order_; }
    void visit(const VisibleFacets& search);
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
std::vector<Task> BeamTracer::trace(const geometry::Vec3& source,
                                    std::span<const std::uint8_t> mask,
                                    MakeTask&& make_task,
                                    Executor& executor,
                                    Progress* progress) const {
    EARSHOT_ASSERT(mask.empty() || mask.size() == index_.size());
    // The frusta around the source, and their reflections.
    const auto roots = frusta_around_source(source);
    std::vector<std::vector<Frustum>> reflections(roots.size());
    std::vector<std::optional<Task>> root_tasks(chunk_count(roots.size(), kGrain));
    executor.for_each(roots.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        VisibleFacets search = make_search();
        Task& task = root_tasks[begin / kGrain].emplace(make_task());
        for (std::size_t i = begin; i < end; ++i) {
            search.search(roots[i]);
            if (!mask.empty()) {
                search.filter(mask);
            }
            task.visit(search);
            for (const VisibleFacet& visible : search.found()) {
                if (orders_ > 1 && may_reflect(search.frustum(), visible)) {
                    const Frustum child = search.reflect(visible);
                    if (is_followed(child, 1)) {
                        reflections[i].push_back(child);
                    }
                }
            }
        }
    });
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
