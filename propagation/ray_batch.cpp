// SPDX-License-Identifier: MIT
#include "earshot/propagation/internal/ray_batch.h"

#include "earshot/base/assert.h"
#include "earshot/base/math.h"
#include "earshot/base/random.h"
#include "earshot/bvh/wide_batch.h"
#include "earshot/propagation/internal/lambert.h"
#include "earshot/propagation/internal/spiral.h"

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

// Russian roulette: a ray whose loudest band falls below a share of its first energy ends, or goes
// on with its energy divided by the probability of survival, which keeps the mean.
constexpr double kSurvivalProbability = 0.5;

// Streams of random numbers of a reflection.
constexpr std::uint64_t kStreams = 4;

/// A vector of length nearly 1, brought back to length 1 by one step of Newton's method, so that
/// rounding errors do not grow with the number of reflections.
Vec3 renormalised(const Vec3& v) {
    return (1.5 - 0.5 * glm::dot(v, v)) * v;
}

}  // namespace

template <std::size_t kBands>
void RayBatch<kBands>::emit(std::uint64_t id, const Vec3& direction) {
    const RaySource& source = tracer_.source_;
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
        energy[band] = start_energy_ * (pressure[band] * pressure[band]);
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
                                  .roulette = {options_.seed, kStreams * bounce + 3},
                                  .chord = {options_.seed, kStreams * bounce + 4}};
    find_chords(random.chord);
    record_chords();
    std::size_t kept = 0;
    for (std::size_t i = 0; i < rays_.size(); ++i) {
        if (!hits_[i]) {
            add(1.0, energies_[i], tally_.balance.escaped.data());
            continue;
        }
        if (bounce == 0) {
            // The cone of the ray, of the solid angle 4 pi / rays.
            tally_.visible_volume +=
                start_energy_ / 3.0 * (hits_[i]->t * hits_[i]->t * hits_[i]->t);
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
    path.image_distance += hit.t;
    const Vec3 hit_point = ray.origin + hit.t * ray.direction;
    const Vec3 offset_point = hit_point + tracer_.self_intersection_offset_ * normal;
    if (path.specular_bounces > 0 || path.scattered_before) {
        record_near_field(i, hit_point, normal);
    }
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
        path.image_distance = 0.0;
        path.reflections_of_image = 0;
        path.scattering_normal = normal;
        path.scattering_cosine = glm::dot(ray.direction, normal);
    } else if (passes) {
        attenuate(surface, surface.transmitted, probabilities.transmitted, energy);
        ++path.specular_bounces;
        path.reflections_of_image += kMaxNearReflections + 1;
        ray.origin = hit_point - tracer_.self_intersection_offset_ * normal;
    } else {
        attenuate(surface, surface.specular, probabilities.specular, energy);
        ++path.specular_bounces;
        ray.origin = offset_point;
        ray.direction = renormalised(ray.direction - 2.0 * along * triangle.normal);
        ++path.reflections_of_image;
        path.scattering_normal -=
            2.0 * glm::dot(path.scattering_normal, triangle.normal) * triangle.normal;
    }
    origin_triangles_[i] = hit.triangle;
    if (path.travelled > tracer_.max_distance_) {
        add(1.0, energy, tally_.balance.remaining.data());
        return false;
    }
    return survives_roulette(random.roulette, path, energy);
}

/// Precondition: fewer secondary sources than rays.
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
                                         const Path& path,
                                         Energies& energy) {
    // Two maxima at a time, which shortens the chain of dependent instructions.
    double largest = energy[0];
    double other = energy[1];
    for (std::size_t band = 2; band + 1 < kBands; band += 2) {
        largest = std::max(largest, energy[band]);
        other = std::max(other, energy[band + 1]);
    }
    largest = std::max({largest, other, energy[kBands - 1]});
    if (largest >= tracer_.roulette_threshold(path.travelled) * start_energy_) {
        return true;
    }
    if (random.at(path.id) >= kSurvivalProbability) {
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

namespace {

template <std::size_t kBands>
void run_batch(const RayTracer& tracer,
               std::uint64_t first_id,
               std::uint64_t rays,
               const glm::dmat3& rotation,
               RayTally& tally) {
    // All rays of a group fit into the first-level cache.
    constexpr std::uint64_t kGroupSize = 256;
    RayBatch<kBands> batch(tracer, rays, tally);
    batch.record_direct_scattering();
    for (std::uint64_t first = 0; first < rays; first += kGroupSize) {
        for (std::uint64_t i = first; i < std::min(first + kGroupSize, rays); ++i) {
            batch.emit(first_id + i, rotation * spiral_direction(i, static_cast<double>(rays)));
        }
        for (std::uint64_t bounce = 0; batch.has_rays(); ++bounce) {
            batch.advance(bounce);
        }
    }
}

}  // namespace

RayTally RayTracer::trace(std::uint64_t index, std::uint64_t rays) const {
    constexpr std::size_t kOctaves = 10;
    constexpr std::size_t kThirds = 31;
    EARSHOT_ASSERT(bands_ == kOctaves || bands_ == kThirds);
    RayTally tally;
    tally.energy.assign(receivers_.size() * bins_ * bands_, 0.0);
    if (options_.report_directions) {
        tally.directions.assign(receivers_.size() * spans() * audio::kDirectionParts * bands_, 0.0);
    }
    const std::uint64_t first_id = index * kMaxBatchRays;
    const glm::dmat3 rotation = random_rotation(options_.seed, 0, index);
    if (bands_ == kOctaves) {
        run_batch<kOctaves>(*this, first_id, rays, rotation, tally);
    } else {
        run_batch<kThirds>(*this, first_id, rays, rotation, tally);
    }
    return tally;
}

}  // namespace earshot::propagation
