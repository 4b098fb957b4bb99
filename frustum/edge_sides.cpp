// SPDX-License-Identifier: MIT
#include "earshot/frustum/internal/edge_sides.h"

#include "earshot/frustum/edge_paths.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <utility>

namespace earshot::frustum {

using geometry::FacetId;
using geometry::Interval;
using geometry::Vec3;
using geometry::Wedge;

void sort_and_deduplicate(std::vector<EdgeCandidate>& candidates) {
    std::sort(
        candidates.begin(), candidates.end(), [](const EdgeCandidate& a, const EdgeCandidate& b) {
            const std::pair first(a.wedge, a.sequence.size());
            const std::pair second(b.wedge, b.sequence.size());
            return first != second ? first < second : a.sequence < b.sequence;
        });
    candidates.erase(std::unique(candidates.begin(),
                                 candidates.end(),
                                 [](const EdgeCandidate& a, const EdgeCandidate& b) {
                                     return a.wedge == b.wedge && a.sequence == b.sequence;
                                 }),
                     candidates.end());
}

namespace {

/// What is left of ascending parts without others.
std::vector<Interval> without(const std::vector<Interval>& parts,
                              const std::vector<Interval>& others) {
    std::vector<Interval> left;
    for (Interval part : parts) {
        for (const Interval& other : others) {
            if (other.max <= part.min || other.min >= part.max) {
                continue;
            }
            if (other.min > part.min) {
                left.push_back({part.min, other.min});
            }
            part.min = std::min(other.max, part.max);
        }
        if (part.min < part.max) {
            left.push_back(part);
        }
    }
    return left;
}

/// Images in layers of one surface lie within twice the tolerance for their distance, and as much
/// for the tilt that it gives the planes of walls a fraction of the scene wide, per reflection: as
/// for specular paths (path_order.cpp).
constexpr double kLayerDistance = 16.0;

/// Layers of one surface reflect once: of sequences with one image, the first has what both reach.
void remove_repeated(std::vector<EdgeSide>& sides, double tolerance) {
    const auto of_one_group = [](const EdgeSide& a, const EdgeSide& b) {
        return a.wedge == b.wedge && a.sequence.size() == b.sequence.size();
    };
    for (std::size_t i = 0; i < sides.size(); ++i) {
        const double reach =
            kLayerDistance * tolerance * static_cast<double>(sides[i].sequence.size());
        for (std::size_t k = i; k-- > 0 && of_one_group(sides[k], sides[i]);) {
            if (glm::distance(sides[k].image, sides[i].image) <= reach) {
                sides[i].parts = without(sides[i].parts, sides[k].parts);
            }
        }
    }
    std::erase_if(sides, [](const EdgeSide& side) { return side.parts.empty(); });
}

}  // namespace

std::vector<EdgeSide> find_sides(const SceneView& scene,
                                 const PathVerifier& verifier,
                                 std::span<const Wedge> wedges,
                                 const Vec3& point,
                                 std::vector<EdgeCandidate> candidates,
                                 Executor& executor) {
    constexpr std::size_t kGrain = 16;
    const EdgeIntervals intervals(scene, verifier);
    std::vector<std::vector<EdgeSide>> of_chunk(chunk_count(candidates.size(), kGrain));
    executor.for_each(candidates.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        std::vector<Vec3> images;
        for (std::size_t i = begin; i < end; ++i) {
            EdgeCandidate& candidate = candidates[i];
            images.assign(1, point);
            for (const FacetId facet : candidate.sequence) {
                images.push_back(scene.facets.facets[facet].plane.mirror(images.back()));
            }
            auto parts = intervals.find(candidate.sequence, images, wedges[candidate.wedge]);
            if (!parts.empty()) {
                of_chunk[begin / kGrain].push_back({candidate.wedge,
                                                    std::move(candidate.sequence),
                                                    images.back(),
                                                    std::move(parts)});
            }
        }
    });
    std::vector<EdgeSide> sides;
    for (std::vector<EdgeSide>& some : of_chunk) {
        sides.insert(sides.end(),
                     std::make_move_iterator(some.begin()),
                     std::make_move_iterator(some.end()));
    }
    remove_repeated(sides, scene.facets.tolerance);
    return sides;
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
