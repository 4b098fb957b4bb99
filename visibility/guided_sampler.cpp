// SPDX-License-Identifier: MIT
#include "earshot/visibility/internal/guided_sampler.h"

#include "earshot/base/halton.h"
#include "earshot/base/random.h"
#include "earshot/bvh/wide_batch.h"
#include "earshot/visibility/internal/unit.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace earshot::visibility {

using geometry::Hit;
using geometry::Ray;
using geometry::TriangleId;
using geometry::Vec3;

namespace {

// Enough for ray packets and interleaved rays, few enough for what is found to guide the next.
constexpr std::size_t kSeedsAtATime = 1024;

// Random rays begin few and follow the rest: where triangles are small they are met one by one.
constexpr std::uint64_t kFewestRandom = 64;
constexpr std::uint64_t kMostRandom = 1U << 14U;
constexpr std::uint64_t kRandomShare = 8;

// So many random rays to one look at a known triangle, which takes a dozen or two.
constexpr std::uint64_t kRandomPerLook = 16;

// Streams of random numbers.
constexpr std::uint64_t kLook = 40;

// A border that falls apart is halved so many times: to a 128th of a side.
constexpr int kHalvings = 7;

// Planes that are met farther away, in diagonals, say nothing about what is hidden.
constexpr double kFarthest = 4.0;

}  // namespace

GuidedSampler::GuidedSampler(const bvh::WideTree& tree,
                             const geometry::MeshView& mesh,
                             const ViewRegion& region,
                             const GuidedSamplingOptions& options,
                             Executor& executor)
    : tree_(tree), mesh_(mesh), region_(region), options_(options), executor_(executor) {
    place_.assign(mesh.triangles.size(), kUnknown);
    if (!tree.box().is_empty()) {
        Vec3 size(0.0);
        for (int axis = 0; axis < 3; ++axis) {
            const auto k = static_cast<std::size_t>(axis);
            size[axis] = double{tree.box().upper[k]} - double{tree.box().lower[k]};
        }
        diagonal_ = glm::length(size);
    }
    const Vec3 size = region.size();
    double sum = 0.0;
    for (int face = 0; face < 6; ++face) {
        sum += size[(face / 2 + 1) % 3] * size[(face / 2 + 2) % 3];
        faces_[static_cast<std::size_t>(face)] = sum;
    }
    if (sum == 0.0) {
        // A line or a point looks to all sides alike.
        for (std::size_t face = 0; face < 6; ++face) {
            faces_[face] = static_cast<double>(face + 1);
        }
    }
}

RegionPvs GuidedSampler::run() {
    RegionPvs view;
    while (!is_finished()) {
        cast_random();
        if (options_.guided) {
            look_again();
        }
        while (options_.guided && !waiting_.empty() && !is_finished()) {
            const std::size_t count = std::min(kSeedsAtATime, waiting_.size());
            const auto end = waiting_.begin() + static_cast<std::ptrdiff_t>(count);
            const std::vector<Seed> seeds(waiting_.begin(), end);
            waiting_.erase(waiting_.begin(), end);
            sample_borders(seeds);
        }
    }
    if (options_.progress != nullptr) {
        options_.progress->report("rays", rays_, rays_);
    }
    view.rays = rays_;
    view.curve = curve_;
    // The last half of the work, by rays.
    const auto half = std::partition_point(
        marks_.begin(), marks_.end(), [&](const Mark& mark) { return 2 * mark.rays < rays_; });
    if (half != marks_.end() && random_rays_ > half->random_rays) {
        view.missed_share = static_cast<double>(random_finds_ - half->random_finds) /
                            static_cast<double>(random_rays_ - half->random_rays);
    }
    return view;
}

bool GuidedSampler::is_finished() const {
    if (is_interrupted_ || rays_ >= options_.max_rays || mesh_.triangles.empty()) {
        return true;
    }
    if (rays_ < options_.window) {
        return false;
    }
    const auto before = std::partition_point(curve_.begin(), curve_.end(), [&](const auto& point) {
        return point.rays + options_.window <= rays_;
    });
    const std::uint64_t then = before == curve_.begin() ? 0 : std::prev(before)->triangles;
    return witnesses_.size() - then < options_.min_new_triangles;
}

std::size_t GuidedSampler::allowance(std::size_t rays) const {
    return static_cast<std::size_t>(std::min<std::uint64_t>(rays, options_.max_rays - rays_));
}

std::size_t GuidedSampler::cast(std::span<const Ray> rays) {
    const std::size_t count = is_interrupted_ ? 0 : allowance(rays.size());
    hits_.resize(count);
    is_interrupted_ =
        is_interrupted_ ||
        !bvh::closest_hits(tree_, mesh_, rays.first(count), hits_, executor_, options_.interrupt);
    if (is_interrupted_) {
        return 0;
    }
    rays_ += count;
    for (std::size_t i = 0; i < count; ++i) {
        note(rays[i], hits_[i]);
    }
    curve_.push_back({rays_, witnesses_.size()});
    if (options_.progress != nullptr) {
        options_.progress->report("rays", rays_, std::max(rays_ + 1, options_.max_rays));
    }
    return count;
}

void GuidedSampler::note(const Ray& ray, const std::optional<Hit>& met) {
    if (!met || is_known(met->triangle)) {
        return;
    }
    place_[met->triangle] = static_cast<std::uint32_t>(witnesses_.size());
    witnesses_.push_back(ray);
    found_.push_back(met->triangle);
    waiting_.push_back({ray.origin, ray.origin + met->t * ray.direction, met->triangle});
}

// From a place on the border, all alike, in a direction outward, all alike.
Ray GuidedSampler::random_ray(std::uint64_t index) const {
    const auto number = [&](std::uint32_t base) {
        return shifted_radical_inverse(index + 1, base, random(options_.seed, base, 0));
    };
    const auto place = std::upper_bound(faces_.begin(), faces_.end() - 1, number(2) * faces_[5]);
    const auto face = static_cast<int>(place - faces_.begin());
    const int axis = face / 2;
    const int across = (axis + 1) % 3;
    const int along = (axis + 2) % 3;
    Ray ray;
    ray.origin[axis] = face % 2 == 0 ? region_.lower[axis] : region_.upper[axis];
    ray.origin[across] = region_.lower[across] + number(3) * region_.size()[across];
    ray.origin[along] = region_.lower[along] + number(5) * region_.size()[along];
    // The height is never 0.
    const Vec3 outward = on_sphere(1.0 - number(7), 2.0 * std::numbers::pi * number(11));
    ray.direction[axis] = face % 2 == 0 ? -outward.z : outward.z;
    ray.direction[across] = outward.x;
    ray.direction[along] = outward.y;
    return ray;
}

std::size_t GuidedSampler::batch_size() const {
    return static_cast<std::size_t>(std::clamp(rays_ / kRandomShare, kFewestRandom, kMostRandom));
}

void GuidedSampler::cast_random() {
    std::vector<Ray> rays(allowance(batch_size()));
    for (std::size_t i = 0; i < rays.size(); ++i) {
        rays[i] = random_ray(random_rays_ + i);
    }
    marks_.push_back({rays_, random_rays_, random_finds_});
    const std::size_t known = witnesses_.size();
    random_rays_ += cast(rays);
    random_finds_ += witnesses_.size() - known;
}

// From other places of the region, at known triangles in turn: past their borders something else
// may be seen from there. What is hardest to see is mostly seen from a corner or an edge of the
// region.
void GuidedSampler::look_again() {
    const std::size_t count = witnesses_.empty() ? 0 : allowance(batch_size() / kRandomPerLook);
    std::vector<Ray> rays(count);
    for (Ray& ray : rays) {
        const std::uint64_t index = looks_++;
        const auto number = [&](std::uint64_t k) {
            return random(options_.seed, kLook + k, index);
        };
        // Two coordinates are moved to a border for an edge, all three for a corner.
        const std::uint64_t borders = index % 4 < 2 ? 1 : index % 4;
        const auto first = static_cast<std::uint64_t>(3.0 * number(0));
        for (std::uint64_t k = 0; k < 3; ++k) {
            const auto axis = static_cast<int>((first + k) % 3);
            const double place = number(1 + k);
            ray.origin[axis] = region_.lower[axis] +
                               (k < borders ? std::round(place) : place) * region_.size()[axis];
        }
        const Corners corners = corners_of(found_[index % found_.size()]);
        const double u = std::sqrt(number(4));
        const double v = number(5);
        ray.direction = corners[0] + (u * (1.0 - v)) * (corners[1] - corners[0]) +
                        (u * v) * (corners[2] - corners[0]) - ray.origin;
    }
    const std::size_t known = waiting_.size();
    rays.resize(cast(rays));
    waiting_.resize(known);  // all of them are looked about, new or not
    for (std::size_t i = 0; i < rays.size(); ++i) {
        if (hits_[i]) {
            waiting_.push_back({rays[i].origin,
                                rays[i].origin + hits_[i]->t * rays[i].direction,
                                hits_[i]->triangle});
        }
    }
}

// Adaptive border sampling: rays about every triangle, and between two of them where what they meet
// falls apart.
void GuidedSampler::sample_borders(std::span<const Seed> seeds) {
    std::vector<Probe> probes;
    probes.reserve(kBorderPoints * seeds.size());
    for (std::size_t i = 0; i < seeds.size(); ++i) {
        for (const Vec3& point :
             enlarged(seeds[i].eye, corners_of(seeds[i].triangle), options_.border_angle)) {
            probes.push_back({.seed = i, .towards = point});
        }
    }
    cast_probes(seeds, probes);
    std::vector<Gap> gaps;
    for (std::size_t i = 0; i + kBorderPoints <= probes.size(); i += kBorderPoints) {
        for (std::size_t k = 0; k < kBorderPoints; ++k) {
            const Probe& left = probes[i + k];
            const Probe& right = probes[i + (k + 1) % kBorderPoints];
            if (falls_apart(left, right)) {
                gaps.push_back({left, right});
            }
        }
    }
    for (int halving = 0; halving < kHalvings && !gaps.empty(); ++halving) {
        gaps = halve(seeds, gaps);
    }
    const std::vector<Ray> past = std::move(past_);
    past_.clear();
    cast(past);
}

void GuidedSampler::cast_probes(std::span<const Seed> seeds, std::vector<Probe>& probes) {
    std::vector<Ray> rays(probes.size());
    for (std::size_t i = 0; i < probes.size(); ++i) {
        const Vec3& eye = seeds[probes[i].seed].eye;
        rays[i] = {eye, probes[i].towards - eye};
    }
    probes.resize(cast(rays));
    for (std::size_t i = 0; i < probes.size(); ++i) {
        probes[i].met = hits_[i];
        if (hits_[i]) {
            probes[i].hit = rays[i].origin + hits_[i]->t * rays[i].direction;
        }
        if (options_.reverse) {
            look_past(seeds[probes[i].seed], probes[i]);
        }
    }
}

std::vector<GuidedSampler::Gap> GuidedSampler::halve(std::span<const Seed> seeds,
                                                     const std::vector<Gap>& gaps) {
    std::vector<Probe> middles(gaps.size());
    for (std::size_t i = 0; i < gaps.size(); ++i) {
        middles[i].seed = gaps[i].left.seed;
        middles[i].towards = 0.5 * (gaps[i].left.towards + gaps[i].right.towards);
    }
    cast_probes(seeds, middles);
    std::vector<Gap> halves;
    for (std::size_t i = 0; i < middles.size(); ++i) {
        if (falls_apart(gaps[i].left, middles[i])) {
            halves.push_back({gaps[i].left, middles[i]});
        }
        if (falls_apart(middles[i], gaps[i].right)) {
            halves.push_back({middles[i], gaps[i].right});
        }
    }
    return halves;
}

bool GuidedSampler::falls_apart(const Probe& a, const Probe& b) const {
    if (!a.met || !b.met) {
        return a.met.has_value() != b.met.has_value();
    }
    return a.met->triangle != b.met->triangle &&
           glm::distance(a.hit, b.hit) >= options_.threshold * diagonal_;
}

// Reverse sampling.
void GuidedSampler::look_past(const Seed& seed, const Probe& probe) {
    if (!probe.met || probe.met->triangle == seed.triangle) {
        return;
    }
    const Ray ray = {seed.eye, probe.towards - seed.eye};
    const auto expected = expected_hit(ray, corners_of(seed.triangle), kFarthest * diagonal_);
    if (!expected || !(glm::distance(*expected, seed.eye) - glm::distance(probe.hit, seed.eye) >
                       options_.threshold * diagonal_)) {
        return;
    }
    const double gap = options_.border_angle * diagonal_;
    if (const auto past = reverse_ray(
            {ray, probe.hit, corners_of(probe.met->triangle), seed.hit, *expected}, region_, gap)) {
        past_.push_back(*past);
    }
}

Corners GuidedSampler::corners_of(TriangleId triangle) const {
    const geometry::Triangle& corners = mesh_.triangles[triangle];
    return {mesh_.positions[corners[0]], mesh_.positions[corners[1]], mesh_.positions[corners[2]]};
}

}  // namespace earshot::visibility
