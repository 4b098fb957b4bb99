// SPDX-License-Identifier: MIT
#include "earshot/base/assert.h"
#include "earshot/base/math.h"
#include "earshot/base/random.h"
#include "earshot/bvh/wide_batch.h"
#include "earshot/propagation/internal/lambert.h"
#include "earshot/propagation/internal/ray_tracer.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

namespace earshot::propagation {

using geometry::Ray;
using geometry::Vec3;

namespace {

// Russian roulette: a ray whose loudest band falls below this share of its first energy ends, or
// goes on with its energy divided by the probability of survival, which keeps the mean.
constexpr double kRouletteThreshold = 1e-7;
constexpr double kSurvivalProbability = 0.5;

// Streams of random numbers of a reflection.
constexpr std::uint64_t kStreams = 3;

/// A vector of length nearly 1, brought back to length 1 by one step of Newton's method, so that
/// rounding errors do not grow with the number of reflections.
Vec3 renormalised(const Vec3& v) {
    return (1.5 - 0.5 * glm::dot(v, v)) * v;
}

double infinite() {
    return std::numeric_limits<double>::infinity();
}

}  // namespace

/// Rays that are traced through the scene together, a reflection at a time. The number of bands is
/// known when this is compiled, so that a ray's energies are a few registers.
template <std::size_t kBands>
class RayBatch {
public:
    RayBatch(const RayTracer& tracer, RayTally& tally)
        : tracer_(tracer), scene_(tracer.scene_), options_(tracer.options_), tally_(tally) {}

    void emit(std::uint64_t id);
    bool has_rays() const { return !rays_.empty(); }
    /// Traces every ray to its next surface and reflects it there.
    void advance(std::uint64_t bounce);

private:
    using Energies = std::array<double, kBands>;

    struct Path {
        double travelled = 0.0;  // metres
        std::uint64_t id = 0;
        int specular_bounces = 0;
        bool scattered_before = false;
        bool rain_cast = false;  // diffuse rain has recorded the leg that begins
    };
    struct SurfacePoint {
        Vec3 from, normal;  // offset from the surface, and pointing away from it
        double travelled = 0.0;
        geometry::TriangleId triangle = 0;
    };
    /// A secondary source of diffuse rain: energy that leaves a point of a surface by Lambert's
    /// law.
    struct SecondarySource {
        SurfacePoint point;
        Energies energy;
    };
    struct Probabilities {
        double specular, scattered, transmitted;
        double rain;
    };
    /// The streams of one reflection.
    struct RandomStreams {
        RandomStream branch, direction, roulette;
    };

    void find_hits(std::uint64_t bounce);
    bool interact(std::size_t i, const RandomStreams& random);
    Probabilities probabilities_at(const RaySurface& surface, const Energies& energy) const;
    void attenuate(const RaySurface& surface,
                   const audio::Spectrum& share,
                   double probability,
                   Energies& energy);
    void add_secondary_source(const SurfacePoint& point,
                              const RaySurface& surface,
                              double weight,
                              const Energies& energy);
    bool survives_roulette(const RandomStream& random, std::uint64_t id, Energies& energy);
    void record_sphere_crossings(std::size_t i, double hit_distance);
    void cast_diffuse_rain();
    void record(std::size_t listener,
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
    std::vector<geometry::TriangleId> origin_triangles_;  // the triangle that the ray leaves
    std::vector<Path> paths_;
    std::vector<Energies> energies_;

    std::vector<std::optional<geometry::Hit>> hits_;
    std::vector<SecondarySource> secondary_sources_;  // at least one per ray
    std::size_t secondary_source_count_ = 0;
    std::vector<geometry::Segment> shadow_rays_;
    std::vector<geometry::TriangleId> shadow_ray_origins_;
    std::vector<std::pair<std::size_t, std::size_t>>
        shadow_ray_ends_;  // secondary source, listener
    std::vector<std::uint8_t> occluded_;
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
    origin_triangles_.push_back(0);
    paths_.push_back({.id = id});
    Energies& energy = energies_.emplace_back();
    for (std::size_t band = 0; band < kBands; ++band) {
        energy[band] = 4.0 * math::kPi / count * (pressure[band] * pressure[band]);
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
                          bvh::SecondaryRays{.rays = rays_, .origin_triangles = origin_triangles_},
                          hits_);
    }
}

template <std::size_t kBands>
void RayBatch<kBands>::advance(std::uint64_t bounce) {
    find_hits(bounce);
    secondary_sources_.resize(std::max(secondary_sources_.size(), rays_.size()));
    secondary_source_count_ = 0;
    const RandomStreams random = {.branch = {options_.seed, kStreams * bounce + 1},
                                  .direction = {options_.seed, kStreams * bounce + 2},
                                  .roulette = {options_.seed, kStreams * bounce + 3}};
    std::size_t kept = 0;
    for (std::size_t i = 0; i < rays_.size(); ++i) {
        record_sphere_crossings(i, hits_[i] ? hits_[i]->t : infinite());
        if (!hits_[i]) {
            add(1.0, energies_[i], tally_.balance.escaped.data());
            continue;
        }
        if (bounce == 0) {
            tally_.cubed_first_distances += hits_[i]->t * hits_[i]->t * hits_[i]->t;
        }
        ++tally_.balance.bounces;
        if (interact(i, random)) {
            if (kept != i) {
                rays_[kept] = rays_[i];
                origin_triangles_[kept] = origin_triangles_[i];
                paths_[kept] = paths_[i];
                energies_[kept] = energies_[i];
            }
            ++kept;
        }
    }
    cast_diffuse_rain();
    rays_.resize(kept);
    origin_triangles_.resize(kept);
    paths_.resize(kept);
    energies_.resize(kept);
}

/// Energy density along the ray's chord through the receiver sphere of each listener.
template <std::size_t kBands>
void RayBatch<kBands>::record_sphere_crossings(std::size_t i, double hit_distance) {
    const Path& path = paths_[i];
    if (path.rain_cast ||
        (!path.scattered_before && path.specular_bounces <= options_.specular_order)) {
        return;
    }
    const Ray& ray = rays_[i];
    for (std::size_t k = 0; k < tracer_.receivers_.size(); ++k) {
        const ReceiverSphere& receiver = tracer_.receivers_[k];
        const Vec3 to = receiver.position - ray.origin;
        const double along = glm::dot(to, ray.direction);
        const double half_squared = receiver.radius_squared - (glm::dot(to, to) - along * along);
        if (!(half_squared > 0.0)) {
            continue;
        }
        const double half = std::sqrt(half_squared);
        const double begin = std::max(0.0, along - half);
        const double end = std::min(hit_distance, along + half);
        if (begin < end) {
            record(k,
                   path.travelled + 0.5 * (begin + end),
                   -ray.direction,
                   energies_[i],
                   (end - begin) * receiver.inverse_volume);
        }
    }
}

template <std::size_t kBands>
void RayBatch<kBands>::record(std::size_t listener,
                              double travelled,
                              const Vec3& towards,
                              const Energies& energy,
                              double share) {
    const double position = travelled * tracer_.bins_per_metre_;
    if (!(position < static_cast<double>(tracer_.bins_))) {
        return;
    }
    const auto bin = static_cast<std::size_t>(position);
    add(share, energy, tally_.energy.data() + (listener * tracer_.bins_ + bin) * kBands);
    if (tally_.directions.empty()) {
        return;
    }
    const std::size_t part = audio::direction_part({towards.x, towards.y, towards.z});
    const std::size_t span = listener * tracer_.spans() + bin / audio::kBinsPerSpan;
    add(share, energy, tally_.directions.data() + (span * audio::kDirectionParts + part) * kBands);
}

/// The branching probabilities, from the sums over all bands. Rain is cast with the square root of
/// the probability of scattering and weighted by its inverse: surfaces that scatter little cost few
/// shadow rays.
template <std::size_t kBands>
typename RayBatch<kBands>::Probabilities RayBatch<kBands>::probabilities_at(
    const RaySurface& surface, const Energies& energy) const {
    if (surface.uniform_split) {
        return {.specular = 1.0 - surface.scattering_probability - surface.transmission_probability,
                .scattered = surface.scattering_probability,
                .transmitted = surface.transmission_probability,
                .rain = surface.rain_probability};
    }
    double specular = 0.0;
    double scattered = 0.0;
    double transmitted = 0.0;
    for (std::size_t band = 0; band < kBands; ++band) {
        specular += surface.specular[band] * energy[band];
        scattered += surface.scattered[band] * energy[band];
        transmitted += surface.transmitted[band] * energy[band];
    }
    const double total = specular + scattered + transmitted;
    if (!(total > 0.0)) {
        return {};
    }
    return {.specular = specular / total,
            .scattered = scattered / total,
            .transmitted = transmitted / total,
            .rain = std::sqrt(scattered / total)};
}

/// Reflects, scatters or transmits a ray at the surface that it hits. False: it ends here.
template <std::size_t kBands>
bool RayBatch<kBands>::interact(std::size_t i, const RandomStreams& random) {
    const geometry::Hit& hit = *hits_[i];
    const RayTracer::TriangleSurface& triangle = tracer_.triangle_surfaces_[hit.triangle];
    const RaySurface& surface = tracer_.surfaces_[triangle.surface];
    Ray& ray = rays_[i];
    Path& path = paths_[i];
    Energies& energy = energies_[i];
    const double along = glm::dot(triangle.normal, ray.direction);
    const Probabilities probabilities = probabilities_at(surface, energy);
    if ((along > 0.0 && surface.one_sided) ||
        probabilities.specular + probabilities.scattered + probabilities.transmitted == 0.0) {
        add(1.0, energy, tally_.balance.absorbed.data());
        return false;
    }
    const Vec3 normal = std::copysign(1.0, -along) * triangle.normal;
    path.travelled += hit.t;
    const Vec3 hit_point = ray.origin + hit.t * ray.direction;
    const Vec3 offset_point = hit_point + tracer_.self_intersection_offset_ * normal;
    const double number = random.branch.at(path.id);
    if (number < probabilities.rain) {
        add_secondary_source({offset_point, normal, path.travelled, hit.triangle},
                             surface,
                             1.0 / probabilities.rain,
                             energy);
    }
    path.rain_cast = number < probabilities.scattered;
    const bool passes =
        !path.rain_cast && number < probabilities.scattered + probabilities.transmitted;
    if (path.rain_cast) {
        attenuate(surface, surface.scattered, probabilities.scattered, energy);
        path.scattered_before = true;
        ray.origin = offset_point;
        ray.direction = lambert_direction(normal, random.direction.bits(path.id));
    } else if (passes) {
        attenuate(surface, surface.transmitted, probabilities.transmitted, energy);
        ++path.specular_bounces;
        ray.origin = hit_point - tracer_.self_intersection_offset_ * normal;
    } else {
        attenuate(surface, surface.specular, probabilities.specular, energy);
        ++path.specular_bounces;
        ray.origin = offset_point;
        ray.direction = renormalised(ray.direction - 2.0 * along * triangle.normal);
    }
    origin_triangles_[i] = hit.triangle;
    if (path.travelled > tracer_.max_distance_) {
        add(1.0, energy, tally_.balance.remaining.data());
        return false;
    }
    return survives_roulette(random.roulette, path.id, energy);
}

/// Precondition: fewer drops than rays.
template <std::size_t kBands>
void RayBatch<kBands>::add_secondary_source(const SurfacePoint& point,
                                            const RaySurface& surface,
                                            double weight,
                                            const Energies& energy) {
    SecondarySource& secondary = secondary_sources_[secondary_source_count_++];
    secondary.point = point;
    for (std::size_t band = 0; band < kBands; ++band) {
        secondary.energy[band] = weight * (surface.scattered[band] * energy[band]);
    }
}

/// Multiplies the energies of a ray by the share that its branch keeps. The branch is chosen with
/// the probabilities of all bands together; a band that splits otherwise is weighted.
template <std::size_t kBands>
void RayBatch<kBands>::attenuate(const RaySurface& surface,
                                 const audio::Spectrum& share,
                                 double probability,
                                 Energies& energy) {
    double* absorbed = tally_.balance.absorbed.data();
    const Energies before = energy;
    for (std::size_t band = 0; band < kBands; ++band) {
        absorbed[band] += surface.absorbed[band] * before[band];
    }
    if (surface.uniform_split) {
        for (std::size_t band = 0; band < kBands; ++band) {
            energy[band] = surface.kept[band] * before[band];
        }
        return;
    }
    const double weight = 1.0 / probability;
    for (std::size_t band = 0; band < kBands; ++band) {
        energy[band] = weight * (share[band] * before[band]);
        tally_.balance.roulette_surplus[band] += energy[band] - surface.kept[band] * before[band];
    }
}

/// Russian roulette for faint rays.
template <std::size_t kBands>
bool RayBatch<kBands>::survives_roulette(const RandomStream& random,
                                         std::uint64_t id,
                                         Energies& energy) {
    const double start = 4.0 * math::kPi / static_cast<double>(options_.rays);
    // Two maxima at a time, which shortens the chain of dependent instructions.
    double largest = energy[0];
    double other = energy[1];
    for (std::size_t band = 2; band + 1 < kBands; band += 2) {
        largest = std::max(largest, energy[band]);
        other = std::max(other, energy[band + 1]);
    }
    largest = std::max({largest, other, energy[kBands - 1]});
    if (largest >= kRouletteThreshold * start) {
        return true;
    }
    if (random.at(id) >= kSurvivalProbability) {
        add(1.0, energy, tally_.balance.remaining.data());
        return false;
    }
    for (std::size_t band = 0; band < kBands; ++band) {
        const double raised = energy[band] / kSurvivalProbability;
        tally_.balance.remaining[band] -= raised - energy[band];
        energy[band] = raised;
    }
    return true;
}

/// Adds scattered energy to every listener that is visible from where it was scattered (Heinz
/// 1993).
template <std::size_t kBands>
void RayBatch<kBands>::cast_diffuse_rain() {
    shadow_rays_.clear();
    shadow_ray_origins_.clear();
    shadow_ray_ends_.clear();
    for (std::size_t i = 0; i < secondary_source_count_; ++i) {
        const SurfacePoint& point = secondary_sources_[i].point;
        for (std::size_t k = 0; k < tracer_.receivers_.size(); ++k) {
            const Vec3& listener = tracer_.receivers_[k].position;
            if (glm::dot(listener - point.from, point.normal) > 0.0) {
                shadow_rays_.push_back({point.from, listener});
                shadow_ray_origins_.push_back(point.triangle);
                shadow_ray_ends_.emplace_back(i, k);
            }
        }
    }
    occluded_.resize(shadow_rays_.size());
    bvh::occluded(
        tracer_.wide_,
        scene_.mesh,
        bvh::SecondarySegments{.segments = shadow_rays_, .origin_triangles = shadow_ray_origins_},
        occluded_);
    for (std::size_t j = 0; j < shadow_rays_.size(); ++j) {
        if (occluded_[j] != 0) {
            continue;
        }
        const SecondarySource& secondary = secondary_sources_[shadow_ray_ends_[j].first];
        const Vec3 to_listener = shadow_rays_[j].to - shadow_rays_[j].from;
        const double squared = glm::dot(to_listener, to_listener);
        const double distance = std::sqrt(squared);
        record(shadow_ray_ends_[j].second,
               secondary.point.travelled + distance,
               -to_listener,
               secondary.energy,
               glm::dot(to_listener, secondary.point.normal) / (math::kPi * squared * distance));
    }
}

namespace {

template <std::size_t kBands>
void run_batch(const RayTracer& tracer, std::uint64_t begin, std::uint64_t end, RayTally& tally) {
    // All rays of a group fit into the first-level cache.
    constexpr std::uint64_t kGroupSize = 256;
    RayBatch<kBands> batch(tracer, tally);
    for (std::uint64_t first = begin; first < end; first += kGroupSize) {
        for (std::uint64_t id = first; id < std::min(first + kGroupSize, end); ++id) {
            batch.emit(id);
        }
        for (std::uint64_t bounce = 0; batch.has_rays(); ++bounce) {
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
    tally.energy.assign(receivers_.size() * bins_ * bands_, 0.0);
    if (options_.report_directions) {
        tally.directions.assign(receivers_.size() * spans() * audio::kDirectionParts * bands_, 0.0);
    }
    if (bands_ == kOctaves) {
        run_batch<kOctaves>(*this, begin, end, tally);
    } else {
        run_batch<kThirds>(*this, begin, end, tally);
    }
    return tally;
}

}  // namespace earshot::propagation
