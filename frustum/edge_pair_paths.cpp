// SPDX-License-Identifier: MIT
#include "earshot/frustum/edge_pair_paths.h"

#include "earshot/frustum/internal/edge_links.h"
#include "earshot/frustum/path_verifier.h"

#include <glm/geometric.hpp>

#include <iterator>
#include <utility>

namespace earshot::frustum {

using geometry::Vec3;
using geometry::Wedge;

namespace {

/// What a point reaches of an edge.
struct ReachedEdge {
    std::size_t wedge = 0;
    std::vector<geometry::Interval> parts{};
};

class PairSearch {
public:
    PairSearch(const SceneView& scene, std::span<const Wedge> wedges, const EdgePairFilter* filter)
        : scene_(scene),
          wedges_(wedges),
          filter_(filter),
          verifier_(scene),
          intervals_(scene, verifier_),
          links_(scene, verifier_) {}

    std::vector<ReachedEdge> reached_from(const Vec3& point, Executor& executor) const {
        constexpr std::size_t kGrain = 32;
        std::vector<std::vector<geometry::Interval>> parts(wedges_.size());
        executor.for_each(wedges_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                parts[i] = intervals_.find({}, {&point, 1}, wedges_[i]);
            }
        });
        std::vector<ReachedEdge> reached;
        for (std::size_t i = 0; i < parts.size(); ++i) {
            if (!parts[i].empty()) {
                reached.push_back({i, std::move(parts[i])});
            }
        }
        return reached;
    }

    /// Adds the ways over two edges in turn.
    void add(const ReachedEdge& first,
             const ReachedEdge& second,
             std::size_t listener,
             EdgePairResult& result) const {
        if (first.wedge == second.wedge || are_collinear(first.wedge, second.wedge)) {
            return;
        }
        const Wedge& a = wedges_[first.wedge];
        const Wedge& b = wedges_[second.wedge];
        for (const geometry::Interval& of_first : first.parts) {
            for (const geometry::Interval& of_second : second.parts) {
                const EdgePairPath pair{
                    .listener = listener, .first = first.wedge, .second = second.wedge};
                add(pair, {a, of_first}, {b, of_second}, result);
            }
        }
    }

private:
    /// Of one part of each edge, through the air and along faces.
    void add(EdgePairPath pair,
             const EdgePart& from,
             const EdgePart& to,
             EdgePairResult& result) const {
        const auto is_wanted = [&] {
            return filter_ == nullptr ||
                   filter_->may_be_wanted(
                       from.wedge, from.part, to.wedge, to.part, pair.common_face, pair.listener);
        };
        if (is_wanted()) {
            ++result.statistics.pairs;
            add(pair, links_.through_air(from, to), result);
        }
        for (int i = 0; i < 2; ++i) {
            for (int k = 0; k < 2; ++k) {
                const geometry::WedgeFace& face = from.wedge.faces[static_cast<std::size_t>(i)];
                pair.common_face = {{i, k}};
                if (face == to.wedge.faces[static_cast<std::size_t>(k)] && is_wanted()) {
                    add(pair, links_.along_face(from, to, face), result);
                }
            }
        }
    }

    bool are_collinear(std::size_t first, std::size_t second) const {
        const Wedge& about = wedges_[first];
        const double slack =
            64.0 * verifier_.rounding_slack(about.length()) + scene_.facets.tolerance;
        return geometry::wedge_coordinates(about, wedges_[second].begin).radius <= slack &&
               geometry::wedge_coordinates(about, wedges_[second].end).radius <= slack;
    }

    static void add(EdgePairPath pair, EdgeLinks::Found&& found, EdgePairResult& result) {
        result.statistics.sampled += found.is_sampled ? 1 : 0;
        if (!found.links.empty()) {
            pair.links = std::move(found.links);
            pair.is_sampled = found.is_sampled;
            result.paths.push_back(std::move(pair));
        }
    }

    const SceneView& scene_;
    std::span<const Wedge> wedges_;
    const EdgePairFilter* filter_;
    PathVerifier verifier_;
    EdgeIntervals intervals_;
    EdgeLinks links_;
};

}  // namespace

EdgePairResult find_edge_pair_paths(const SceneView& scene,
                                    std::span<const Wedge> wedges,
                                    const Vec3& source,
                                    std::span<const Vec3> listeners,
                                    const EdgePairFilter* filter,
                                    Executor& executor) {
    EdgePairResult result;
    const PairSearch search(scene, wedges, filter);
    const std::vector<ReachedEdge> from_source = search.reached_from(source, executor);
    for (std::size_t listener = 0; listener < listeners.size(); ++listener) {
        const std::vector<ReachedEdge> to_listener =
            search.reached_from(listeners[listener], executor);
        std::vector<EdgePairResult> of_first(from_source.size());
        executor.for_each(from_source.size(), 1, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                for (const ReachedEdge& second : to_listener) {
                    search.add(from_source[i], second, listener, of_first[i]);
                }
            }
        });
        for (EdgePairResult& some : of_first) {
            result.paths.insert(result.paths.end(),
                                std::make_move_iterator(some.paths.begin()),
                                std::make_move_iterator(some.paths.end()));
            result.statistics.pairs += some.statistics.pairs;
            result.statistics.sampled += some.statistics.sampled;
        }
    }
    return result;
}

}  // namespace earshot::frustum
