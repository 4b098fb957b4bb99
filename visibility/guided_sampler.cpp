// SPDX-License-Identifier: MIT
#include "earshot/visibility/internal/guided_sampler.h"

#include "earshot/base/halton.h"
#include "earshot/base/math.h"
#include "earshot/base/random.h"
#include "earshot/visibility/internal/directions.h"
#include "earshot/visibility/internal/masked_hits.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace earshot::visibility {

using geometry::Hit;
using geometry::Ray;
using geometry::Vec3;

namespace {

// A batch has enough seeds for ray packets and interleaved rays, and few enough that its hits guide
// the next batch.
constexpr std::size_t kSeedsPerBatch = 1024;

// The first batch of random rays is small. Later batches grow in proportion to all rays so far,
// because small triangles are then hit one by one.
constexpr std::uint64_t kMinRandomRays = 64;
constexpr std::uint64_t kMaxRandomRays = 1U << 14U;
constexpr std::uint64_t kRaysPerRandomRay = 8;

// The number of random rays per known triangle that is sampled again. Sampling the border of that
// triangle takes one or two dozen rays.
constexpr std::uint64_t kRandomRaysPerReseed = 16;

// The first of the random streams of reseeding.
constexpr std::uint64_t kReseedStream = 40;

// The number of bisections of a border interval: down to 1/128 of a side.
constexpr int kMaxSubdivisions = 7;

// The largest distance of an expected hit, in diagonals of the scene, at which a closer hit counts
// as an occluder.
constexpr double kMaxPlaneDistance = 4.0;

}  // namespace

GuidedSampler::GuidedSampler(const bvh::MeshBvh& bvh,
                             const ViewRegion& region,
                             const GuidedSamplingOptions& options,
                             Executor& executor)
    : bvh_(bvh),
      region_(region),
      options_(options),
      executor_(executor),
      excluded_(with_degenerate(options.excluded, bvh.mesh())) {
    index_of_triangle_.assign(bvh.mesh().triangles.size(), kUnknown);
    if (!bvh.tree().box().is_empty()) {
        Vec3 size(0.0);
        for (int axis = 0; axis < 3; ++axis) {
            const auto k = static_cast<std::size_t>(axis);
            size[axis] = double{bvh.tree().box().upper[k]} - double{bvh.tree().box().lower[k]};
        }
        diagonal_ = glm::length(size);
    }
    const Vec3 size = region.size();
    double sum = 0.0;
    for (int face = 0; face < 6; ++face) {
        sum += size[(face / 2 + 1) % 3] * size[(face / 2 + 2) % 3];
        face_areas_[static_cast<std::size_t>(face)] = sum;
    }
    if (sum == 0.0) {
        // If the region is a line or a point, all faces emit the same number of rays.
        for (std::size_t face = 0; face < 6; ++face) {
            face_areas_[face] = static_cast<double>(face + 1);
        }
    }
}

RegionPvs GuidedSampler::run() {
    RegionPvs pvs;
    while (!is_finished()) {
        cast_random();
        if (options_.guided) {
            reseed_known_triangles();
        }
        while (options_.guided && !queue_.empty() && !is_finished()) {
            const std::size_t count = std::min(kSeedsPerBatch, queue_.size());
            const auto end = queue_.begin() + static_cast<std::ptrdiff_t>(count);
            const std::vector<Seed> seeds(queue_.begin(), end);
            queue_.erase(queue_.begin(), end);
            sample_borders(seeds);
        }
    }
    if (options_.progress != nullptr) {
        options_.progress->report("rays", rays_, rays_);
    }
    pvs.rays = rays_;
    pvs.curve = curve_;
    return pvs;
}

bool GuidedSampler::is_finished() const {
    if (is_interrupted_ || rays_ >= options_.max_rays || bvh_.mesh().triangles.empty()) {
        return true;
    }
    if (rays_ < options_.window) {
        return false;
    }
    const auto before = std::partition_point(curve_.begin(), curve_.end(), [&](const auto& point) {
        return point.rays + options_.window <= rays_;
    });
    const std::uint64_t triangles_before =
        before == curve_.begin() ? 0 : std::prev(before)->triangles;
    return witnesses_.size() - triangles_before < options_.min_new_triangles;
}

std::size_t GuidedSampler::rays_allowed(std::size_t rays) const {
    return static_cast<std::size_t>(std::min<std::uint64_t>(rays, options_.max_rays - rays_));
}

std::size_t GuidedSampler::cast(std::span<const Ray> rays) {
    const std::size_t count = is_interrupted_ ? 0 : rays_allowed(rays.size());
    hits_.resize(count);
    is_interrupted_ =
        is_interrupted_ ||
        !closest_hits(bvh_, rays.first(count), excluded_, hits_, executor_, options_.interrupt);
    if (is_interrupted_) {
        return 0;
    }
    rays_ += count;
    for (std::size_t i = 0; i < count; ++i) {
        record(rays[i], hits_[i]);
    }
    curve_.push_back({rays_, witnesses_.size()});
    if (options_.progress != nullptr) {
        options_.progress->report("rays", rays_, std::max(rays_ + 1, options_.max_rays));
    }
    return count;
}

void GuidedSampler::record(const Ray& ray, const std::optional<Hit>& hit) {
    if (!hit || is_known(hit->triangle)) {
        return;
    }
    index_of_triangle_[hit->triangle] = static_cast<std::uint32_t>(witnesses_.size());
    witnesses_.push_back(ray);
    found_.push_back(hit->triangle);
    queue_.push_back({ray.origin, ray.origin + hit->t * ray.direction, hit->triangle});
}

// The origin is distributed uniformly on the boundary of the region, the direction uniformly on the
// hemisphere that points outwards.
Ray GuidedSampler::random_ray(std::uint64_t index) const {
    const auto random_number = [&](std::uint32_t base) {
        return shifted_radical_inverse(index + 1, base, random(options_.seed, base, 0));
    };
    const auto position = std::upper_bound(
        face_areas_.begin(), face_areas_.end() - 1, random_number(2) * face_areas_[5]);
    const auto face = static_cast<int>(position - face_areas_.begin());
    const int axis = face / 2;
    const int across = (axis + 1) % 3;
    const int along = (axis + 2) % 3;
    Ray ray;
    ray.origin[axis] = face % 2 == 0 ? region_.lower[axis] : region_.upper[axis];
    ray.origin[across] = region_.lower[across] + random_number(3) * region_.size()[across];
    ray.origin[along] = region_.lower[along] + random_number(5) * region_.size()[along];
    // The component along the face's normal is never 0.
    const Vec3 outward = on_sphere(1.0 - random_number(7), 2.0 * math::kPi * random_number(11));
    ray.direction[axis] = face % 2 == 0 ? -outward.z : outward.z;
    ray.direction[across] = outward.x;
    ray.direction[along] = outward.y;
    return ray;
}

std::size_t GuidedSampler::batch_size() const {
    return static_cast<std::size_t>(
        std::clamp(rays_ / kRaysPerRandomRay, kMinRandomRays, kMaxRandomRays));
}

void GuidedSampler::cast_random() {
    std::vector<Ray> rays(rays_allowed(batch_size()));
    for (std::size_t i = 0; i < rays.size(); ++i) {
        rays[i] = random_ray(random_rays_ + i);
    }
    random_rays_ += cast(rays);
}

// Samples the borders of known triangles again, one after another, from other points of the region,
// from which other triangles may be visible past those borders. The triangles that are hardest to
// find are mostly visible from a corner or an edge of the region, so half of the points lie there.
void GuidedSampler::reseed_known_triangles() {
    const std::size_t count =
        witnesses_.empty() ? 0 : rays_allowed(batch_size() / kRandomRaysPerReseed);
    std::vector<Ray> rays(count);
    for (Ray& ray : rays) {
        const std::uint64_t index = reseeds_++;
        const auto random_number = [&](std::uint64_t k) {
            return random(options_.seed, kReseedStream + k, index);
        };
        // One coordinate is moved to the boundary for a face, two for an edge, three for a corner.
        const std::uint64_t boundary_axes = index % 4 < 2 ? 1 : index % 4;
        const auto first = static_cast<std::uint64_t>(3.0 * random_number(0));
        for (std::uint64_t k = 0; k < 3; ++k) {
            const auto axis = static_cast<int>((first + k) % 3);
            const double position = random_number(1 + k);
            ray.origin[axis] =
                region_.lower[axis] +
                (k < boundary_axes ? std::round(position) : position) * region_.size()[axis];
        }
        const Corners corners = bvh_.corners(found_[index % found_.size()]);
        const double u = std::sqrt(random_number(4));
        const double v = random_number(5);
        ray.direction = corners[0] + (u * (1.0 - v)) * (corners[1] - corners[0]) +
                        (u * v) * (corners[2] - corners[0]) - ray.origin;
    }
    // Every hit becomes a seed, whether its triangle is new or known. This replaces the seeds of
    // new triangles that cast() adds.
    const std::size_t previous_size = queue_.size();
    rays.resize(cast(rays));
    queue_.resize(previous_size);
    for (std::size_t i = 0; i < rays.size(); ++i) {
        if (hits_[i]) {
            queue_.push_back({rays[i].origin,
                              rays[i].origin + hits_[i]->t * rays[i].direction,
                              hits_[i]->triangle});
        }
    }
}

// Adaptive border sampling (Wonka et al. 2006, section 4.1): casts rays through the vertices of an
// enlarged polygon around every triangle, and through points between two neighbouring vertices
// whose hits are discontinuous.
void GuidedSampler::sample_borders(std::span<const Seed> seeds) {
    std::vector<BorderSample> samples;
    samples.reserve(kPolygonVertices * seeds.size());
    for (std::size_t i = 0; i < seeds.size(); ++i) {
        for (const Vec3& point : enlarged_polygon(
                 seeds[i].eye, bvh_.corners(seeds[i].triangle), options_.border_angle)) {
            samples.push_back({.seed = i, .target = point});
        }
    }
    cast_samples(seeds, samples);
    std::vector<BorderInterval> intervals;
    for (std::size_t i = 0; i + kPolygonVertices <= samples.size(); i += kPolygonVertices) {
        for (std::size_t k = 0; k < kPolygonVertices; ++k) {
            const BorderSample& left = samples[i + k];
            const BorderSample& right = samples[i + (k + 1) % kPolygonVertices];
            if (is_discontinuous(left, right)) {
                intervals.push_back({left, right});
            }
        }
    }
    for (int level = 0; level < kMaxSubdivisions && !intervals.empty(); ++level) {
        intervals = subdivide(seeds, intervals);
    }
    const std::vector<Ray> rays = std::move(reverse_rays_);
    reverse_rays_.clear();
    cast(rays);
}

void GuidedSampler::cast_samples(std::span<const Seed> seeds, std::vector<BorderSample>& samples) {
    std::vector<Ray> rays(samples.size());
    for (std::size_t i = 0; i < samples.size(); ++i) {
        const Vec3& eye = seeds[samples[i].seed].eye;
        rays[i] = {eye, samples[i].target - eye};
    }
    samples.resize(cast(rays));
    for (std::size_t i = 0; i < samples.size(); ++i) {
        samples[i].hit = hits_[i];
        if (hits_[i]) {
            samples[i].hit_point = rays[i].origin + hits_[i]->t * rays[i].direction;
        }
        if (options_.reverse) {
            sample_reverse(seeds[samples[i].seed], samples[i]);
        }
    }
}

std::vector<GuidedSampler::BorderInterval> GuidedSampler::subdivide(
    std::span<const Seed> seeds, const std::vector<BorderInterval>& intervals) {
    std::vector<BorderSample> midpoints(intervals.size());
    for (std::size_t i = 0; i < intervals.size(); ++i) {
        midpoints[i].seed = intervals[i].left.seed;
        midpoints[i].target = 0.5 * (intervals[i].left.target + intervals[i].right.target);
    }
    cast_samples(seeds, midpoints);
    std::vector<BorderInterval> subintervals;
    for (std::size_t i = 0; i < midpoints.size(); ++i) {
        if (is_discontinuous(intervals[i].left, midpoints[i])) {
            subintervals.push_back({intervals[i].left, midpoints[i]});
        }
        if (is_discontinuous(midpoints[i], intervals[i].right)) {
            subintervals.push_back({midpoints[i], intervals[i].right});
        }
    }
    return subintervals;
}

bool GuidedSampler::is_discontinuous(const BorderSample& a, const BorderSample& b) const {
    if (!a.hit || !b.hit) {
        return a.hit.has_value() != b.hit.has_value();
    }
    return a.hit->triangle != b.hit->triangle &&
           glm::distance(a.hit_point, b.hit_point) >= options_.threshold * diagonal_;
}

// Reverse sampling (Wonka et al. 2006, section 4.2): if the hit lies clearly in front of the plane
// of the seed's triangle, the hit triangle is an occluder, and a ray past it is cast from another
// point of the region.
void GuidedSampler::sample_reverse(const Seed& seed, const BorderSample& sample) {
    if (!sample.hit || sample.hit->triangle == seed.triangle) {
        return;
    }
    const Ray ray = {seed.eye, sample.target - seed.eye};
    const auto expected =
        expected_hit(ray, bvh_.corners(seed.triangle), kMaxPlaneDistance * diagonal_);
    if (!expected ||
        !(glm::distance(*expected, seed.eye) - glm::distance(sample.hit_point, seed.eye) >
          options_.threshold * diagonal_)) {
        return;
    }
    const double gap = options_.border_angle * diagonal_;
    if (const auto reverse = reverse_ray(
            {ray, sample.hit_point, bvh_.corners(sample.hit->triangle), seed.hit_point, *expected},
            region_,
            gap)) {
        reverse_rays_.push_back(*reverse);
    }
}

}  // namespace earshot::visibility
