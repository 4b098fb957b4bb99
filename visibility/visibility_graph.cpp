// SPDX-License-Identifier: MIT
#include "earshot/visibility/internal/visibility_graph.h"

#include "earshot/base/math.h"
#include "earshot/base/random.h"
#include "earshot/geometry/vector.h"
#include "earshot/visibility/internal/directions.h"
#include "earshot/visibility/internal/side_rays.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace earshot::visibility {

using geometry::Hit;
using geometry::Ray;
using geometry::TriangleId;
using geometry::Vec3;

namespace {

constexpr std::uint64_t kRaysPerBatch = 1U << 18U;
constexpr std::uint64_t kMinRaysOfCluster = 64;
constexpr std::uint64_t kMinRaysPerNode = 2;

/// First streams of random numbers.
constexpr std::uint64_t kPointStream = 220;
constexpr std::uint64_t kOpeningStream = 230;

}  // namespace

VisibilityGraph::VisibilityGraph(const bvh::MeshBvh& bvh,
                                 const SideNodes& nodes,
                                 const AirCutOptions& options,
                                 Executor& executor)
    : bvh_(bvh), nodes_(nodes), options_(options), executor_(executor) {
    double triangles = 0.0;
    for (std::uint32_t node = 0; node < nodes.size(); ++node) {
        triangles += static_cast<double>(nodes.triangles(node));
    }
    const double affordable = static_cast<double>(options.max_rays) / std::max(1.0, triangles);
    const auto rays_per_node = std::clamp(static_cast<std::uint64_t>(affordable),
                                          std::min(kMinRaysPerNode, options.rays_per_node),
                                          options.rays_per_node);
    for (std::uint32_t node = 0; node < nodes.size(); ++node) {
        const std::uint64_t rays = rays_per_node * nodes.triangles(node);
        rays_of_node_.push_back(nodes.is_sample(node) ? rays : std::max(rays, kMinRaysOfCluster));
    }
}

// Of each ray the node that it meets, `beyond`, or nothing where a hit on a sampled triangle cannot
// be snapped to a sample: where the way from that sample to the ray's origin is blocked
// (section 3.2.2).
std::vector<std::optional<std::uint32_t>> VisibilityGraph::nodes_of(
    std::span<const Ray> rays, std::span<const std::optional<Hit>> hits) {
    std::vector<std::optional<std::uint32_t>> met(rays.size());
    std::vector<geometry::Segment> ways_back;
    std::vector<std::size_t> checked;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        if (!hits[i]) {
            met[i] = beyond();
            continue;
        }
        met[i] = nodes_.node_at(side_hit(bvh_, rays[i], hits[i]->triangle),
                                rays[i].origin + hits[i]->t * rays[i].direction);
        if (nodes_.is_sample(*met[i])) {
            ways_back.push_back({nodes_.eye(*met[i]), rays[i].origin});
            checked.push_back(i);
        }
    }
    const std::vector<std::uint8_t> blocked = bvh_.occluded(ways_back, executor_);
    rays_ += ways_back.size();
    for (std::size_t i = 0; i < checked.size(); ++i) {
        if (blocked[i] != 0) {
            met[checked[i]].reset();
        }
    }
    return met;
}

void VisibilityGraph::cast_nodes(std::uint32_t first,
                                 std::uint32_t last,
                                 std::span<const std::uint64_t> rays_until,
                                 std::vector<Count>& counts) {
    const std::uint64_t before = first == 0 ? 0 : rays_until[first - 1];
    const std::size_t count = rays_until[last - 1] - before;
    std::vector<Ray> rays(count);
    std::vector<TriangleId> origins(count);
    executor_.for_each(last - first, 64, [&](std::size_t begin, std::size_t end) {
        for (std::size_t n = first + begin; n < first + end; ++n) {
            const auto node = static_cast<std::uint32_t>(n);
            const std::uint64_t offset = (n == 0 ? 0 : rays_until[n - 1]) - before;
            for (std::uint64_t i = 0; i < rays_of_node_[n]; ++i) {
                rays[offset + i] = nodes_.ray(node, options_.seed, i);
                origins[offset + i] = nodes_.origin(node, options_.seed, i);
            }
        }
    });
    std::vector<std::optional<Hit>> hits(count);
    closest_hits(bvh_, rays, origins, hits, executor_);
    rays_ += count;
    const auto met = nodes_of(rays, hits);
    std::vector<std::uint32_t> targets;
    std::size_t at = 0;
    for (std::uint32_t node = first; node < last; ++node) {
        targets.clear();
        for (std::uint64_t i = 0; i < rays_of_node_[node]; ++i, ++at) {
            if (met[at] && *met[at] != node) {
                targets.push_back(*met[at]);
            }
        }
        std::sort(targets.begin(), targets.end());
        for (std::size_t i = 0; i < targets.size(); ++i) {
            if (i == 0 || targets[i] != targets[i - 1]) {
                counts.push_back({node, targets[i], 0});
            }
            ++counts.back().rays;
        }
    }
}

void VisibilityGraph::sample_nodes() {
    std::vector<std::uint64_t> rays_until;
    std::uint64_t sum = 0;
    for (const std::uint64_t rays : rays_of_node_) {
        sum += rays;
        rays_until.push_back(sum);
    }
    std::vector<Count> counts;
    for (std::uint32_t first = 0; first < nodes_.size();) {
        std::uint32_t last = first + 1;
        const std::uint64_t before = first == 0 ? 0 : rays_until[first - 1];
        while (last < nodes_.size() && rays_until[last] - before <= kRaysPerBatch) {
            ++last;
        }
        cast_nodes(first, last, rays_until, counts);
        first = last;
        if (options_.progress != nullptr) {
            options_.progress->report("leaks", rays_until[last - 1], sum);
        }
    }
    weigh(counts);
}

// Zhou et al. 2008, equation 5: the mean of both estimates of the power exchanged; of a sample and
// a cluster the cluster's alone, which is less biased.
void VisibilityGraph::weigh(const std::vector<Count>& counts) {
    struct Estimate {
        std::uint32_t a, b;
        double power;
        bool of_sample;
    };
    std::vector<Estimate> estimates;
    estimates.reserve(counts.size());
    for (const Count& count : counts) {
        const double power =
            nodes_.area(count.from) * count.rays / static_cast<double>(rays_of_node_[count.from]);
        estimates.push_back({std::min(count.from, count.to),
                             std::max(count.from, count.to),
                             power,
                             nodes_.is_sample(count.from)});
    }
    // Stable, so that of a pair the lower node's estimate comes first.
    std::stable_sort(estimates.begin(), estimates.end(), [](const auto& x, const auto& y) {
        return std::pair(x.a, x.b) < std::pair(y.a, y.b);
    });
    for (std::size_t i = 0; i < estimates.size();) {
        const auto [a, b, power, of_sample] = estimates[i];
        const bool has_both =
            i + 1 < estimates.size() && estimates[i + 1].a == a && estimates[i + 1].b == b;
        double value = 0.0;
        if (b == beyond()) {
            value = power;
        } else if (nodes_.is_sample(a) == nodes_.is_sample(b)) {
            value = 0.5 * (power + (has_both ? estimates[i + 1].power : 0.0));
        } else {
            value = of_sample && has_both ? estimates[i + 1].power : power;
        }
        if (value > 0.0) {
            weights_.push_back({a, b, value});
        }
        i += has_both ? 2 : 1;
    }
}

void VisibilityGraph::add_points(std::span<const Vec3> points) {
    std::map<std::uint32_t, double> share;  // of all rays, per node
    for (std::size_t k = 0; k < points.size(); ++k) {
        std::vector<Ray> rays(options_.rays_per_point);
        for (std::uint64_t i = 0; i < rays.size(); ++i) {
            const std::uint64_t index = k * rays.size() + i;
            rays[i] = {points[k],
                       on_sphere(random_between(options_.seed, kPointStream, index, -1.0, 1.0),
                                 2.0 * math::kPi * random(options_.seed, kPointStream + 1, index))};
        }
        const auto hits = bvh_.closest_hits(rays, executor_);
        rays_ += rays.size();
        for (const auto& met : nodes_of(rays, hits)) {
            if (met) {
                share[*met] += 1.0 / static_cast<double>(rays.size() * points.size());
            }
        }
    }
    double area = 0.0;
    for (const auto& [node, part] : share) {
        area += node == beyond() ? 0.0 : nodes_.area(node);
    }
    for (const auto& [node, part] : share) {
        ties_.push_back({air(), node, area * part, area * part});
        if (node != beyond()) {
            const double tie = options_.lambda * area * part;
            ties_.push_back({node ^ 1U, solid(), tie, tie});
        }
    }
    ties_.push_back({beyond(), solid(), options_.open_share * area, options_.open_share * area});
}

void VisibilityGraph::add_outside() {
    double all = 0.0;
    for (const Weight& weight : weights_) {
        if (weight.b == beyond()) {
            const double tie = options_.lambda * weight.value;
            ties_.push_back({weight.a ^ 1U, solid(), tie, tie});
        }
        all += weight.value;
    }
    ties_.push_back({air(), beyond(), all, all});
}

std::vector<FreeLink> VisibilityGraph::add_opening(const Opening& opening,
                                                   std::uint64_t index,
                                                   OpeningFlow& flow) {
    std::vector<double> area_until;
    for (const auto& [a, b, c] : opening.cap) {
        flow.area += 0.5 * glm::length(glm::cross(b - a, c - a));
        area_until.push_back(flow.area);
    }
    if (!(flow.area > 0.0)) {
        return {};
    }
    // Two rays of opposite directions from each place, the even ones first.
    std::vector<Ray> rays;
    for (std::uint64_t i = 0; i < opening.rays; ++i) {
        const RandomStream numbers(options_.seed + index, kOpeningStream);
        const double place = flow.area * numbers.at(5 * i);
        const auto at =
            std::upper_bound(area_until.begin(), area_until.end() - 1, place) - area_until.begin();
        const auto& [a, b, c] = opening.cap[static_cast<std::size_t>(at)];
        const Vec3 normal = geometry::normalized_or_zero(glm::cross(b - a, c - a));
        const double root = std::sqrt(numbers.at(5 * i + 1));
        const double share = numbers.at(5 * i + 2);
        const Vec3 point = a + root * (1.0 - share) * (b - a) + root * share * (c - a);
        const Vec3 direction =
            cosine_direction(normal, numbers.at(5 * i + 3), numbers.at(5 * i + 4));
        rays.push_back({point, direction});
        rays.push_back({point, -direction});
    }
    const auto hits = bvh_.closest_hits(rays, executor_);
    rays_ += rays.size();
    flow.rays = opening.rays;
    const auto met = nodes_of(rays, hits);
    std::vector<FreeLink> links;
    for (std::size_t i = 0; i < rays.size(); i += 2) {
        const auto is_at_place = [&](std::size_t k) {
            return hits[k] && hits[k]->t <= options_.tolerance;
        };
        if (is_at_place(i) || is_at_place(i + 1)) {
            ++flow.blocked;
        } else if (met[i] && met[i + 1] && *met[i] != *met[i + 1]) {
            links.push_back({*met[i], *met[i + 1], rays[i].origin});
            if (!opening.is_strip) {
                opening_weights_.push_back({std::min(*met[i], *met[i + 1]),
                                            std::max(*met[i], *met[i + 1]),
                                            flow.area / flow.rays});
            }
        }
    }
    return links;
}

// What passes openings is known better from the rays through them than from those that happen to
// meet them; where both tell, the larger counts.
std::vector<FlowEdge> VisibilityGraph::flow_edges() const {
    std::map<std::pair<std::uint32_t, std::uint32_t>, double> by_openings;
    for (const Weight& weight : opening_weights_) {
        by_openings[{weight.a, weight.b}] += weight.value;
    }
    std::vector<Weight> weights = weights_;
    for (Weight& weight : weights) {
        if (const auto found = by_openings.find({weight.a, weight.b}); found != by_openings.end()) {
            weight.value = std::max(weight.value, found->second);
            by_openings.erase(found);
        }
    }
    for (const auto& [pair, value] : by_openings) {
        weights.push_back({pair.first, pair.second, value});
    }
    std::vector<FlowEdge> edges = ties_;
    if (!options_.filter_cracks) {
        for (const auto& [a, b, value] : weights) {
            edges.push_back({a, b, value, value});
        }
        return edges;
    }
    // Zhou et al. 2008, the crack filter: a weight fades where it is small among those of its node.
    std::vector<double> max_weight(size(), 0.0);
    const auto raise = [&](std::uint32_t a, std::uint32_t b, double value) {
        max_weight[a] = std::max(max_weight[a], value);
        max_weight[b] = std::max(max_weight[b], value);
    };
    for (const auto& [a, b, value] : weights) {
        raise(a, b, value);
    }
    for (const FlowEdge& tie : ties_) {
        raise(tie.a, tie.b, tie.forward);
    }
    const auto filtered = [&](std::uint32_t from, double value) {
        return 0.5 * (1.0 + math::cos(math::kPi * (1.0 - value / max_weight[from]))) * value;
    };
    for (const auto& [a, b, value] : weights) {
        edges.push_back({a, b, filtered(a, value), filtered(b, value)});
    }
    return edges;
}

}  // namespace earshot::visibility
