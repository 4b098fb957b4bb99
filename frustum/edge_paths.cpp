// SPDX-License-Identifier: MIT
#include "earshot/frustum/edge_paths.h"

#include "earshot/base/error.h"
#include "earshot/frustum/internal/beam_tree.h"
#include "earshot/frustum/internal/edge_sides.h"
#include "earshot/frustum/internal/facet_index.h"
#include "earshot/frustum/path_verifier.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <string>
#include <tuple>
#include <utility>

namespace earshot::frustum {

using geometry::FacetId;
using geometry::Interval;
using geometry::Vec3;
using geometry::Wedge;

namespace {

constexpr int kMaxReflections = 16;

void validate(const EdgePathOptions& options) {
    if (options.max_reflections < 0 || options.max_reflections > kMaxReflections) {
        throw Error("reflections",
                    std::to_string(options.max_reflections) + " beside an edge",
                    "choose 0 to " + std::to_string(kMaxReflections));
    }
}

/// Per facet the wedges that it is a face of.
std::vector<std::vector<std::uint32_t>> wedges_by_facet(std::span<const Wedge> wedges,
                                                        std::size_t facets) {
    std::vector<std::vector<std::uint32_t>> of_facet(facets);
    for (std::size_t i = 0; i < wedges.size(); ++i) {
        for (const geometry::WedgeFace& face : wedges[i].faces) {
            std::vector<std::uint32_t>& list = of_facet[face.facet];
            if (list.empty() || list.back() != i) {
                list.push_back(static_cast<std::uint32_t>(i));
            }
        }
    }
    return of_facet;
}

/// A task of BeamTracer::trace that collects the wedges of the facets that are visible.
class EdgeCollector {
public:
    explicit EdgeCollector(const std::vector<std::vector<std::uint32_t>>& of_facet)
        : of_facet_(&of_facet) {}
    void push(FacetId facet) { sequence_.push_back(facet); }
    void pop() { sequence_.pop_back(); }
    std::size_t order() const { return sequence_.size(); }
    void visit(const VisibleFacets& search) {
        ++frusta_;
        for (const VisibleFacet& visible : search.found()) {
            for (const std::uint32_t wedge : (*of_facet_)[visible.facet]) {
                candidates_.push_back({wedge, sequence_});
            }
        }
    }
    std::vector<EdgeCandidate> take_candidates() { return std::move(candidates_); }
    std::uint64_t frusta() const { return frusta_; }

private:
    const std::vector<std::vector<std::uint32_t>>* of_facet_;
    std::vector<FacetId> sequence_;
    std::vector<EdgeCandidate> candidates_;
    std::uint64_t frusta_ = 0;
};

/// Both ends of a wedge's paths.
class EdgeJoin {
public:
    EdgeJoin(std::span<const Wedge> wedges, const EdgePathOptions& options)
        : wedges_(wedges), options_(options) {}

    void join(std::span<const EdgeSide> sources,
              std::span<const EdgeSide> listeners,
              std::size_t listener,
              std::vector<EdgePath>& paths) const;

private:
    void join(const EdgeSide& source,
              const EdgeSide& listener,
              std::size_t number,
              std::vector<EdgePath>& paths) const;

    std::span<const Wedge> wedges_;
    const EdgePathOptions& options_;
};

/// The place on the edge where the way from one image to the other is shortest, within a part.
double apex_of(const Wedge& wedge, const Vec3& source, const Vec3& listener, Interval part) {
    const geometry::WedgePoint s = geometry::wedge_coordinates(wedge, source);
    const geometry::WedgePoint r = geometry::wedge_coordinates(wedge, listener);
    return std::clamp(
        (s.z * r.radius + r.z * s.radius) / (s.radius + r.radius), part.min, part.max);
}

void EdgeJoin::join(const EdgeSide& source,
                    const EdgeSide& listener,
                    std::size_t number,
                    std::vector<EdgePath>& paths) const {
    const Wedge& wedge = wedges_[source.wedge];
    std::size_t i = 0, j = 0;
    while (i < source.parts.size() && j < listener.parts.size()) {
        const Interval& a = source.parts[i];
        const Interval& b = listener.parts[j];
        const Interval part{std::max(a.min, b.min), std::min(a.max, b.max)};
        if (part.min < part.max) {
            const Vec3 apex = wedge.point_at(apex_of(wedge, source.image, listener.image, part));
            const double length =
                glm::distance(source.image, apex) + glm::distance(apex, listener.image);
            if (length <= options_.max_length) {
                paths.push_back({.listener = number,
                                 .wedge = source.wedge,
                                 .before = source.sequence,
                                 .after = {listener.sequence.rbegin(), listener.sequence.rend()},
                                 .source_image = source.image,
                                 .listener_image = listener.image,
                                 .part = part,
                                 .length = length});
            }
        }
        ++(a.max < b.max ? i : j);
    }
}

void EdgeJoin::join(std::span<const EdgeSide> sources,
                    std::span<const EdgeSide> listeners,
                    std::size_t listener,
                    std::vector<EdgePath>& paths) const {
    const auto by_wedge = [](const EdgeSide& a, const EdgeSide& b) { return a.wedge < b.wedge; };
    for (const EdgeSide& source : sources) {
        const auto [first, last] =
            std::equal_range(listeners.begin(), listeners.end(), source, by_wedge);
        for (auto side = first; side != last; ++side) {
            if (source.sequence.size() + side->sequence.size() <=
                static_cast<std::size_t>(options_.max_reflections)) {
                join(source, *side, listener, paths);
            }
        }
    }
}

void sort_paths(std::vector<EdgePath>& paths) {
    std::sort(paths.begin(), paths.end(), [](const EdgePath& a, const EdgePath& b) {
        const auto key = [](const EdgePath& path) {
            return std::tuple(path.listener, path.wedge, path.before.size() + path.after.size());
        };
        const auto first = key(a);
        const auto second = key(b);
        return std::tie(first, a.before, a.after, a.part.min) <
               std::tie(second, b.before, b.after, b.part.min);
    });
}

/// Joins the sides of the source with those of every listener.
template <typename FindSides>
EdgePathResult join_all(std::span<const Wedge> wedges,
                        const Vec3& source,
                        std::span<const Vec3> listeners,
                        const EdgePathOptions& options,
                        const FindSides& find_sides_of) {
    EdgePathResult result;
    const std::vector<EdgeSide> from_source = find_sides_of(source, result.statistics);
    const EdgeJoin join(wedges, options);
    for (std::size_t i = 0; i < listeners.size(); ++i) {
        join.join(from_source, find_sides_of(listeners[i], result.statistics), i, result.paths);
    }
    sort_paths(result.paths);
    return result;
}

}  // namespace

EdgePathResult find_edge_paths(const SceneView& scene,
                               std::span<const Wedge> wedges,
                               const Vec3& source,
                               std::span<const Vec3> listeners,
                               const EdgePathOptions& options,
                               Executor& executor) {
    validate(options);
    const FacetIndex index(scene, executor);
    const PathVerifier verifier(scene);
    const auto of_facet = wedges_by_facet(wedges, index.size());
    double max_radius = glm::length(source);
    for (const Vec3& listener : listeners) {
        max_radius = std::max(max_radius, glm::length(listener));
    }
    TraceOptions trace;
    trace.max_order = options.max_reflections;
    trace.max_length = options.max_length;
    // An edge lies on the border of a facet that faces the sound, or the sound runs in the planes
    // of both faces: such facets are kept.
    const BeamTracer tracer(index,
                            trace,
                            verifier.contact_radius(),
                            max_radius,
                            options.max_reflections + 1,
                            GrazingFacets::keep);
    return join_all(
        wedges, source, listeners, options, [&](const Vec3& point, EdgeStatistics& statistics) {
            std::vector<EdgeCandidate> candidates;
            for (EdgeCollector& task : tracer.trace<EdgeCollector>(
                     point, {}, [&] { return EdgeCollector(of_facet); }, executor, nullptr)) {
                statistics.frusta += task.frusta();
                auto found = task.take_candidates();
                candidates.insert(candidates.end(),
                                  std::make_move_iterator(found.begin()),
                                  std::make_move_iterator(found.end()));
            }
            sort_and_deduplicate(candidates);
            statistics.candidates += candidates.size();
            return find_sides(scene, verifier, wedges, point, std::move(candidates), executor);
        });
}

EdgePathResult find_edge_paths_brute_force(const SceneView& scene,
                                           std::span<const Wedge> wedges,
                                           const Vec3& source,
                                           std::span<const Vec3> listeners,
                                           const EdgePathOptions& options) {
    validate(options);
    const PathVerifier verifier(scene);
    const auto facets = static_cast<FacetId>(scene.facets.facets.size());
    std::vector<EdgeCandidate> all;
    std::vector<std::vector<FacetId>> sequences{{}};
    for (std::size_t i = 0; i < sequences.size(); ++i) {
        const std::vector<FacetId> sequence = sequences[i];
        for (std::size_t wedge = 0; wedge < wedges.size(); ++wedge) {
            all.push_back({static_cast<std::uint32_t>(wedge), sequence});
        }
        if (sequence.size() == static_cast<std::size_t>(options.max_reflections)) {
            continue;
        }
        for (FacetId facet = 0; facet < facets; ++facet) {
            if (sequence.empty() || sequence.back() != facet) {
                sequences.push_back(sequence);
                sequences.back().push_back(facet);
            }
        }
    }
    sort_and_deduplicate(all);
    return join_all(
        wedges, source, listeners, options, [&](const Vec3& point, EdgeStatistics& statistics) {
            statistics.candidates += all.size();
            return find_sides(scene, verifier, wedges, point, all, Executor::serial());
        });
}

}  // namespace earshot::frustum
