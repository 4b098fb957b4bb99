// SPDX-License-Identifier: MIT
#include "earshot/base/assert.h"
#include "earshot/base/random.h"
#include "earshot/bvh/wide_batch.h"
#include "earshot/propagation/internal/lambert.h"
#include "earshot/propagation/internal/ray_tracer.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

namespace earshot::propagation {

using geometry::Ray;
using geometry::Vec3;

namespace {

constexpr double kPi = std::numbers::pi;

// A ray is played for when it is this faint; the odds keep the mean.
constexpr double kFaint = 1e-7;
constexpr double kSurvival = 0.5;

// Streams of random numbers of a bounce.
constexpr std::uint64_t kStreams = 3;

/// A step of Newton's for a vector of nearly that length, from which roundings lead away.
Vec3 with_length_one(const Vec3& v) {
    return (1.5 - 0.5 * glm::dot(v, v)) * v;
}

double infinite() {
    return std::numeric_limits<double>::infinity();
}

}  // namespace

/// Rays that go through the scene together, a bounce at a time. The number of bands is known when
/// this is compiled, so that a ray's energies are a few registers.
template <std::size_t kBands>
class RayBatch {
public:
    RayBatch(const RayTracer& tracer, RayTally& tally)
        : tracer_(tracer), scene_(tracer.scene_), options_(tracer.options_), tally_(tally) {}

    void emit(std::uint64_t id);
    bool is_under_way() const { return !rays_.empty(); }
    /// One leg of every ray, and what happens at its end.
    void advance(std::uint64_t bounce);

private:
    using Energies = std::array<double, kBands>;

    struct Path {
        double travelled = 0.0;  // metres
        std::uint64_t id = 0;
        int mirrors = 0;
        bool was_scattered = false;  // ever
        bool is_rain = false;        // the leg that begins has been heard as rain
    };
    struct Place {
        Vec3 from, normal;  // a little off the wall, and away from it
        double travelled = 0.0;
        geometry::TriangleId wall = 0;
    };
    /// Energy that leaves a point of a surface after Lambert.
    struct Drop {
        Place place;
        Energies energy;
    };
    struct Chances {
        double mirrored, scattered, through;
        double heard;  // of rain
    };
    /// Streams of a bounce.
    struct Dice {
        RandomStream fate, direction, roulette;
    };

    void find_hits(std::uint64_t bounce);
    bool meet(std::size_t i, const Dice& dice);
    Chances chances_at(const RaySurface& surface, const Energies& energy) const;
    void keep(const RaySurface& surface,
              const audio::Spectrum& share,
              double chance,
              Energies& energy);
    void add_drop(const Place& place,
                  const RaySurface& surface,
                  double more,
                  const Energies& energy);
    bool stays(const RandomStream& dice, std::uint64_t id, Energies& energy);
    void count_passages(std::size_t i, double reach);
    void let_it_rain();
    void hear(std::size_t listener,
              double travelled,
              const Vec3& towards,
              const Energies& energy,
              double share);
    static void add(double share, const Energies& energy, double* to) {
        for (std::size_t band = 0; band < kBands; ++band) {
            to[band] += share * energy[band];
        }
    }

    const RayTracer& tracer_;
    const RayScene& scene_;
    const RayOptions& options_;
    RayTally& tally_;

    // Entry i of each belongs together.
    std::vector<Ray> rays_;
    std::vector<geometry::TriangleId> left_;  // the triangle that the ray leaves
    std::vector<Path> paths_;
    std::vector<Energies> energies_;

    std::vector<std::optional<geometry::Hit>> hits_;
    std::vector<Drop> drops_;  // room for one of each ray
    std::size_t drops_used_ = 0;
    std::vector<geometry::Segment> ways_;
    std::vector<geometry::TriangleId> ways_left_;
    std::vector<std::pair<std::size_t, std::size_t>> way_of_;  // drop, listener
    std::vector<std::uint8_t> blocked_;
};

template <std::size_t kBands>
void RayBatch<kBands>::emit(std::uint64_t id) {
    const auto count = static_cast<double>(options_.rays);
    const RaySource& source = tracer_.source_;
    const Vec3 direction = tracer_.direction_of(id, count);
    audio::Spectrum pressure;
    pressure.fill(1.0);
    if (!source.directivity.is_omnidirectional()) {
        pressure = source.directivity.pressure(options_.bands, source.pose.seen_from(direction));
    }
    rays_.push_back({source.pose.position, direction});
    left_.push_back(0);
    paths_.push_back({.id = id});
    Energies& energy = energies_.emplace_back();
    for (std::size_t band = 0; band < kBands; ++band) {
        energy[band] = 4.0 * kPi / count * (pressure[band] * pressure[band]);
        tally_.balance.emitted[band] += energy[band];
    }
}

template <std::size_t kBands>
void RayBatch<kBands>::find_hits(std::uint64_t bounce) {
    hits_.resize(rays_.size());
    if (bounce == 0) {
        bvh::closest_hits(tracer_.wide_, scene_.mesh, rays_, hits_);
    } else {
        bvh::closest_hits(tracer_.wide_,
                          scene_.mesh,
                          bvh::SecondaryRays{.rays = rays_, .origin_triangles = left_},
                          hits_);
    }
}

template <std::size_t kBands>
void RayBatch<kBands>::advance(std::uint64_t bounce) {
    find_hits(bounce);
    drops_.resize(std::max(drops_.size(), rays_.size()));
    drops_used_ = 0;
    const Dice dice = {.fate = {options_.seed, kStreams * bounce + 1},
                       .direction = {options_.seed, kStreams * bounce + 2},
                       .roulette = {options_.seed, kStreams * bounce + 3}};
    std::size_t kept = 0;
    for (std::size_t i = 0; i < rays_.size(); ++i) {
        count_passages(i, hits_[i] ? hits_[i]->t : infinite());
        if (!hits_[i]) {
            add(1.0, energies_[i], tally_.balance.escaped.data());
            continue;
        }
        if (bounce == 0) {
            tally_.cubed_first_legs += hits_[i]->t * hits_[i]->t * hits_[i]->t;
        }
        ++tally_.balance.bounces;
        if (meet(i, dice)) {
            if (kept != i) {
                rays_[kept] = rays_[i];
                left_[kept] = left_[i];
                paths_[kept] = paths_[i];
                energies_[kept] = energies_[i];
            }
            ++kept;
        }
    }
    let_it_rain();
    rays_.resize(kept);
    left_.resize(kept);
    paths_.resize(kept);
    energies_.resize(kept);
}

/// Energy density along the ray's way through each listener's sphere.
template <std::size_t kBands>
void RayBatch<kBands>::count_passages(std::size_t i, double reach) {
    const Path& path = paths_[i];
    if (path.is_rain || (!path.was_scattered && path.mirrors <= options_.specular_order)) {
        return;
    }
    const Ray& ray = rays_[i];
    for (std::size_t k = 0; k < tracer_.ears_.size(); ++k) {
        const RayEar& ear = tracer_.ears_[k];
        const Vec3 to = ear.position - ray.origin;
        const double along = glm::dot(to, ray.direction);
        const double half_squared = ear.radius_squared - (glm::dot(to, to) - along * along);
        if (!(half_squared > 0.0)) {
            continue;
        }
        const double half = std::sqrt(half_squared);
        const double begin = std::max(0.0, along - half);
        const double end = std::min(reach, along + half);
        if (begin < end) {
            hear(k,
                 path.travelled + 0.5 * (begin + end),
                 -ray.direction,
                 energies_[i],
                 (end - begin) * ear.inverse_volume);
        }
    }
}

template <std::size_t kBands>
void RayBatch<kBands>::hear(std::size_t listener,
                            double travelled,
                            const Vec3& towards,
                            const Energies& energy,
                            double share) {
    const double place = travelled * tracer_.bins_per_metre_;
    if (!(place < static_cast<double>(tracer_.bins_))) {
        return;
    }
    const auto bin = static_cast<std::size_t>(place);
    add(share, energy, tally_.energy.data() + (listener * tracer_.bins_ + bin) * kBands);
    if (tally_.directions.empty()) {
        return;
    }
    const std::size_t part = audio::direction_part({towards.x, towards.y, towards.z});
    const std::size_t span = listener * tracer_.spans() + bin / audio::kBinsPerSpan;
    add(share, energy, tally_.directions.data() + (span * audio::kDirectionParts + part) * kBands);
}

/// The shares of what a ray keeps, over all bands. Little that is scattered is heard seldom, and
/// then as the more.
template <std::size_t kBands>
typename RayBatch<kBands>::Chances RayBatch<kBands>::chances_at(const RaySurface& surface,
                                                                const Energies& energy) const {
    if (surface.is_even) {
        return {.mirrored = 1.0 - surface.chance_scattered - surface.chance_through,
                .scattered = surface.chance_scattered,
                .through = surface.chance_through,
                .heard = surface.chance_heard};
    }
    double mirrored = 0.0;
    double scattered = 0.0;
    double through = 0.0;
    for (std::size_t band = 0; band < kBands; ++band) {
        mirrored += surface.mirrored[band] * energy[band];
        scattered += surface.scattered[band] * energy[band];
        through += surface.through[band] * energy[band];
    }
    const double total = mirrored + scattered + through;
    if (!(total > 0.0)) {
        return {};
    }
    return {.mirrored = mirrored / total,
            .scattered = scattered / total,
            .through = through / total,
            .heard = std::sqrt(scattered / total)};
}

/// Leaves a ray what the surface does. False: it ends here.
template <std::size_t kBands>
bool RayBatch<kBands>::meet(std::size_t i, const Dice& dice) {
    const geometry::Hit& hit = *hits_[i];
    const RayTracer::Wall& wall = tracer_.walls_[hit.triangle];
    const RaySurface& surface = tracer_.surfaces_[wall.surface];
    Ray& ray = rays_[i];
    Path& path = paths_[i];
    Energies& energy = energies_[i];
    const double along = glm::dot(wall.normal, ray.direction);
    const Chances chances = chances_at(surface, energy);
    if ((along > 0.0 && surface.one_sided) ||
        chances.mirrored + chances.scattered + chances.through == 0.0) {
        add(1.0, energy, tally_.balance.absorbed.data());
        return false;
    }
    const Vec3 normal = std::copysign(1.0, -along) * wall.normal;
    path.travelled += hit.t;
    const Vec3 place = ray.origin + hit.t * ray.direction;
    const Vec3 lifted = place + tracer_.lift_ * normal;
    const double die = dice.fate.at(path.id);
    if (die < chances.heard) {
        add_drop(
            {lifted, normal, path.travelled, hit.triangle}, surface, 1.0 / chances.heard, energy);
    }
    path.is_rain = die < chances.scattered;
    const bool passes = !path.is_rain && die < chances.scattered + chances.through;
    if (path.is_rain) {
        keep(surface, surface.scattered, chances.scattered, energy);
        path.was_scattered = true;
        ray.origin = lifted;
        ray.direction = lambert_direction(normal, dice.direction.bits(path.id));
    } else if (passes) {
        keep(surface, surface.through, chances.through, energy);
        ++path.mirrors;
        ray.origin = place - tracer_.lift_ * normal;
    } else {
        keep(surface, surface.mirrored, chances.mirrored, energy);
        ++path.mirrors;
        ray.origin = lifted;
        ray.direction = with_length_one(ray.direction - 2.0 * along * wall.normal);
    }
    left_[i] = hit.triangle;
    if (path.travelled > tracer_.reach_) {
        add(1.0, energy, tally_.balance.left.data());
        return false;
    }
    return stays(dice.roulette, path.id, energy);
}

/// Precondition: fewer drops than rays.
template <std::size_t kBands>
void RayBatch<kBands>::add_drop(const Place& place,
                                const RaySurface& surface,
                                double more,
                                const Energies& energy) {
    Drop& drop = drops_[drops_used_++];
    drop.place = place;
    for (std::size_t band = 0; band < kBands; ++band) {
        drop.energy[band] = more * (surface.scattered[band] * energy[band]);
    }
}

/// Takes from a ray what is absorbed. The chances are the means'; a band that differs from them
/// changes its weight.
template <std::size_t kBands>
void RayBatch<kBands>::keep(const RaySurface& surface,
                            const audio::Spectrum& share,
                            double chance,
                            Energies& energy) {
    double* absorbed = tally_.balance.absorbed.data();
    const Energies before = energy;
    for (std::size_t band = 0; band < kBands; ++band) {
        absorbed[band] += surface.absorbed[band] * before[band];
    }
    if (surface.is_even) {
        for (std::size_t band = 0; band < kBands; ++band) {
            energy[band] = surface.kept[band] * before[band];
        }
        return;
    }
    const double more = 1.0 / chance;
    for (std::size_t band = 0; band < kBands; ++band) {
        energy[band] = more * (share[band] * before[band]);
        tally_.balance.played[band] += energy[band] - surface.kept[band] * before[band];
    }
}

/// Russian roulette for faint rays.
template <std::size_t kBands>
bool RayBatch<kBands>::stays(const RandomStream& dice, std::uint64_t id, Energies& energy) {
    const double start = 4.0 * kPi / static_cast<double>(options_.rays);
    // Two at a time, so that neither waits for the other.
    double largest = energy[0];
    double other = energy[1];
    for (std::size_t band = 2; band + 1 < kBands; band += 2) {
        largest = std::max(largest, energy[band]);
        other = std::max(other, energy[band + 1]);
    }
    largest = std::max({largest, other, energy[kBands - 1]});
    if (largest >= kFaint * start) {
        return true;
    }
    if (dice.at(id) >= kSurvival) {
        add(1.0, energy, tally_.balance.left.data());
        return false;
    }
    for (std::size_t band = 0; band < kBands; ++band) {
        const double raised = energy[band] / kSurvival;
        tally_.balance.left[band] -= raised - energy[band];
        energy[band] = raised;
    }
    return true;
}

/// Scattered energy on its straight way to every listener in sight (Heinz 1993).
template <std::size_t kBands>
void RayBatch<kBands>::let_it_rain() {
    ways_.clear();
    ways_left_.clear();
    way_of_.clear();
    for (std::size_t i = 0; i < drops_used_; ++i) {
        const Place& drop = drops_[i].place;
        for (std::size_t k = 0; k < tracer_.ears_.size(); ++k) {
            const Vec3& ear = tracer_.ears_[k].position;
            if (glm::dot(ear - drop.from, drop.normal) > 0.0) {
                ways_.push_back({drop.from, ear});
                ways_left_.push_back(drop.wall);
                way_of_.emplace_back(i, k);
            }
        }
    }
    blocked_.resize(ways_.size());
    bvh::occluded(tracer_.wide_,
                  scene_.mesh,
                  bvh::SecondarySegments{.segments = ways_, .origin_triangles = ways_left_},
                  blocked_);
    for (std::size_t j = 0; j < ways_.size(); ++j) {
        if (blocked_[j] != 0) {
            continue;
        }
        const Drop& drop = drops_[way_of_[j].first];
        const Vec3 way = ways_[j].to - ways_[j].from;
        const double squared = glm::dot(way, way);
        const double distance = std::sqrt(squared);
        hear(way_of_[j].second,
             drop.place.travelled + distance,
             -way,
             drop.energy,
             glm::dot(way, drop.place.normal) / (kPi * squared * distance));
    }
}

namespace {

template <std::size_t kBands>
void run_batch(const RayTracer& tracer, std::uint64_t begin, std::uint64_t end, RayTally& tally) {
    // So many at a time that all of them stay in the processor's nearest memory.
    constexpr std::uint64_t kFlock = 256;
    RayBatch<kBands> batch(tracer, tally);
    for (std::uint64_t first = begin; first < end; first += kFlock) {
        for (std::uint64_t id = first; id < std::min(first + kFlock, end); ++id) {
            batch.emit(id);
        }
        for (std::uint64_t bounce = 0; batch.is_under_way(); ++bounce) {
            batch.advance(bounce);
        }
    }
}

}  // namespace

RayTally RayTracer::trace(std::uint64_t begin, std::uint64_t end) const {
    constexpr std::size_t kOctaves = 10;
    constexpr std::size_t kThirds = 31;
    EARSHOT_ASSERT(bands_ == kOctaves || bands_ == kThirds);
    RayTally tally;
    tally.energy.assign(ears_.size() * bins_ * bands_, 0.0);
    if (options_.tells_directions) {
        tally.directions.assign(ears_.size() * spans() * audio::kDirectionParts * bands_, 0.0);
    }
    if (bands_ == kOctaves) {
        run_batch<kOctaves>(*this, begin, end, tally);
    } else {
        run_batch<kThirds>(*this, begin, end, tally);
    }
    return tally;
}

}  // namespace earshot::propagation
