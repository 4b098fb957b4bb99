// SPDX-License-Identifier: MIT
#include "earshot/frustum/edge_paths.h"

#include "earshot/base/error.h"
#include "earshot/frustum/internal/edge_sides.h"
#include "earshot/frustum/internal/facet_index.h"
#include "earshot/frustum/path_verifier.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>
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

/// The place on the edge where the way from one image to the other is shortest, within a part.
double apex_of(const Wedge& wedge, const Vec3& source, const Vec3& listener, Interval part) {
    const geometry::WedgePoint s = geometry::wedge_coordinates(wedge, source);
    const geometry::WedgePoint r = geometry::wedge_coordinates(wedge, listener);
    return std::clamp(
        (s.z * r.radius + r.z * s.radius) / (s.radius + r.radius), part.min, part.max);
}

Interval intersection(const Interval& a, const Interval& b) {
    return {std::max(a.min, b.min), std::min(a.max, b.max)};
}

/// Joins what a source and a listener reach.
class EdgeJoin {
public:
    EdgeJoin(std::span<const Wedge> wedges,
             const EdgePathOptions& options,
             const EdgePathFilter* filter,
             std::size_t listener)
        : wedges_(wedges), options_(options), filter_(filter), listener_(listener) {}

    /// Adds the paths over a wedge.
    void join(std::size_t wedge, EdgeSides& source, EdgeSides& listener);

    EdgePathResult take_result() { return std::move(result_); }

private:
    bool may_be_wanted(const Wedge& wedge,
                       const Interval& whole,
                       const EdgeEnd& source,
                       const EdgeEnd& listener) const;
    bool may_be_wanted(std::size_t wedge,
                       const Interval& within,
                       EdgeSides& source,
                       std::size_t i,
                       EdgeSides& listener,
                       std::size_t k) const;
    void add(std::size_t wedge,
             const EdgeSides& source,
             const EdgeCandidate& from,
             const EdgeSides& listener,
             const EdgeCandidate& to,
             Interval part);

    std::span<const Wedge> wedges_;
    const EdgePathOptions& options_;
    const EdgePathFilter* filter_;
    std::size_t listener_;
    EdgePathResult result_;
};

// No way over the edge is shorter than that over its line.
bool EdgeJoin::may_be_wanted(const Wedge& wedge,
                             const Interval& whole,
                             const EdgeEnd& source,
                             const EdgeEnd& listener) const {
    constexpr double kRoundedDown = 1.0 - 0x1p-30;
    const double radii = source.image.radius + listener.image.radius;
    const double rise = source.image.z - listener.image.z;
    if (kRoundedDown * std::sqrt(radii * radii + rise * rise) > options_.max_length) {
        return false;
    }
    return filter_ == nullptr || filter_->may_be_wanted(wedge, whole, source, listener, listener_);
}

// With what the facets of both sides reflect to, as far as it lies within a part.
bool EdgeJoin::may_be_wanted(std::size_t wedge,
                             const Interval& within,
                             EdgeSides& source,
                             std::size_t i,
                             EdgeSides& listener,
                             std::size_t k) const {
    Interval part = intersection(within, source.window(wedge, i));
    if (!part.is_empty()) {
        part = intersection(part, listener.window(wedge, k));
    }
    return !part.is_empty() &&
           (filter_ == nullptr || filter_->may_be_wanted(wedges_[wedge],
                                                         part,
                                                         source.of(wedge)[i].end,
                                                         listener.of(wedge)[k].end,
                                                         listener_));
}

void EdgeJoin::add(std::size_t wedge,
                   const EdgeSides& source,
                   const EdgeCandidate& from,
                   const EdgeSides& listener,
                   const EdgeCandidate& to,
                   Interval part) {
    const Vec3 source_image = source.images()[from.image].position;
    const Vec3 listener_image = listener.images()[to.image].position;
    const Vec3 apex =
        wedges_[wedge].point_at(apex_of(wedges_[wedge], source_image, listener_image, part));
    const double length = glm::distance(source_image, apex) + glm::distance(apex, listener_image);
    if (length > options_.max_length) {
        return;
    }
    std::vector<FacetId> after = listener.images().sequence(to.image);
    std::reverse(after.begin(), after.end());
    result_.paths.push_back({.listener = listener_,
                             .wedge = wedge,
                             .before = source.images().sequence(from.image),
                             .after = std::move(after),
                             .source_image = source_image,
                             .listener_image = listener_image,
                             .part = part,
                             .length = length});
}

void EdgeJoin::join(std::size_t wedge, EdgeSides& source, EdgeSides& listener) {
    const auto from = source.of(wedge);
    const auto to = listener.of(wedge);
    const Interval whole{0.0, wedges_[wedge].length()};
    for (std::size_t i = 0; i < from.size(); ++i) {
        for (std::size_t k = 0; k < to.size(); ++k) {
            // Candidates are in order of their reflections.
            if (from[i].end.reflections + to[k].end.reflections >
                static_cast<std::uint32_t>(options_.max_reflections)) {
                break;
            }
            const bool is_reflected = from[i].end.reflections + to[k].end.reflections > 0;
            if (!may_be_wanted(wedges_[wedge], whole, from[i].end, to[k].end) ||
                (is_reflected && !may_be_wanted(wedge, whole, source, i, listener, k))) {
                continue;
            }
            ++result_.statistics.pairs;
            // The side with fewer reflections costs less to decide.
            const bool source_first = from[i].end.reflections <= to[k].end.reflections;
            const std::span<const Interval> first =
                source_first ? source.parts(wedge, i) : listener.parts(wedge, k);
            if (first.empty() ||
                !may_be_wanted(
                    wedge, {first.front().min, first.back().max}, source, i, listener, k)) {
                continue;
            }
            const std::span<const Interval> of_source = source.parts(wedge, i);
            const std::span<const Interval> of_listener = listener.parts(wedge, k);
            std::size_t a = 0, b = 0;
            while (a < of_source.size() && b < of_listener.size()) {
                const Interval part = intersection(of_source[a], of_listener[b]);
                if (part.min < part.max) {
                    add(wedge, source, from[i], listener, to[k], part);
                }
                ++(of_source[a].max < of_listener[b].max ? a : b);
            }
        }
    }
}

/// Adds the paths between a source and a listener.
void join_all(std::span<const Wedge> wedges,
              const EdgePathOptions& options,
              const EdgePathFilter* filter,
              EdgeSides& source,
              EdgeSides& listener,
              std::size_t number,
              EdgePathResult& result,
              Executor& executor) {
    constexpr std::size_t kGrain = 32;
    std::vector<EdgePathResult> of_chunk(chunk_count(wedges.size(), kGrain));
    executor.for_each(wedges.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        EdgeJoin join(wedges, options, filter, number);
        for (std::size_t wedge = begin; wedge < end; ++wedge) {
            join.join(wedge, source, listener);
        }
        of_chunk[begin / kGrain] = join.take_result();
    });
    for (EdgePathResult& some : of_chunk) {
        result.paths.insert(result.paths.end(),
                            std::make_move_iterator(some.paths.begin()),
                            std::make_move_iterator(some.paths.end()));
        result.statistics.pairs += some.statistics.pairs;
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

/// What some points reach, by point.
class KeptSides {
public:
    /// Null if nothing is kept of the point. Else it counts as used.
    EdgeSides* find(const Vec3& point) {
        for (Entry& entry : entries_) {
            if (entry.sides->point() == point) {
                entry.is_used = true;
                return entry.sides.get();
            }
        }
        return nullptr;
    }
    void add(std::unique_ptr<EdgeSides> sides) {
        bytes_ += sides->bytes();
        entries_.push_back({std::move(sides), true});
    }
    /// Discards what is not used since the last call.
    void discard_unused() {
        std::erase_if(entries_, [](const Entry& entry) { return !entry.is_used; });
        bytes_ = 0;
        for (Entry& entry : entries_) {
            bytes_ += entry.sides->bytes();
            entry.is_used = false;
        }
    }
    std::size_t bytes() const noexcept { return bytes_; }

private:
    struct Entry {
        std::unique_ptr<EdgeSides> sides;
        bool is_used = false;
    };
    std::vector<Entry> entries_;
    std::size_t bytes_ = 0;
};

}  // namespace

/// What is kept from call to call.
struct EdgePathFinder::State {
    State(const SceneView& the_scene,
          std::span<const Wedge> the_wedges,
          const EdgePathOptions& the_options,
          Executor& executor)
        : options(the_options),
          wedges(the_wedges),
          index(the_scene, executor),
          verifier(the_scene),
          tracer(the_scene,
                 index,
                 verifier,
                 the_wedges,
                 {.max_order = the_options.max_reflections,
                  .max_length = the_options.max_length,
                  .min_pressure = the_options.min_pressure}) {}

    /// What a point reaches: as it is kept in `kept`, or from now on if memory allows, or in `own`.
    EdgeSides& sides_of(const Vec3& point,
                        KeptSides& kept,
                        std::unique_ptr<EdgeSides>& own,
                        EdgeStatistics& statistics,
                        Executor& executor);

    EdgePathOptions options;
    std::span<const Wedge> wedges;
    FacetIndex index;
    PathVerifier verifier;
    EdgeTracer tracer;
    // Apart: parts are decided for one side at a time, also where source and listener are one
    // point.
    KeptSides sources, listeners;
};

EdgeSides& EdgePathFinder::State::sides_of(const Vec3& point,
                                           KeptSides& kept,
                                           std::unique_ptr<EdgeSides>& own,
                                           EdgeStatistics& statistics,
                                           Executor& executor) {
    constexpr std::size_t kMaxKeptBytes = std::size_t{1} << 30;
    if (EdgeSides* known = kept.find(point)) {
        return *known;
    }
    own = std::make_unique<EdgeSides>(tracer.trace(point, statistics, executor));
    EdgeSides& sides = *own;
    const bool is_kept = &kept == &listeners || options.keep_traces;
    if (is_kept && sources.bytes() + listeners.bytes() + sides.bytes() <= kMaxKeptBytes) {
        kept.add(std::move(own));
    }
    return sides;
}

EdgePathFinder::EdgePathFinder(const SceneView& scene,
                               std::span<const Wedge> wedges,
                               const EdgePathOptions& options,
                               Executor& executor) {
    validate(options);
    state_ = std::make_unique<State>(scene, wedges, options, executor);
}

EdgePathFinder::EdgePathFinder(EdgePathFinder&&) noexcept = default;
EdgePathFinder& EdgePathFinder::operator=(EdgePathFinder&&) noexcept = default;
EdgePathFinder::~EdgePathFinder() = default;

EdgePathResult EdgePathFinder::find(const Vec3& source,
                                    std::span<const Vec3> listeners,
                                    const EdgePathFilter* filter,
                                    Executor& executor) {
    State& state = *state_;
    EdgePathResult result;
    std::unique_ptr<EdgeSides> own_source;
    EdgeSides& from_source =
        state.sides_of(source, state.sources, own_source, result.statistics, executor);
    for (std::size_t i = 0; i < listeners.size(); ++i) {
        std::unique_ptr<EdgeSides> own;
        EdgeSides& to_listener =
            state.sides_of(listeners[i], state.listeners, own, result.statistics, executor);
        join_all(
            state.wedges, state.options, filter, from_source, to_listener, i, result, executor);
    }
    if (!state.options.keep_traces) {
        discard_unused();
    }
    sort_paths(result.paths);
    return result;
}

void EdgePathFinder::discard_unused() {
    state_->sources.discard_unused();
    state_->listeners.discard_unused();
}

EdgePathResult find_edge_paths(const SceneView& scene,
                               std::span<const Wedge> wedges,
                               const Vec3& source,
                               std::span<const Vec3> listeners,
                               const EdgePathOptions& options,
                               Executor& executor) {
    return EdgePathFinder(scene, wedges, options, executor)
        .find(source, listeners, nullptr, executor);
}

EdgePathResult find_edge_paths_brute_force(const SceneView& scene,
                                           std::span<const Wedge> wedges,
                                           const Vec3& source,
                                           std::span<const Vec3> listeners,
                                           const EdgePathOptions& options) {
    validate(options);
    const PathVerifier verifier(scene);
    const auto sides_of = [&](const Vec3& point) {
        return all_edge_sides(scene, verifier, wedges, point, options.max_reflections);
    };
    EdgePathResult result;
    EdgeSides from_source = sides_of(source);
    for (std::size_t i = 0; i < listeners.size(); ++i) {
        EdgeSides to_listener = sides_of(listeners[i]);
        join_all(wedges, options, nullptr, from_source, to_listener, i, result, Executor::serial());
    }
    sort_paths(result.paths);
    return result;
}

// From the apex, each side is a path to a listener at the apex, as the verifier constructs it.
std::vector<Vec3> points_of(const EdgePath& path,
                            const SceneView& scene,
                            std::span<const Wedge> wedges,
                            const Vec3& source,
                            const Vec3& listener) {
    const Wedge& wedge = wedges[path.wedge];
    const geometry::WedgePoint s = geometry::wedge_coordinates(wedge, path.source_image);
    const geometry::WedgePoint r = geometry::wedge_coordinates(wedge, path.listener_image);
    const double apex = std::clamp(
        (s.z * r.radius + r.z * s.radius) / (s.radius + r.radius), path.part.min, path.part.max);
    const auto side = [&](const Vec3& end, std::vector<FacetId> sequence) {
        std::vector<Vec3> images{end};
        for (const FacetId facet : sequence) {
            images.push_back(scene.facets.facets[facet].plane.mirror(images.back()));
        }
        std::vector<Vec3> points{wedge.point_at(apex)};
        for (std::size_t i = sequence.size(); i > 0; --i) {
            const geometry::Plane& plane = scene.facets.facets[sequence[i - 1]].plane;
            const Vec3 target = points.back();
            const double before = plane.distance(target);
            const double behind = plane.distance(images[i]);
            points.push_back(target + before / (before - behind) * (images[i] - target));
        }
        points.push_back(end);
        return points;
    };
    std::vector<Vec3> points = side(source, path.before);
    std::reverse(points.begin(), points.end());
    const std::vector<Vec3> rest = side(listener, {path.after.rbegin(), path.after.rend()});
    points.insert(points.end(), rest.begin() + 1, rest.end());
    return points;
}

}  // namespace earshot::frustum
