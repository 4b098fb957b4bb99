// SPDX-License-Identifier: MIT
// What receivers record of the rays of a batch: chords of specular legs, diffuse rain, the near
// field of the source.
#include "earshot/base/math.h"
#include "earshot/propagation/internal/ray_batch.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace earshot::propagation {

using geometry::Ray;
using geometry::Vec3;

namespace {

/// Whether an event of that probability happens to a receiver: its number is the event's, moved by
/// the receiver's own offset, so that receivers do not all choose the same events.
bool is_chosen(double probability, double number, double offset) {
    const double sum = number + offset;
    return (sum < 1.0 ? sum : sum - 1.0) < probability;
}

}  // namespace

/// The chords of all legs in the balls of the receivers, but of legs that something else records:
/// exact paths, diffuse rain, near fields.
template <std::size_t kBands>
void RayBatch<kBands>::find_chords(const RandomStream& random) {
    chords_.clear();
    shadow_rays_.clear();
    for (std::size_t i = 0; i < rays_.size(); ++i) {
        const Path& path = paths_[i];
        if (path.recorded_by_rain ||
            (!path.scattered_before && path.specular_bounces <= options_.specular_order)) {
            continue;
        }
        const double hit_distance =
            hits_[i] ? hits_[i]->t : std::numeric_limits<double>::infinity();
        // The same number for all listeners, so that the answer of one depends on no other.
        const double number = random.at(path.id);
        const auto find = [&](std::size_t k) {
            if (is_active(k)) {
                find_chord(i, k, hit_distance, number);
            }
        };
        if (reversed_) {
            find(0);
        } else {
            tracer_.receiver_tree_.visit(rays_[i], hit_distance, find);
        }
    }
}

/// A chord counts by its length over the volume of the ball that the listener sees, if the listener
/// sees a random point of it. The image is as far away as it is from the listener, and its energy
/// arrives at one instant: what the ball adds is neither bias nor blur, only rays.
template <std::size_t kBands>
void RayBatch<kBands>::find_chord(std::size_t i,
                                  std::size_t receiver_index,
                                  double hit_distance,
                                  double random) {
    const Receiver& receiver = receivers_[receiver_index];
    const Ray& ray = rays_[i];
    const Path& path = paths_[i];
    const ReceiverBall& ball = path.scattered_before ? receiver.scattered_ball : receiver.ball;
    const Vec3 to = receiver.position - ray.origin;
    const double along = glm::dot(to, ray.direction);
    const double half_squared = ball.radius_squared - (glm::dot(to, to) - along * along);
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
    double weight = 1.0;
    if (path.scattered_before) {
        const double cosine = glm::dot(from_image, path.scattering_normal) / distance;
        if (!(cosine > 0.0)) {
            return;
        }
        weight = cosine / path.scattering_cosine *
                 estimator_weight(
                     receiver, distance, cosine, path.reflections_of_image, path.start_density);
        if (weight == 0.0) {
            return;
        }
    }
    const double at = begin + random * (end - begin);
    const double image_to_point = path.image_distance + at;
    shadow_rays_.push_back({ray.origin + at * ray.direction, receiver.position});
    chords_.push_back({.ray = i,
                       .receiver = receiver_index,
                       .travelled = path.travelled - path.image_distance + distance,
                       .towards = -from_image,
                       .share = (end - begin) * ball.inverse_volume *
                                (image_to_point * image_to_point / squared) * weight});
}

template <std::size_t kBands>
void RayBatch<kBands>::record_chords(const RandomStream& trials) {
    occluded_.resize(shadow_rays_.size());
    scene_.bvh.occluded(shadow_rays_, occluded_);
    for (std::size_t j = 0; j < chords_.size(); ++j) {
        if (occluded_[j] == 0) {
            const Chord& chord = chords_[j];
            record(chord.receiver,
                   paths_[chord.ray].start,
                   chord.travelled,
                   chord.towards,
                   energies_[chord.ray],
                   chord.share * image_weight(chord, trials),
                   reflections_of(chord.ray));
        }
    }
}

/// The correction for parts of the ball that do not see the image. Images of points that scatter,
/// and chains of many reflections, go without: there, images are many, each with its own part of
/// the ball, and the correction is noisier than the bias.
template <std::size_t kBands>
double RayBatch<kBands>::image_weight(const Chord& chord, const RandomStream& trials) const {
    const Receiver& receiver = receivers_[chord.receiver];
    const Path& path = paths_[chord.ray];
    if (receiver.ball_points.empty() || path.scattered_before ||
        path.reflections_of_image > kMaxTestedReflections) {
        return 1.0;
    }
    const Ray& ray = rays_[chord.ray];
    const ImageChain chain{
        .image = ray.origin - path.image_distance * ray.direction,
        .mirrors =
            std::span(path.mirrors).first(static_cast<std::size_t>(path.reflections_of_image)),
        .surfaces = surfaces_};
    return tracer_.image_weight(receiver, chain, trials.bits(path.id));
}

/// The share of a path that was scattered at a point which the receiver hears from `distance`, past
/// `reflections`, by the estimator of these rays. Paths from near a listener have two estimators:
/// rays from the source, whose variance grows without bound as the point comes nearer, and reversed
/// rays. Where the point is the only one that scatters, both have bounded variance in other cases:
/// their weights are those of the balance heuristic (Veach and Guibas 1995), from the densities of
/// the point on either side, so that the result is bounded wherever one of the two is.
template <std::size_t kBands>
double RayBatch<kBands>::estimator_weight(const Receiver& receiver,
                                          double distance,
                                          double cosine,
                                          int reflections,
                                          double start_density) const {
    const double density = cosine / (distance * distance);
    const bool is_near = distance < kNearDistance && reflections <= kMaxNearReflections;
    if (!reversed_) {
        return is_near && receiver.near_scattering > 0.0 ? start_density / (start_density + density)
                                                         : 1.0;
    }
    if (start_density > 0.0) {
        return start_density / (start_density + density);
    }
    return is_near && tracer_.source_field_ ? 0.0 : 1.0;
}

/// Scattered energy of a surface near the source, for reversed rays. What is scattered only there
/// was recorded where these rays were scattered first.
template <std::size_t kBands>
void RayBatch<kBands>::record_near_field(std::size_t i,
                                         const RaySurface& surface,
                                         const Vec3& hit_point,
                                         const Vec3& normal) {
    const NearField& field = *tracer_.source_field_;
    for (const NearContribution& near : field.contributions(*hits_[i])) {
        if (!(glm::dot(near.side, normal) > 0.0)) {
            continue;
        }
        const audio::Spectrum& factor = field.reflection_factor(near.reflections);
        Energies scattered;
        for (std::size_t band = 0; band < kBands; ++band) {
            scattered[band] = factor[band] * (surface.scattered[band] * energies_[i][band]);
        }
        // A plane wave in the direction of the ray reaches the point seen by so much later.
        const double later = glm::dot(rays_[i].direction, near.point - hit_point);
        const Vec3 towards = near.image - receivers_[0].position;
        if (materials_ > 0) {
            near_reflections_.assign(reflections_of(i), reflections_of(i) + counts_);
            count_reflection(tracer_.triangle_surfaces_[hits_[i]->triangle].front / 2,
                             true,
                             near_reflections_.data());
            for (const std::uint32_t material : field.reflection_materials(near.reflections)) {
                count_reflection(material, false, near_reflections_.data());
            }
        }
        record(0,
               paths_[i].start,
               paths_[i].travelled + later + glm::length(towards),
               towards,
               scattered,
               near.weight,
               near_reflections_.data());
    }
}

template <std::size_t kBands>
void RayBatch<kBands>::record(std::size_t receiver,
                              std::uint32_t start,
                              double travelled,
                              const Vec3& towards,
                              const Energies& energy,
                              double share,
                              const std::uint32_t* reflections) {
    if (!reversed_) {
        record_at_listener(receiver, travelled, towards, energy, share, reflections);
        return;
    }
    // Sound leaves the source where the reversed ray arrives, and arrives where that one started.
    const Vec3& direction = reversed_->directions[start];
    const RaySource& source = tracer_.source_;
    if (source.directivity.is_omnidirectional()) {
        record_at_listener(reversed_->listener, travelled, direction, energy, share, reflections);
        return;
    }
    const audio::Spectrum pressure =
        source.directivity.pressure(options_.bands, source.pose.seen_from(glm::normalize(towards)));
    Energies emitted;
    for (std::size_t band = 0; band < kBands; ++band) {
        emitted[band] = energy[band] * (pressure[band] * pressure[band]);
    }
    record_at_listener(reversed_->listener, travelled, direction, emitted, share, reflections);
}

template <std::size_t kBands>
void RayBatch<kBands>::record_at_listener(std::size_t listener,
                                          double travelled,
                                          const Vec3& towards,
                                          const Energies& energy,
                                          double share,
                                          const std::uint32_t* reflections) {
    const double position = travelled * tracer_.bins_per_metre_;
    if (!(position < static_cast<double>(tracer_.bins_))) {
        return;
    }
    const auto bin = static_cast<std::size_t>(std::max(0.0, position));
    add(share, energy, result_.energy.data() + (listener * tracer_.bins_ + bin) * kBands);
    if (materials_ > 0) {
        record_materials(listener, bin, energy, share, reflections);
    }
    if (result_.directions.empty()) {
        return;
    }
    const std::size_t part = audio::direction_part({towards.x, towards.y, towards.z});
    const std::size_t interval =
        listener * tracer_.direction_intervals() + bin / audio::kBinsPerSpan;
    add(share,
        energy,
        result_.directions.data() + (interval * audio::kDirectionParts + part) * kBands);
}

/// Russian roulette for receivers that a secondary source reaches with less than those at the
/// radius of the options, in front of it: the share of their solid angle. 1 for nearer ones.
/// `along`: the distance in front of the surface.
template <std::size_t kBands>
double RayBatch<kBands>::rain_probability(double along, double squared_distance) const {
    const double radius = options_.rain_radius;
    const double solid_angles = radius * radius * along;
    const double distance = std::sqrt(squared_distance);
    return solid_angles < squared_distance * distance ? solid_angles / (squared_distance * distance)
                                                      : 1.0;
}

/// Adds scattered energy to every receiver that is visible from where it was scattered (Heinz
/// 1993).
template <std::size_t kBands>
void RayBatch<kBands>::cast_diffuse_rain(const RandomStream& random) {
    shadow_rays_.clear();
    shadow_ray_origins_.clear();
    rain_.clear();
    for (std::size_t i = 0; i < secondary_source_count_; ++i) {
        const SurfacePoint& point = secondary_sources_[i].point;
        const double number = reversed_ ? 0.0 : random.at(secondary_sources_[i].id);
        for (std::size_t k = 0; k < receivers_.size(); ++k) {
            const Vec3 to_receiver = receivers_[k].position - point.from;
            const double along = glm::dot(to_receiver, point.normal);
            if (!is_active(k) || !(along > 0.0)) {
                continue;
            }
            const double probability =
                reversed_ ? 1.0 : rain_probability(along, glm::dot(to_receiver, to_receiver));
            if (probability < 1.0 && !is_chosen(probability, number, receivers_[k].rain_offset)) {
                continue;
            }
            double weight = 1.0 / probability;
            if (reversed_ || receivers_[k].near_scattering > 0.0) {
                const double distance = glm::length(to_receiver);
                weight *= estimator_weight(receivers_[k],
                                           distance,
                                           along / distance,
                                           0,
                                           secondary_sources_[i].start_density);
            }
            if (weight > 0.0) {
                shadow_rays_.push_back({point.from, receivers_[k].position});
                shadow_ray_origins_.push_back(point.triangle);
                rain_.push_back({.source = i, .receiver = k, .weight = weight});
            }
        }
    }
    occluded_.resize(shadow_rays_.size());
    scene_.bvh.occluded(
        bvh::SecondarySegments{.segments = shadow_rays_, .origin_triangles = shadow_ray_origins_},
        occluded_);
    for (std::size_t j = 0; j < shadow_rays_.size(); ++j) {
        if (occluded_[j] != 0) {
            continue;
        }
        const SecondarySource& secondary = secondary_sources_[rain_[j].source];
        const Vec3 to_receiver = shadow_rays_[j].to - shadow_rays_[j].from;
        const double squared = glm::dot(to_receiver, to_receiver);
        const double distance = std::sqrt(squared);
        record(rain_[j].receiver,
               secondary.start,
               secondary.point.travelled + distance,
               -to_receiver,
               secondary.energy,
               rain_[j].weight * glm::dot(to_receiver, secondary.point.normal) /
                   (math::kPi * squared * distance),
               rain_reflections_.data() + rain_[j].source * counts_);
    }
}

// Octaves and thirds.
template void RayBatch<10>::find_chords(const RandomStream&);
template void RayBatch<10>::record_chords(const RandomStream&);
template void RayBatch<10>::record_near_field(std::size_t,
                                              const RaySurface&,
                                              const Vec3&,
                                              const Vec3&);
template void RayBatch<10>::cast_diffuse_rain(const RandomStream&);
template void RayBatch<31>::find_chords(const RandomStream&);
template void RayBatch<31>::record_chords(const RandomStream&);
template void RayBatch<31>::record_near_field(std::size_t,
                                              const RaySurface&,
                                              const Vec3&,
                                              const Vec3&);
template void RayBatch<31>::cast_diffuse_rain(const RandomStream&);

}  // namespace earshot::propagation
