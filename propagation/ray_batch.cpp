// SPDX-License-Identifier: MIT
#include "earshot/propagation/internal/ray_batch.h"

#include "earshot/base/assert.h"
#include "earshot/base/math.h"
#include "earshot/base/random.h"
#include "earshot/propagation/internal/lambert.h"
#include "earshot/propagation/internal/spiral.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <vector>

namespace earshot::propagation {

using geometry::Ray;
using geometry::Vec3;

namespace {

// Russian roulette: a ray whose loudest band falls below a share of its first energy ends, or goes
// on with its energy divided by the probability of survival, which keeps the mean.
constexpr double kSurvivalProbability = 0.5;

// Streams of random numbers of a reflection. Stream 0 turns batches.
constexpr std::uint64_t kStreams = 4;
constexpr std::uint64_t kDirectionStream = 2;
constexpr std::uint64_t kSplitStream = kBallStream + 1;

// The surface of a ray's hit is fetched so many rays before it is needed.
constexpr std::size_t kPrefetchDistance = 8;

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
    reflections_.resize(reflections_.size() + counts_);
    Energies& energy = energies_.emplace_back();
    for (std::size_t band = 0; band < kBands; ++band) {
        energy[band] = start_energy_ * (pressure[band] * pressure[band]);
        balance_.emitted[band] += energy[band];
    }
}

template <std::size_t kBands>
void RayBatch<kBands>::scatter_near(std::span<const NearScattering> places, double energy) {
    secondary_sources_.resize(std::max(secondary_sources_.size(), places.size()));
    rain_reflections_.resize(secondary_sources_.size() * counts_);
    secondary_source_count_ = 0;
    const RandomStream random(options_.seed, kDirectionStream);
    for (std::size_t i = 0; i < places.size(); ++i) {
        const NearScattering& place = places[i];
        const RayTracer::TriangleSurface& triangle = tracer_.triangle_surfaces_[place.hit.triangle];
        const double along = glm::dot(triangle.normal, place.ray.direction);
        const RaySurface& surface = surfaces_[triangle.front + (along > 0.0 ? 1 : 0)];
        const Vec3 normal = std::copysign(1.0, -along) * triangle.normal;
        const SurfacePoint point = {place.ray.origin + place.hit.t * place.ray.direction +
                                        tracer_.self_intersection_offset_ * normal,
                                    normal,
                                    place.travelled,
                                    place.hit.triangle};
        rays_.push_back(place.ray);
        origin_triangles_.push_back(place.hit.triangle);
        Path& path = paths_.emplace_back();
        path.travelled = place.travelled;
        path.id = reversed_->first_id + place.start;
        path.start = static_cast<std::uint32_t>(place.start);
        Energies& energies = energies_.emplace_back();
        for (std::size_t band = 0; band < kBands; ++band) {
            energies[band] = energy * place.energy[band];
        }
        const std::uint32_t material = triangle.front / 2;
        reflections_.resize(reflections_.size() + counts_);
        for (std::size_t k = 0; k < place.reflections && materials_ > 0; ++k) {
            count_reflection(place.materials[k], false, reflections_of(i));
        }
        add_secondary_source(point, path, std::abs(along), surface, 1.0, energies);
        set_rain_reflections(i, material);
        if (materials_ > 0) {
            count_reflection(material, true, reflections_of(i));
        }
        for (std::size_t band = 0; band < kBands; ++band) {
            energies[band] *= surface.scattered[band];
        }
        path.recorded_by_rain = true;
        scatter(i, point, std::abs(along), random.bits(path.id));
    }
    cast_diffuse_rain({options_.seed, kFirstRainStream});
}

template <std::size_t kBands>
void RayBatch<kBands>::find_hits(std::uint64_t bounce) {
    hits_.resize(rays_.size());
    if (bounce == 0) {
        scene_.bvh.closest_hits(rays_, hits_);
    } else {
        scene_.bvh.closest_hits(
            bvh::SecondaryRays{.rays = rays_, .origin_triangles = origin_triangles_}, hits_);
    }
}

template <std::size_t kBands>
void RayBatch<kBands>::advance(std::uint64_t bounce) {
    find_hits(bounce);
    secondary_sources_.resize(std::max(secondary_sources_.size(), rays_.size()));
    rain_reflections_.resize(secondary_sources_.size() * counts_);
    secondary_source_count_ = 0;
    const RandomStreams random = {
        .branch = {options_.seed, kStreams * bounce + 1},
        .direction = {options_.seed, kStreams * bounce + kDirectionStream},
        .roulette = {options_.seed, kStreams * bounce + 3},
        .chord = {options_.seed, kStreams * bounce + 4},
        .trials = {options_.seed, kFirstTrialStream + bounce},
        .rain = {options_.seed, kFirstRainStream + bounce}};
    find_chords(random.chord);
    record_chords(random.trials);
    std::size_t kept = 0;
    const std::size_t count = rays_.size();
    for (std::size_t i = 0; i < count; ++i) {
        if (i + kPrefetchDistance < count && hits_[i + kPrefetchDistance]) {
            __builtin_prefetch(&tracer_.triangle_surfaces_[hits_[i + kPrefetchDistance]->triangle]);
        }
        if (!hits_[i]) {
            add(1.0, energies_[i], balance_.escaped.data());
            continue;
        }
        if (bounce == 0) {
            // The cone of the ray, of the solid angle 4 pi / rays.
            result_.visible_volume +=
                start_energy_ / 3.0 * (hits_[i]->t * hits_[i]->t * hits_[i]->t);
        }
        ++balance_.bounces;
        if (interact(i, random)) {
            if (!tracer_.window_.empty()) {
                split(i, random.direction);
            }
            move_ray(i, kept++);
        }
    }
    for (std::size_t i = count; i < rays_.size(); ++i) {
        move_ray(i, kept++);
    }
    cast_diffuse_rain(random.rain);
    rays_.resize(kept);
    origin_triangles_.resize(kept);
    paths_.resize(kept);
    energies_.resize(kept);
    reflections_.resize(kept * counts_);
}

template <std::size_t kBands>
void RayBatch<kBands>::move_ray(std::size_t from, std::size_t to) {
    if (from != to) {
        rays_[to] = rays_[from];
        origin_triangles_[to] = origin_triangles_[from];
        paths_[to] = paths_[from];
        energies_[to] = energies_[from];
        std::copy_n(reflections_of(from), counts_, reflections_of(to));
    }
}

/// The weight of a ray in the tracer's window.
template <std::size_t kBands>
double RayBatch<kBands>::weight_in_window(const Path& path, const Energies& energy) const {
    const audio::Spectrum& scale = tracer_.window_.scale_at(path.travelled);
    double largest = 0.0;
    for (std::size_t band = 0; band < kBands; ++band) {
        largest = std::max(largest, scale[band] * energy[band]);
    }
    return largest / start_energy_;
}

/// Splits a heavy ray into parts with random numbers of their own, and with directions of their own
/// where it was scattered just now. Few enough that a decay that was misjudged does not multiply
/// them without end.
template <std::size_t kBands>
void RayBatch<kBands>::split(std::size_t i, const RandomStream& direction) {
    constexpr double kMaxParts = 16.0;
    constexpr std::size_t kMaxRays = 4096;
    const double parts = std::min(std::floor(weight_in_window(paths_[i], energies_[i])), kMaxParts);
    if (!(parts >= 2.0) || rays_.size() >= kMaxRays) {
        return;
    }
    for (double& energy : energies_[i]) {
        energy /= parts;
    }
    const RandomStream ids(options_.seed, kSplitStream);
    std::uint64_t id = paths_[i].id;
    for (double part = 1.0; part < parts; ++part) {
        rays_.push_back(rays_[i]);
        origin_triangles_.push_back(origin_triangles_[i]);
        energies_.push_back(energies_[i]);
        paths_.push_back(paths_[i]);
        reflections_.resize(reflections_.size() + counts_);
        std::copy_n(reflections_of(i), counts_, reflections_of(rays_.size() - 1));
        Path& path = paths_.back();
        // The stream of the reflection tells parts of one ray at different reflections apart.
        id = ids.bits(id);
        path.id = id ^ direction.bits(paths_[i].id);
        if (path.recorded_by_rain) {
            rays_.back().direction =
                lambert_direction(path.scattering_normal, direction.bits(path.id));
            path.scattering_cosine = glm::dot(rays_.back().direction, path.scattering_normal);
        }
    }
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
    Ray& ray = rays_[i];
    Path& path = paths_[i];
    Energies& energy = energies_[i];
    const double along = glm::dot(triangle.normal, ray.direction);
    const RaySurface& surface = surfaces_[triangle.front + (along > 0.0 ? 1 : 0)];
    const std::uint32_t material = triangle.front / 2;
    if (materials_ > 0 && !reversed_) {
        record_absorption(material, path.travelled + hit.t, surface, energy);
    }
    const Probabilities probabilities = probabilities_at(surface, energy);
    if (probabilities.specular + probabilities.scattered + probabilities.transmitted == 0.0) {
        add(1.0, energy, balance_.absorbed.data());
        return false;
    }
    const Vec3 normal = std::copysign(1.0, -along) * triangle.normal;
    path.travelled += hit.t;
    path.image_distance += hit.t;
    const Vec3 hit_point = ray.origin + hit.t * ray.direction;
    const SurfacePoint point = {hit_point + tracer_.self_intersection_offset_ * normal,
                                normal,
                                path.travelled,
                                hit.triangle};
    if (reversed_ && tracer_.source_field_) {
        record_near_field(i, surface, hit_point, normal);
    }
    const double number = random.branch.at(path.id);
    if (number < probabilities.rain) {
        add_secondary_source(
            point, path, std::abs(along), surface, 1.0 / probabilities.rain, energy);
        set_rain_reflections(i, material);
    }
    path.recorded_by_rain = number < probabilities.scattered;
    const bool passes =
        !path.recorded_by_rain && number < probabilities.scattered + probabilities.transmitted;
    if (materials_ > 0 && !passes) {
        count_reflection(material, path.recorded_by_rain, reflections_of(i));
    }
    if (path.recorded_by_rain) {
        attenuate(surface, surface.scattered, probabilities.scattered, energy);
        scatter(i, point, std::abs(along), random.direction.bits(path.id));
    } else if (passes) {
        attenuate(surface, surface.transmitted, probabilities.transmitted, energy);
        ++path.specular_bounces;
        constexpr int kTooMany = 1000;
        path.reflections_of_image += kTooMany;
        ray.origin = hit_point - tracer_.self_intersection_offset_ * normal;
    } else {
        attenuate(surface, surface.specular, probabilities.specular, energy);
        ++path.specular_bounces;
        ray.origin = point.from;
        ray.direction = renormalised(ray.direction - 2.0 * along * triangle.normal);
        if (path.reflections_of_image < kMaxTestedReflections) {
            path.mirrors[static_cast<std::size_t>(path.reflections_of_image)] = hit.triangle;
        }
        ++path.reflections_of_image;
        path.scattering_normal -=
            2.0 * glm::dot(path.scattering_normal, triangle.normal) * triangle.normal;
    }
    origin_triangles_[i] = hit.triangle;
    if (path.travelled > tracer_.max_distance_) {
        add(1.0, energy, balance_.remaining.data());
        return false;
    }
    return survives_roulette(random.roulette, path, energy);
}

/// Sends a ray on from a surface after Lambert; `cosine` is that of its arrival.
template <std::size_t kBands>
void RayBatch<kBands>::scatter(std::size_t i,
                               const SurfacePoint& point,
                               double cosine,
                               std::uint64_t bits) {
    Path& path = paths_[i];
    path.start_density = single_scattering_density(path, cosine);
    path.scattered_before = true;
    rays_[i] = {point.from, lambert_direction(point.normal, bits)};
    path.image_distance = 0.0;
    path.reflections_of_image = 0;
    path.scattering_normal = point.normal;
    path.scattering_cosine = glm::dot(rays_[i].direction, point.normal);
}

/// Path::start_density of a path that is scattered here.
template <std::size_t kBands>
double RayBatch<kBands>::single_scattering_density(const Path& path, double cosine) const {
    return path.scattered_before ? 0.0 : cosine / (path.travelled * path.travelled);
}

/// Precondition: fewer secondary sources than rays.
template <std::size_t kBands>
void RayBatch<kBands>::add_secondary_source(const SurfacePoint& point,
                                            const Path& path,
                                            double cosine,
                                            const RaySurface& surface,
                                            double weight,
                                            const Energies& energy) {
    SecondarySource& secondary = secondary_sources_[secondary_source_count_++];
    secondary.point = point;
    secondary.id = path.id;
    secondary.start = path.start;
    secondary.start_density = single_scattering_density(path, cosine);
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
    double* absorbed = balance_.absorbed.data();
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
        balance_.roulette_surplus[band] += energy[band] - surface.kept[band] * before[band];
    }
}

/// Russian roulette for faint rays.
template <std::size_t kBands>
bool RayBatch<kBands>::survives_roulette(const RandomStream& random,
                                         const Path& path,
                                         Energies& energy) {
    if (!tracer_.window_.empty()) {
        const double probability = weight_in_window(path, energy);
        if (probability >= 1.0) {
            return true;
        }
        if (random.at(path.id) >= probability) {
            add(1.0, energy, balance_.remaining.data());
            return false;
        }
        survive(probability, energy);
        return true;
    }
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
        add(1.0, energy, balance_.remaining.data());
        return false;
    }
    survive(kSurvivalProbability, energy);
    return true;
}

/// A ray that survives carries the energy of those that did not.
template <std::size_t kBands>
void RayBatch<kBands>::survive(double probability, Energies& energy) {
    for (std::size_t band = 0; band < kBands; ++band) {
        const double scaled = energy[band] / probability;
        balance_.remaining[band] -= scaled - energy[band];
        energy[band] = scaled;
    }
}

namespace {

// All rays of a group fit into the first-level cache.
constexpr std::size_t kGroupSize = 256;

template <std::size_t kBands>
void run_batch(const RayTracer& tracer,
               std::uint64_t first_id,
               std::uint64_t rays,
               const glm::dmat3& rotation,
               std::span<const std::uint8_t> active,
               BatchResult& result) {
    const auto count = static_cast<double>(rays);
    RayBatch<kBands> batch(tracer, 4.0 * math::kPi / count, active, result);
    for (std::uint64_t first = 0; first < rays; first += kGroupSize) {
        for (std::uint64_t i = first; i < std::min(first + kGroupSize, rays); ++i) {
            batch.emit(first_id + i, rotation * spiral_direction(i, count));
        }
        for (std::uint64_t bounce = 0; batch.has_rays(); ++bounce) {
            batch.advance(bounce);
        }
    }
}

template <std::size_t kBands>
void run_reversed_batch(const RayTracer& tracer,
                        const ReversedRays& reversed,
                        std::span<const NearScattering> places,
                        double energy,
                        double scattered_energy,
                        BatchResult& result) {
    EnergyBalance unused;  // that of the source is of its own rays
    RayBatch<kBands> batch(tracer, scattered_energy, reversed, result, unused);
    for (std::size_t first = 0; first < places.size(); first += kGroupSize) {
        batch.scatter_near(places.subspan(first, std::min(kGroupSize, places.size() - first)),
                           energy);
        for (std::uint64_t bounce = 1; batch.has_rays(); ++bounce) {
            batch.advance(bounce);
        }
    }
}

constexpr std::size_t kOctaves = 10;
constexpr std::size_t kThirds = 31;
// Batches of reversed rays are numbered from here, so that they draw numbers of their own.
constexpr std::uint64_t kFirstReversed = std::uint64_t{1} << 40;

}  // namespace

BatchResult RayTracer::trace(std::uint64_t index,
                             std::uint64_t rays,
                             std::span<const std::uint8_t> active) const {
    EARSHOT_ASSERT(bands_ == kOctaves || bands_ == kThirds);
    BatchResult result;
    result.energy.assign(receivers_.size() * bins_ * bands_, 0.0);
    if (options_.report_directions) {
        result.directions.assign(
            receivers_.size() * direction_intervals() * audio::kDirectionParts * bands_, 0.0);
    }
    if (options_.report_materials) {
        result.materials = empty_materials();
    }
    const std::uint64_t first_id = index * kMaxBatchRays;
    const glm::dmat3 rotation = random_rotation(options_.seed, 0, index);
    if (bands_ == kOctaves) {
        run_batch<kOctaves>(*this, first_id, rays, rotation, active, result);
    } else {
        run_batch<kThirds>(*this, first_id, rays, rotation, active, result);
    }
    for (std::size_t k = 0; k < receivers_.size(); ++k) {
        if (active[k] != 0 && receivers_[k].near_scattering > 0.0) {
            trace_reversed(k, index, rays, result);
        }
    }
    return result;
}

/// What surfaces near a listener scatter to it, by rays from the listener. They are as many as make
/// about the error of the other rays.
void RayTracer::trace_reversed(std::size_t listener,
                               std::uint64_t index,
                               std::uint64_t rays,
                               BatchResult& result) const {
    const Receiver& receiver = receivers_[listener];
    // Fewer where splitting makes each of them tell more.
    constexpr double kShareInWindow = 0.25;
    const double share = window_.empty() ? 1.0 : kShareInWindow;
    const double count = std::ceil(static_cast<double>(rays) * receiver.near_scattering * share);
    const glm::dmat3 rotation = random_rotation(options_.seed, 0, kFirstReversed + index);
    std::vector<Vec3> directions(static_cast<std::size_t>(count));
    std::vector<Ray> legs(directions.size());
    for (std::size_t i = 0; i < directions.size(); ++i) {
        directions[i] = rotation * spiral_direction(i, count);
        legs[i] = {receiver.position, directions[i]};
    }
    const ReversedRays reversed = {.listener = listener,
                                   .first_id = (kFirstReversed + index) * kMaxBatchRays,
                                   .directions = directions};
    const std::vector<NearScattering> places = find_near_scattering(
        receiver.position, directions, scene_.bvh.closest_hits(legs), reversed.first_id);
    const double energy = 4.0 * math::kPi / count;
    double scattered_energy = 0.0;
    for (const NearScattering& place : places) {
        scattered_energy += energy * place.share / static_cast<double>(places.size());
    }
    if (bands_ == kOctaves) {
        run_reversed_batch<kOctaves>(*this, reversed, places, energy, scattered_energy, result);
    } else {
        run_reversed_batch<kThirds>(*this, reversed, places, energy, scattered_energy, result);
    }
}

}  // namespace earshot::propagation
