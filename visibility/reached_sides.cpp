// SPDX-License-Identifier: MIT
#include "earshot/visibility/reached_sides.h"

#include "earshot/base/math.h"
#include "earshot/base/random.h"
#include "earshot/geometry/disjoint_sets.h"
#include "earshot/visibility/guided_sampling.h"
#include "earshot/visibility/internal/directions.h"
#include "earshot/visibility/internal/side_nodes.h"
#include "earshot/visibility/internal/side_rays.h"

#include <algorithm>
#include <map>
#include <optional>
#include <utility>

namespace earshot::visibility {

using geometry::Hit;
using geometry::Ray;
using geometry::TriangleId;
using geometry::Vec3;

namespace {

constexpr std::size_t kSidesPerBatch = 8192;
/// Rays of a missing side in the first pass that looks for reached ones.
constexpr std::uint64_t kMinRaysBack = 4;
/// Places on a side of a triangle that meets others from which rays are sent on, per air.
constexpr std::uint8_t kMaxPlaces = 8;
constexpr std::uint64_t kRandomRaysPerPoint = 1024;

/// First streams of random numbers.
constexpr std::uint64_t kForwardStream = 100;
constexpr std::uint64_t kBackwardStream = 110;
constexpr std::uint64_t kDirectionStream = 120;

class Flood {
public:
    Flood(const bvh::MeshBvh& bvh,
          std::span<const Vec3> points,
          const ReachedSidesOptions& options,
          Executor& executor)
        : bvh_(bvh),
          points_(points),
          options_(options),
          executor_(executor),
          side_count_(2 * bvh.mesh().triangles.size()),
          sets_(side_count_ + points.size()),
          is_reached_(side_count_, false),
          meets_others_(find_meeting_triangles(bvh, options.tolerance, executor)),
          node_of_reached_(side_count_, ReachedSides::kNone) {
        result_.witnesses.resize(side_count_, {.t_max = 0.0});
    }

    ReachedSides run() {
        for (std::size_t i = 0; i < points_.size(); ++i) {
            look_around(i);
            sample_from_point(i);
        }
        for (std::uint64_t rays = kMinRaysBack; rays <= options_.rays_back_per_side; rays *= 2) {
            back_rays_left_ += rays;
        }
        spread();
        // Each pass doubles the rays of the sides that are still missing, and spreads from those
        // that it finds.
        for (std::uint64_t rays = kMinRaysBack; rays <= options_.rays_back_per_side && has_budget();
             rays *= 2) {
            search_backwards(rays);
            back_rays_left_ -= rays;
            spread();
        }
        if (options_.progress != nullptr) {
            options_.progress->report("air", side_rays_, side_rays_);
        }
        number_airs();
        return std::move(result_);
    }

private:
    /// Something that sends rays: a side that lies in one air, or a place on another side.
    struct Sender {
        SideId side = 0;
        std::uint32_t node = 0;  // of the set of its air
        std::optional<Vec3> place{};
    };

    std::uint32_t node_of_point(std::size_t point) const {
        return static_cast<std::uint32_t>(side_count_ + point);
    }

    bool has_budget() const { return side_rays_ < options_.max_rays; }

    /// The shares of backs and of escapes, from random rays.
    void look_around(std::size_t point) {
        std::vector<Ray> rays(kRandomRaysPerPoint);
        for (std::uint64_t i = 0; i < rays.size(); ++i) {
            rays[i] = {points_[point],
                       on_sphere(random_between(options_.seed, kDirectionStream, i, -1.0, 1.0),
                                 2.0 * math::kPi * random(options_.seed, kDirectionStream + 1, i))};
        }
        const auto hits = bvh_.closest_hits(rays, executor_);
        std::size_t backs = 0;
        std::size_t escapes = 0;
        for (std::size_t i = 0; i < hits.size(); ++i) {
            escapes += hits[i] ? 0 : 1;
            backs += hits[i] && is_back(side_hit(bvh_, rays[i], hits[i]->triangle)) ? 1 : 0;
        }
        const std::size_t met = std::max<std::size_t>(1, hits.size() - escapes);
        result_.back_share.push_back(static_cast<double>(backs) / static_cast<double>(met));
        result_.escape_share.push_back(static_cast<double>(escapes) /
                                       static_cast<double>(hits.size()));
        result_.rays += rays.size();
    }

    void sample_from_point(std::size_t point) {
        const RegionPvs pvs = sample_region(bvh_,
                                            {points_[point], points_[point]},
                                            {.seed = options_.seed,
                                             .max_rays = options_.rays_per_point,
                                             .window = options_.rays_per_point / 4,
                                             .min_new_triangles = 1},
                                            executor_);
        result_.rays += pvs.rays;
        for (std::size_t i = 0; i < pvs.triangles.size(); ++i) {
            // A point on a triangle sees neither of its sides.
            const auto hit = pvs.witnesses[i].t_max > 0.0 ? bvh_.closest_hit(pvs.witnesses[i])
                                                          : std::optional<Hit>();
            if (hit) {
                reach(*hit, node_of_point(point), pvs.witnesses[i]);
            }
        }
    }

    /// Tells how many rays there will be if what is missing stays missing.
    void report_progress() const {
        if (options_.progress == nullptr) {
            return;
        }
        const std::uint64_t expected = side_rays_ + queue_.size() * options_.rays_per_side +
                                       (side_count_ - reached_count_) * back_rays_left_;
        options_.progress->report(
            "air", side_rays_, std::max(side_rays_ + 1, std::min(expected, options_.max_rays)));
    }

    bool is_whole(SideId side) const { return meets_others_[triangle_of(side)] == 0; }

    /// A ray that starts in the air of the set `from` hits a side. Of a side that lies in one air
    /// as a whole random places send rays on, of others the place that was hit.
    void reach(const Hit& hit, std::uint32_t from, const Ray& ray) {
        const SideId side = side_hit(bvh_, ray, hit.triangle);
        if (is_whole(side)) {
            reach_whole(side, from, ray);
            return;
        }
        if (!is_reached_[side]) {
            is_reached_[side] = true;
            ++reached_count_;
            result_.witnesses[side] = ray;
            node_of_reached_[side] = from;
        }
        std::uint8_t& places = places_[{side, sets_.find(from)}];
        if (places < kMaxPlaces) {
            ++places;
            const Vec3 place =
                ray.origin + hit.t * ray.direction + ray_offset(bvh_) * normal_of(bvh_, side);
            queue_.push_back({.side = side, .node = from, .place = place});
        }
    }

    void reach_whole(SideId side, std::uint32_t from, const Ray& witness) {
        sets_.unite(side, from);
        if (!is_reached_[side]) {
            is_reached_[side] = true;
            ++reached_count_;
            result_.witnesses[side] = witness;
            node_of_reached_[side] = side;
            queue_.push_back({.side = side, .node = side, .place = std::nullopt});
        }
    }

    void cast(std::span<const Sender> senders, std::uint64_t rays_per_side, std::uint64_t stream) {
        const std::size_t count = senders.size() * rays_per_side;
        rays_.resize(count);
        origins_.resize(count);
        hits_.resize(count);
        constexpr std::size_t kGrain = 4096;
        executor_.for_each(count, kGrain, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                const Sender& sender = senders[i / rays_per_side];
                // The numbers depend on side and ray alone, and differ from pass to pass.
                const std::uint64_t index =
                    sender.side * std::uint64_t{1024} + i % rays_per_side + rays_per_side;
                rays_[i] = random_side_ray(bvh_, sender.side, options_.seed, stream, index);
                if (sender.place) {
                    rays_[i].origin = *sender.place;
                }
                origins_[i] = triangle_of(sender.side);
            }
        });
        closest_hits(bvh_, rays_, origins_, hits_, executor_);
        side_rays_ += count;
        result_.rays += count;
        report_progress();
    }

    /// Every reached side sends rays, until no new side is met.
    void spread() {
        while (!queue_.empty() && has_budget()) {
            const auto end = queue_.begin() +
                             static_cast<std::ptrdiff_t>(std::min(queue_.size(), kSidesPerBatch));
            const std::vector<Sender> senders(queue_.begin(), end);
            queue_.erase(queue_.begin(), end);
            cast(senders, options_.rays_per_side, kForwardStream);
            for (std::size_t i = 0; i < rays_.size(); ++i) {
                if (hits_[i]) {
                    reach(*hits_[i], senders[i / options_.rays_per_side].node, rays_[i]);
                }
            }
        }
    }

    /// Sides that nothing has reached look for reached ones. The way back is cast: its closest hit
    /// is the witness.
    void search_backwards(std::uint64_t rays_per_side) {
        std::vector<Sender> missing;
        for (SideId side = 0; side < side_count_; ++side) {
            if (!is_reached_[side]) {
                missing.push_back({.side = side, .node = side, .place = std::nullopt});
            }
        }
        for (std::size_t first = 0; first < missing.size() && has_budget();
             first += kSidesPerBatch) {
            const std::span<const Sender> senders =
                std::span(missing).subspan(first, std::min(kSidesPerBatch, missing.size() - first));
            cast(senders, rays_per_side, kBackwardStream);
            std::vector<Ray> back;
            std::vector<TriangleId> origins;
            std::vector<std::pair<SideId, SideId>> links;  // reached, missing
            for (std::size_t i = 0; i < rays_.size(); ++i) {
                if (!hits_[i]) {
                    continue;
                }
                // Only a side that is reached as a whole is reached at the place that was hit.
                const SideId met = side_hit(bvh_, rays_[i], hits_[i]->triangle);
                if (is_reached_[met] && is_whole(met)) {
                    const Vec3 point = rays_[i].origin + hits_[i]->t * rays_[i].direction +
                                       ray_offset(bvh_) * normal_of(bvh_, met);
                    // To the point on the missing side, past the offset of the ray that came.
                    const SideId side = senders[i / rays_per_side].side;
                    const Vec3 target = rays_[i].origin - ray_offset(bvh_) * normal_of(bvh_, side);
                    back.push_back({.origin = point, .direction = target - point});
                    origins.push_back(hits_[i]->triangle);
                    links.emplace_back(met, side);
                }
            }
            std::vector<std::optional<Hit>> hits(back.size());
            closest_hits(bvh_, back, origins, hits, executor_);
            result_.rays += back.size();
            for (std::size_t i = 0; i < back.size(); ++i) {
                const auto [met, side] = links[i];
                if (hits[i] && hits[i]->triangle == triangle_of(side) &&
                    side_hit(bvh_, back[i], hits[i]->triangle) == side) {
                    reach(*hits[i], met, back[i]);
                }
            }
        }
    }

    /// Airs in the order of their first points; those of no point cannot be.
    void number_airs() {
        std::vector<std::uint32_t> number(side_count_ + points_.size(), ReachedSides::kNone);
        for (std::size_t i = 0; i < points_.size(); ++i) {
            std::uint32_t& air = number[sets_.find(node_of_point(i))];
            air = air == ReachedSides::kNone ? result_.airs++ : air;
            result_.air_of_point.push_back(air);
        }
        result_.air_of_side.assign(side_count_, ReachedSides::kNone);
        for (SideId side = 0; side < side_count_; ++side) {
            if (is_reached_[side]) {
                result_.air_of_side[side] = number[sets_.find(node_of_reached_[side])];
            }
        }
    }

    const bvh::MeshBvh& bvh_;
    std::span<const Vec3> points_;
    const ReachedSidesOptions& options_;
    Executor& executor_;
    std::size_t side_count_ = 0;
    geometry::DisjointSets sets_;  // sides, then points
    std::vector<bool> is_reached_;
    std::vector<std::uint8_t> meets_others_;      // per triangle
    std::vector<std::uint32_t> node_of_reached_;  // per reached side: of the set of its air
    std::map<std::pair<SideId, std::uint32_t>, std::uint8_t> places_;  // by side and set
    std::vector<Sender> queue_;
    std::vector<Ray> rays_;
    std::vector<TriangleId> origins_;
    std::vector<std::optional<Hit>> hits_;
    std::uint64_t side_rays_ = 0;
    std::size_t reached_count_ = 0;
    std::uint64_t back_rays_left_ = 0;  // of a side that stays missing
    ReachedSides result_;
};

}  // namespace

ReachedSides sample_reached_sides(const bvh::MeshBvh& bvh,
                                  std::span<const Vec3> points,
                                  const ReachedSidesOptions& options,
                                  Executor& executor) {
    return Flood(bvh, points, options, executor).run();
}

}  // namespace earshot::visibility
