// SPDX-License-Identifier: MIT
#include "earshot/visibility/internal/side_nodes.h"

#include "earshot/base/random.h"
#include "earshot/geometry/closest_point.h"
#include "earshot/geometry/overlap.h"
#include "earshot/geometry/topology.h"
#include "earshot/visibility/internal/side_rays.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace earshot::visibility {

using geometry::Ray;
using geometry::Triangle;
using geometry::TriangleId;
using geometry::Vec3;

namespace {

constexpr std::size_t kGrain = 256;

/// Streams of random numbers: where samples lie, which triangle of a cluster a ray starts from, and
/// the ray itself (four).
constexpr std::uint64_t kSampleStream = 200;
constexpr std::uint64_t kTriangleStream = 202;
constexpr std::uint64_t kRayStream = 203;
/// More than the rays of a node, so that the numbers of nodes do not overlap.
constexpr std::uint64_t kRaysPerNode = 1U << 24U;

bool share_vertex(const Triangle& a, const Triangle& b) {
    return std::any_of(a.begin(), a.end(), [&](geometry::VertexId v) {
        return std::find(b.begin(), b.end(), v) != b.end();
    });
}

/// Whether two triangles come within the tolerance of each other, but for pairs of edges that do so
/// without touching: those are left to the rays.
bool meet(const geometry::Corners& a, const geometry::Corners& b, double tolerance) {
    const auto is_near = [&](const Vec3& point, const geometry::Corners& triangle) {
        return geometry::PreparedPoint(point)
            .closest_point(triangle[0], triangle[1], triangle[2], tolerance)
            .has_value();
    };
    return geometry::TriangleRegion(a[0], a[1], a[2]).touches(b[0], b[1], b[2]) ||
           std::any_of(a.begin(), a.end(), [&](const Vec3& p) { return is_near(p, b); }) ||
           std::any_of(b.begin(), b.end(), [&](const Vec3& p) { return is_near(p, a); });
}

double area_of(const geometry::Corners& c) {
    return 0.5 * glm::length(glm::cross(c[1] - c[0], c[2] - c[0]));
}

}  // namespace

std::vector<std::uint8_t> find_meeting_triangles(const bvh::MeshBvh& bvh,
                                                 double tolerance,
                                                 Executor& executor) {
    const auto triangles = bvh.mesh().triangles;
    std::vector<std::uint8_t> meets_others(triangles.size(), 0);
    executor.for_each(triangles.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t t = begin; t < end; ++t) {
            const auto id = static_cast<TriangleId>(t);
            const geometry::Corners mine = bvh.corners(id);
            const Vec3 margin(tolerance);
            const geometry::BoxRegion box(glm::min(glm::min(mine[0], mine[1]), mine[2]) - margin,
                                          glm::max(glm::max(mine[0], mine[1]), mine[2]) + margin);
            bvh.traverse([&](const geometry::Aabb& other) { return box.may_touch(other); },
                         [&](TriangleId other) {
                             const bool counts =
                                 other != id && !share_vertex(triangles[t], triangles[other]);
                             if (counts && meet(mine, bvh.corners(other), tolerance)) {
                                 meets_others[t] = 1;
                             }
                             return meets_others[t] == 0;
                         });
        }
    });
    return meets_others;
}

SideNodes::SideNodes(const bvh::MeshBvh& bvh, const AirCutOptions& options, Executor& executor)
    : bvh_(bvh), meets_others_(find_meeting_triangles(bvh, options.tolerance, executor)) {
    sampled_triangles_ =
        static_cast<std::size_t>(std::count(meets_others_.begin(), meets_others_.end(), 1));
    make_clusters(options.cluster);
    make_samples(options, executor);
}

// Zhou et al. 2008, section 2, clustering: triangles are flooded across edges of two, which do not
// belong to a triangle that meets others. Fronts of neighbours with opposite windings are opposite.
void SideNodes::make_clusters(bool cluster) {
    const auto triangles = bvh_.mesh().triangles;
    const geometry::EdgeTable edges(triangles, bvh_.mesh().positions.size());
    std::vector<geometry::HalfEdgeId> neighbours(3 * triangles.size(), geometry::kNoHalfEdge);
    for (std::size_t e = 0; cluster && e < edges.size(); ++e) {
        const auto uses = edges.uses(e);
        if (uses.size() == 2 && meets_others_[geometry::triangle_of(uses[0])] == 0 &&
            meets_others_[geometry::triangle_of(uses[1])] == 0) {
            neighbours[uses[0]] = uses[1];
            neighbours[uses[1]] = uses[0];
        }
    }
    node_of_front_.assign(triangles.size(), kNone);
    for (TriangleId first = 0; first < triangles.size(); ++first) {
        if (meets_others_[first] != 0 || node_of_front_[first] != kNone) {
            continue;
        }
        const auto node = static_cast<std::uint32_t>(2 * clusters_.size());
        Cluster& members = clusters_.emplace_back();
        node_of_front_[first] = node;
        members.sides.push_back(front_of(first));
        for (std::size_t i = 0; i < members.sides.size(); ++i) {
            const TriangleId t = triangle_of(members.sides[i]);
            for (geometry::HalfEdgeId h = 3 * t; h < 3 * t + 3; ++h) {
                const geometry::HalfEdgeId twin = neighbours[h];
                if (twin == geometry::kNoHalfEdge ||
                    node_of_front_[geometry::triangle_of(twin)] != kNone) {
                    continue;
                }
                const bool is_turned =
                    geometry::start_of(triangles, h) == geometry::start_of(triangles, twin);
                const TriangleId other = geometry::triangle_of(twin);
                node_of_front_[other] = node_of_front_[t] ^ (is_turned ? 1U : 0U);
                members.sides.push_back(node_of_front_[other] == node ? front_of(other)
                                                                      : back_of(other));
            }
        }
        double sum = 0.0;
        for (const SideId side : members.sides) {
            sum += area_of(bvh_.corners(triangle_of(side)));
            members.area_until.push_back(sum);
        }
        areas_.push_back(sum);
    }
}

// A sample within the tolerance of other triangles looks from the outermost of them (section 3.1).
SideNodes::Sample SideNodes::placed(TriangleId t,
                                    double of_b,
                                    double of_c,
                                    double tolerance) const {
    const auto [a, b, c] = bvh_.corners(t);
    const Vec3 point = a + of_b * (b - a) + of_c * (c - a);
    const Vec3 normal = normal_of(bvh_, front_of(t));
    double above = 0.0;
    double below = 0.0;
    const geometry::PreparedPoint prepared(point);
    for (const TriangleId other : bvh_.overlapping(geometry::SphereRegion(point, tolerance))) {
        const auto [p, q, r] = bvh_.corners(other);
        if (const auto closest = prepared.closest_point(p, q, r, tolerance);
            closest && other != t) {
            const double height = glm::dot(closest->point - point, normal);
            above = std::max(above, height);
            below = std::max(below, -height);
        }
    }
    return {.triangle = t,
            .point = point,
            .eyes = {point + (above + ray_offset(bvh_)) * normal,
                     point - (below + ray_offset(bvh_)) * normal}};
}

// The paper's second scheme (section 3.1): points spread over the triangle and along its edges.
void SideNodes::make_samples(const AirCutOptions& options, Executor& executor) {
    const auto triangles = bvh_.mesh().triangles;
    const auto inside = static_cast<std::uint32_t>(
        std::max<std::size_t>(options.random_samples, options.border_samples == 0 ? 1 : 0));
    const auto along = static_cast<std::uint32_t>(options.border_samples);
    sample_count_ = inside + along;
    first_sample_.assign(triangles.size(), kNone);
    std::vector<TriangleId> sampled;
    for (TriangleId t = 0; t < triangles.size(); ++t) {
        if (meets_others_[t] != 0) {
            first_sample_[t] = static_cast<std::uint32_t>(sampled.size() * sample_count_);
            sampled.push_back(t);
        }
    }
    samples_.resize(sampled.size() * sample_count_);
    executor.for_each(sampled.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const TriangleId t = sampled[i];
            for (std::uint32_t k = 0; k < sample_count_; ++k) {
                double of_b = 0.0;
                double of_c = 0.0;
                constexpr double kInset = 1e-3;  // from the border, of the triangle's size
                if (k < inside) {
                    const std::uint64_t index = std::uint64_t{t} * 1024 + k;
                    const double root = std::sqrt((k + random(options.seed, kSampleStream, index)) /
                                                  static_cast<double>(inside));
                    const double share = random(options.seed, kSampleStream + 1, index);
                    of_b = kInset + (1.0 - 3.0 * kInset) * root * (1.0 - share);
                    of_c = kInset + (1.0 - 3.0 * kInset) * root * share;
                } else {
                    // Evenly around the border: 0 ... 1 from a to b, 1 ... 2 to c, 2 ... 3 to a.
                    const double place = 3.0 * (k - inside + 0.5) / along;
                    const double share = place - std::floor(place);
                    const double edge = std::floor(place);
                    const double b = edge == 0.0 ? share : edge == 1.0 ? 1.0 - share : 0.0;
                    const double c = edge == 1.0 ? share : edge == 2.0 ? 1.0 - share : 0.0;
                    of_b = kInset + (1.0 - 3.0 * kInset) * b;
                    of_c = kInset + (1.0 - 3.0 * kInset) * c;
                }
                samples_[first_sample_[t] + k] = placed(t, of_b, of_c, options.tolerance);
            }
        }
    });
    for (const TriangleId t : sampled) {
        areas_.insert(areas_.end(), sample_count_, area_of(bvh_.corners(t)) / sample_count_);
    }
}

SideId SideNodes::random_side(std::uint32_t node, std::uint64_t seed, std::uint64_t index) const {
    const Cluster& cluster = clusters_[node / 2];
    const double place =
        cluster.area_until.back() * random(seed, kTriangleStream, node * kRaysPerNode + index);
    const auto found =
        std::upper_bound(cluster.area_until.begin(), cluster.area_until.end() - 1, place);
    const SideId side = cluster.sides[static_cast<std::size_t>(found - cluster.area_until.begin())];
    return node % 2 == 0 ? side : opposite(side);
}

TriangleId SideNodes::origin(std::uint32_t node, std::uint64_t seed, std::uint64_t index) const {
    return is_sample(node) ? samples_[node / 2 - clusters_.size()].triangle
                           : triangle_of(random_side(node, seed, index));
}

Ray SideNodes::ray(std::uint32_t node, std::uint64_t seed, std::uint64_t index) const {
    const std::uint64_t number = node * kRaysPerNode + index;
    if (!is_sample(node)) {
        return random_side_ray(bvh_, random_side(node, seed, index), seed, kRayStream, number);
    }
    const Sample& sample = samples_[node / 2 - clusters_.size()];
    const SideId side = node % 2 == 0 ? front_of(sample.triangle) : back_of(sample.triangle);
    return {.origin = sample.eyes[node % 2],
            .direction = cosine_direction(normal_of(bvh_, side),
                                          random(seed, kRayStream + 2, number),
                                          random(seed, kRayStream + 3, number))};
}

std::uint32_t SideNodes::node_at(SideId side, const Vec3& point) const {
    const TriangleId t = triangle_of(side);
    if (first_sample_[t] == kNone) {
        return cluster_node(side);
    }
    std::uint32_t nearest = 0;
    double distance = std::numeric_limits<double>::infinity();
    for (std::uint32_t i = 0; i < sample_count_; ++i) {
        const Vec3 apart = samples_[first_sample_[t] + i].point - point;
        if (glm::dot(apart, apart) < distance) {
            distance = glm::dot(apart, apart);
            nearest = i;
        }
    }
    return sample_node(t, nearest) + (is_back(side) ? 1U : 0U);
}

}  // namespace earshot::visibility
