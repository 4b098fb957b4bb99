// SPDX-License-Identifier: MIT
// What listeners receive of the rays of a batch: chords of specular legs, diffuse rain, near
// fields.
#include "earshot/base/math.h"
#include "earshot/bvh/wide_batch.h"
#include "earshot/propagation/internal/ray_batch.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace earshot::propagation {

using geometry::Ray;
using geometry::Vec3;

/// The chords of all legs in the balls of the listeners, but of legs that something else records:
/// exact paths, diffuse rain, near fields.
template <std::size_t kBands>
void RayBatch<kBands>::find_chords(const RandomStream& random) {
    chords_.clear();
    shadow_rays_.clear();
    for (std::size_t i = 0; i < rays_.size(); ++i) {
        const Path& path = paths_[i];
        if (path.rain_cast ||
            (!path.scattered_before && path.specular_bounces <= options_.specular_order)) {
            continue;
        }
        const double hit_distance =
            hits_[i] ? hits_[i]->t : std::numeric_limits<double>::infinity();
        for (std::size_t k = 0; k < tracer_.receivers_.size(); ++k) {
            // The same number for all listeners, so that the answer of one depends on no other.
            find_chord(i, k, hit_distance, random.at(path.id));
        }
    }
}

/// A chord counts by its length over the volume of the ball that the listener sees, if the listener
/// sees a random point of it. The image is as far away as it is from the listener, and its energy
/// arrives at one instant: what the ball adds is neither bias nor blur, only rays.
template <std::size_t kBands>
void RayBatch<kBands>::find_chord(std::size_t i,
                                  std::size_t listener,
                                  double hit_distance,
                                  double random) {
    const Receiver& receiver = tracer_.receivers_[listener];
    const Ray& ray = rays_[i];
    const Path& path = paths_[i];
    const Vec3 to = receiver.position - ray.origin;
    const double along = glm::dot(to, ray.direction);
    const double half_squared = receiver.radius_squared - (glm::dot(to, to) - along * along);
    if (!(half_squared > 0.0)) {
        return;
    }
    const double half = std::sqrt(half_squared);
    const double begin = std::max(0.0, along - half);
    const double end = std::min(hit_distance, along + half);
    if (!(begin < end)) {
        return;
    }
    const Vec3 from_image = to + path.image_distance * ray.direction;
    const double squared = glm::dot(from_image, from_image);
    const double distance = std::sqrt(squared);
    double cosines = 1.0;
    if (path.scattered_before) {
        const bool is_near = distance < kNearDistance &&
                             path.reflections_of_image <= kMaxNearReflections &&
                             receiver.near_field && !receiver.near_field->is_empty();
        const double cosine = glm::dot(from_image, path.scattering_normal) / distance;
        if (is_near || !(cosine > 0.0)) {
            return;
        }
        cosines = cosine / path.scattering_cosine;
    }
    const double at = begin + random * (end - begin);
    const double image_to_point = path.image_distance + at;
    shadow_rays_.push_back({ray.origin + at * ray.direction, receiver.position});
    chords_.push_back({.ray = i,
                       .listener = listener,
                       .travelled = path.travelled - path.image_distance + distance,
                       .towards = -from_image,
                       .share = (end - begin) * receiver.inverse_volume *
                                (image_to_point * image_to_point / squared) * cosines});
}

template <std::size_t kBands>
void RayBatch<kBands>::record_chords() {
    occluded_.resize(shadow_rays_.size());
    bvh::occluded(tracer_.wide_, scene_.mesh, shadow_rays_, occluded_);
    for (std::size_t j = 0; j < chords_.size(); ++j) {
        if (occluded_[j] == 0) {
            const Chord& chord = chords_[j];
            record(
                chord.listener, chord.travelled, chord.towards, energies_[chord.ray], chord.share);
        }
    }
}

/// Sound of the source itself that surfaces near listeners scatter, in the whole.
template <std::size_t kBands>
void RayBatch<kBands>::record_direct_scattering() {
    for (const RayTracer::DirectScattering& direct : tracer_.direct_scattering_) {
        Energies energy;
        std::copy_n(direct.energy.begin(), kBands, energy.begin());
        record(direct.listener, direct.travelled, direct.towards, energy, 1.0);
    }
}

/// Scattered energy of a surface near listeners.
template <std::size_t kBands>
void RayBatch<kBands>::record_near_field(std::size_t i, const Vec3& hit_point, const Vec3& normal) {
    if (tracer_.first_near_receiver_.empty()) {
        return;
    }
    const geometry::Hit& hit = *hits_[i];
    const std::uint32_t end = tracer_.first_near_receiver_[hit.triangle + 1];
    for (std::uint32_t n = tracer_.first_near_receiver_[hit.triangle]; n < end; ++n) {
        const std::uint32_t listener = tracer_.near_receivers_[n];
        const Receiver& receiver = tracer_.receivers_[listener];
        const RaySurface& surface =
            tracer_.surfaces_[tracer_.triangle_surfaces_[hit.triangle].surface];
        for (const NearContribution& near : receiver.near_field->contributions(hit)) {
            if (!(glm::dot(near.side, normal) > 0.0)) {
                continue;
            }
            const audio::Spectrum& factor =
                receiver.near_field->reflection_factor(near.reflections);
            Energies scattered;
            for (std::size_t band = 0; band < kBands; ++band) {
                scattered[band] = factor[band] * (surface.scattered[band] * energies_[i][band]);
            }
            // A plane wave in the direction of the ray reaches the point seen by so much later.
            const double later = glm::dot(rays_[i].direction, near.point - hit_point);
            const Vec3 towards = near.image - receiver.position;
            record(listener,
                   paths_[i].travelled + later + glm::length(towards),
                   towards,
                   scattered,
                   near.weight);
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
    const auto bin = static_cast<std::size_t>(std::max(0.0, position));
    add(share, energy, tally_.energy.data() + (listener * tracer_.bins_ + bin) * kBands);
    if (tally_.directions.empty()) {
        return;
    }
    const std::size_t part = audio::direction_part({towards.x, towards.y, towards.z});
    const std::size_t span = listener * tracer_.spans() + bin / audio::kBinsPerSpan;
    add(share, energy, tally_.directions.data() + (span * audio::kDirectionParts + part) * kBands);
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
            const Vec3 to_listener = listener - point.from;
            const auto& near_field = tracer_.receivers_[k].near_field;
            const bool is_near = near_field && !near_field->is_empty() &&
                                 glm::dot(to_listener, to_listener) < kNearDistance * kNearDistance;
            if (!is_near && glm::dot(to_listener, point.normal) > 0.0) {
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

// Octaves and thirds.
template void RayBatch<10>::find_chords(const RandomStream&);
template void RayBatch<10>::record_chords();
template void RayBatch<10>::record_direct_scattering();
template void RayBatch<10>::record_near_field(std::size_t, const Vec3&, const Vec3&);
template void RayBatch<10>::cast_diffuse_rain();
template void RayBatch<31>::find_chords(const RandomStream&);
template void RayBatch<31>::record_chords();
template void RayBatch<31>::record_direct_scattering();
template void RayBatch<31>::record_near_field(std::size_t, const Vec3&, const Vec3&);
template void RayBatch<31>::cast_diffuse_rain();

}  // namespace earshot::propagation
