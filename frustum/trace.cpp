// SPDX-License-Identifier: MIT
#include "earshot/frustum/trace.h"

#include "earshot/base/error.h"
#include "earshot/frustum/image_path.h"
#include "earshot/frustum/internal/facet_index.h"
#include "earshot/frustum/internal/last_reflection.h"
#include "earshot/frustum/internal/path_order.h"
#include "earshot/frustum/internal/visible_facets.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <string>

namespace earshot::frustum {

using geometry::FacetId;
using geometry::Vec3;

namespace {

// Complete mode: one frustum per cube face was fastest in scenes of 6 to 3,000 facets, by a tenth
// to a third over 32 sub-frusta and more.
constexpr int kCompleteResolution = 8;
constexpr int kSampledResolution = 32;
constexpr int kMaxResolution = 1024;
constexpr int kMaxOrder = 64;

/// Up to so many listeners last reflections are looked for listener by listener (LastReflections);
/// for more of them the frustum's facets are drawn once for all. The answer is the same.
constexpr std::size_t kFewListeners = 32;

/// What one task of the search brings home.
struct Harvest {
    std::vector<SpecularPath> paths;
    TraceStatistics statistics;

    void append(Harvest&& other) {
        std::move(other.paths.begin(), other.paths.end(), std::back_inserter(paths));
        statistics.frusta += other.statistics.frusta;
        statistics.candidates += other.statistics.candidates;
    }
};

/// Everything that the tasks of one trace share and only read.
struct Task {
    const FacetIndex& index;
    const PathVerifier& verifier;
    std::span<const Vec3> listeners;
    const TraceOptions& options;
    double listener_reach = 0.0;  // largest distance from the origin, metres
};

/// Follows one frustum and all its reflections, depth first. One object per thread of work: it
/// keeps a search per order so that a parent's findings survive its children's searches.
class FrustumWalk {
public:
    FrustumWalk(const Task& task, const Vec3& source)
        : task_(task), last_reflections_(task.index, task.listener_reach), images_{source} {
        for (int order = 0; order < task.options.max_order; ++order) {
            searches_.emplace_back(
                task.index, task.options.mode, task.verifier.contact_reach(), task.listener_reach);
        }
    }

    /// Looks into a source's frustum; the reflected frusta that are worth following.
    std::vector<Frustum> first_reflections(const Frustum& frustum) {
        std::vector<Frustum> children;
        visit(frustum, [&](const Frustum& child) { children.push_back(child); });
        return children;
    }

    /// Visits a reflected frustum, proposes its sequence to the listeners in it, and goes on.
    void follow(const Frustum& frustum) {
        sequence_.push_back(frustum.facet);
        images_.push_back(frustum.apex);
        visit(frustum, [&](const Frustum& child) { follow(child); });
        sequence_.pop_back();
        images_.pop_back();
    }

    Harvest take_harvest() { return std::move(harvest_); }

private:
    template <typename VisitChild>
    void visit(const Frustum& frustum, VisitChild&& visit_child) {
        VisibleFacets& search = searches_[sequence_.size()];
        ++harvest_.statistics.frusta;
        const bool next_is_last = static_cast<int>(sequence_.size()) + 1 == task_.options.max_order;
        const bool is_cheap =
            task_.options.mode == Mode::complete && task_.listeners.size() <= kFewListeners;
        if (next_is_last && is_cheap) {
            search.enter(frustum);
        } else {
            search.search(frustum);
        }
        if (!sequence_.empty()) {
            propose_if([&](const Vec3& listener) { return search.may_reach(listener); });
        }
        if (next_is_last && is_cheap) {
            for (const LastReflection& last : last_reflections_.find(frustum, task_.listeners)) {
                with_facet(last.facet, [&] { propose(last.listener); });
            }
            return;
        }
        for (const VisibleFacet& visible : search.found()) {
            if (next_is_last) {
                with_facet(visible.facet, [&] {
                    propose_if([&](const Vec3& listener) {
                        return search.may_reach_mirrored(visible, listener);
                    });
                });
            } else {
                visit_child(search.reflect(visible));
            }
        }
    }

    /// Calls body with the sequence one facet longer. A last reflection needs no frustum of its
    /// own: nine in ten would be last ones.
    template <typename Body>
    void with_facet(FacetId facet, Body&& body) {
        sequence_.push_back(facet);
        images_.push_back(task_.index.plane(facet).mirror(images_.back()));
        body();
        sequence_.pop_back();
        images_.pop_back();
    }

    template <typename MayReach>
    void propose_if(MayReach&& may_reach) {
        for (std::size_t i = 0; i < task_.listeners.size(); ++i) {
            if (may_reach(task_.listeners[i])) {
                propose(i);
            }
        }
    }

    void propose(std::size_t listener) {
        ++harvest_.statistics.candidates;
        if (auto path = task_.verifier.verify(sequence_, images_, task_.listeners[listener])) {
            path->listener = listener;
            harvest_.paths.push_back(std::move(*path));
        }
    }

    const Task& task_;
    std::vector<VisibleFacets> searches_;
    LastReflections last_reflections_;
    std::vector<FacetId> sequence_;
    std::vector<Vec3> images_;
    Harvest harvest_;
};

void check_options(const TraceOptions& options) {
    if (options.max_order < 0 || options.max_order > kMaxOrder) {
        throw Error("order",
                    "must be 0 to " + std::to_string(kMaxOrder) + ", not " +
                        std::to_string(options.max_order));
    }
    if (options.resolution < 0 || options.resolution > kMaxResolution) {
        throw Error("resolution",
                    "must be 0 (the default) to " + std::to_string(kMaxResolution) + ", not " +
                        std::to_string(options.resolution));
    }
}

Harvest find_direct_paths(const Task& task, const Vec3& source) {
    Harvest harvest;
    for (std::size_t i = 0; i < task.listeners.size(); ++i) {
        ++harvest.statistics.candidates;
        if (auto path = task.verifier.verify({}, std::span(&source, 1), task.listeners[i])) {
            path->listener = i;
            harvest.paths.push_back(std::move(*path));
        }
    }
    return harvest;
}

/// Runs body(walk, i) for i in [0, count), a walk per chunk, and joins the harvests in order.
template <typename Body>
Harvest walk_all(
    const Task& task, const Vec3& source, std::size_t count, Executor& executor, Body&& body) {
    constexpr std::size_t kGrain = 4;
    std::vector<Harvest> harvests(chunk_count(count, kGrain));
    executor.for_each(count, kGrain, [&](std::size_t begin, std::size_t end) {
        FrustumWalk walk(task, source);
        for (std::size_t i = begin; i < end; ++i) {
            body(walk, i);
        }
        harvests[begin / kGrain] = walk.take_harvest();
    });
    Harvest all;
    for (Harvest& harvest : harvests) {
        all.append(std::move(harvest));
    }
    return all;
}

}  // namespace

TraceResult find_specular_paths(const Surroundings& surroundings,
                                const Vec3& source,
                                std::span<const Vec3> listeners,
                                const TraceOptions& options,
                                Executor& executor) {
    check_options(options);
    const FacetIndex index(surroundings);
    const PathVerifier verifier(surroundings);
    Task task{index, verifier, listeners, options};
    for (const Vec3& listener : listeners) {
        task.listener_reach = std::max(task.listener_reach, glm::length(listener));
    }
    Harvest harvest = find_direct_paths(task, source);

    if (options.max_order > 0) {
        const int default_resolution =
            options.mode == Mode::complete ? kCompleteResolution : kSampledResolution;
        const int resolution = options.resolution > 0 ? options.resolution : default_resolution;
        const int cells = std::min(resolution, kGridSide);
        const int pieces = (resolution + cells - 1) / cells;
        const double least_depth = 0.5 * kRounding * index.scale();
        const auto roots = frusta_around(source, pieces, cells, least_depth);

        std::vector<std::vector<Frustum>> reflections(roots.size());
        harvest.append(
            walk_all(task, source, roots.size(), executor, [&](FrustumWalk& walk, std::size_t i) {
                reflections[i] = walk.first_reflections(roots[i]);
            }));
        std::vector<Frustum> first;
        for (const auto& of_root : reflections) {
            first.insert(first.end(), of_root.begin(), of_root.end());
        }
        harvest.append(
            walk_all(task, source, first.size(), executor, [&](FrustumWalk& walk, std::size_t i) {
                walk.follow(first[i]);
            }));
    }

    sort_and_unify(harvest.paths, surroundings.facets, verifier.scale());
    harvest.statistics.paths = harvest.paths.size();
    return {.paths = std::move(harvest.paths), .statistics = harvest.statistics};
}

}  // namespace earshot::frustum
