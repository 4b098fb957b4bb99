// SPDX-License-Identifier: MIT
#include "earshot/propagation/internal/ray_tracer.h"

#include "earshot/base/math.h"
#include "earshot/bvh/closest_point.h"
#include "earshot/bvh/wide_batch.h"
#include "earshot/propagation/internal/spiral.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

namespace earshot::propagation {

using geometry::Ray;
using geometry::Vec3;

namespace {

// Reflected and shadow rays start this far from a surface, re the extent of the scene: above the
// rounding error of a hit, far below a wavelength.
constexpr double kSelfIntersectionOffset = 0x1p-32;

/// Sets the probabilities of a surface, which follow from its shares.
void set_probabilities(RaySurface& surface) {
    double total = 0.0;
    for (std::size_t band = 0; band < surface.kept.size(); ++band) {
        surface.kept[band] =
            surface.specular[band] + surface.scattered[band] + surface.transmitted[band];
        if (surface.kept[band] > total) {
            total = surface.kept[band];
            surface.scattering_probability = surface.scattered[band] / total;
            surface.transmission_probability = surface.transmitted[band] / total;
        }
    }
    surface.rain_probability = std::sqrt(surface.scattering_probability);
    surface.uniform_split = total > 0.0;
    for (std::size_t band = 0; band < surface.kept.size(); ++band) {
        // A few roundings, which the balance of energy does not feel.
        constexpr double kRounding = 0x1p-50;
        const auto is_share = [&](double part, double probability) {
            return std::abs(part - probability * surface.kept[band]) <=
                   kRounding * surface.kept[band];
        };
        surface.uniform_split =
            surface.uniform_split &&
            is_share(surface.scattered[band], surface.scattering_probability) &&
            is_share(surface.transmitted[band], surface.transmission_probability);
    }
}

}  // namespace

RayTracer::RayTracer(const RayScene& scene,
                     const RaySource& source,
                     std::span<const Vec3> listeners,
                     const RayOptions& options,
                     Executor& executor)
    : scene_(scene),
      source_(source),
      options_(options),
      wide_(bvh::WideTree::build(scene.tree, scene.mesh, executor)),
      bands_(options.bands.count()),
      max_distance_(speed_of_sound(options.air) * options.length),
      bins_per_metre_(1.0 / (speed_of_sound(options.air) * options.bin)),
      bins_(static_cast<std::size_t>(std::ceil(options.length / options.bin))),
      self_intersection_offset_(kSelfIntersectionOffset *
                                (wide_.max_abs_coordinate() + glm::length(source.pose.position))) {
    describe_surfaces();
    describe_triangles();
    describe_receivers(listeners, executor);
    find_direct_scattering(executor);
    limit_roulette();
}

// A ball about each listener, and the surfaces near it.
void RayTracer::describe_receivers(std::span<const Vec3> listeners, Executor& executor) {
    const double radius = options_.receiver_radius;
    const bool any_scatters =
        std::any_of(surfaces_.begin(), surfaces_.end(), [](const RaySurface& surface) {
            return *std::max_element(surface.scattered.begin(), surface.scattered.end()) > 0.0;
        });
    receivers_.resize(listeners.size());
    executor.for_each(listeners.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
            Receiver& receiver = receivers_[k];
            receiver.position = listeners[k];
            receiver.radius_squared = radius * radius;
            if (!bvh::closest_point(
                    scene_.tree, scene_.mesh, listeners[k], std::max(radius, kNearDistance))) {
                receiver.inverse_volume = 0.75 / (math::kPi * radius * radius * radius);
                continue;
            }
            std::vector<Ray> probes;
            for (std::size_t i = 0; i < kProbeDirections; ++i) {
                probes.push_back({listeners[k], probe_direction(i)});
            }
            const auto hits = bvh::closest_hits(wide_, scene_.mesh, probes);
            double cubes = 0.0;
            for (const auto& hit : hits) {
                const double seen = hit ? std::min(hit->t, radius) : radius;
                cubes += seen * seen * seen;
            }
            receiver.inverse_volume =
                cubes > 0.0 ? kProbeDirections / (4.0 / 3.0 * math::kPi * cubes) : 0.0;
            if (any_scatters) {
                receiver.near_field.emplace(scene_.tree,
                                            wide_,
                                            scene_.mesh,
                                            scene_.material_of_triangle,
                                            surfaces_,
                                            listeners[k],
                                            hits,
                                            self_intersection_offset_);
            }
        }
    });
    index_near_fields();
}

// Which near fields a triangle belongs to; no index where there are none.
void RayTracer::index_near_fields() {
    std::vector<std::pair<geometry::TriangleId, std::uint32_t>> members;
    for (std::uint32_t k = 0; k < receivers_.size(); ++k) {
        if (receivers_[k].near_field) {
            for (const geometry::TriangleId triangle : receivers_[k].near_field->triangles()) {
                members.emplace_back(triangle, k);
            }
        }
    }
    if (members.empty()) {
        return;
    }
    std::sort(members.begin(), members.end());
    first_near_receiver_.assign(scene_.mesh.triangles.size() + 1, 0);
    for (const auto& [triangle, listener] : members) {
        ++first_near_receiver_[triangle + 1];
        near_receivers_.push_back(listener);
    }
    std::partial_sum(
        first_near_receiver_.begin(), first_near_receiver_.end(), first_near_receiver_.begin());
}

// A ray is faint only compared with the sound that arrives at the same time.
void RayTracer::limit_roulette() {
    constexpr std::size_t kSteps = 256;
    constexpr double kMinThreshold = 1e-7;
    // Where this begins costs a third of the time less than kMinThreshold alone, and leaves the
    // spread of the results as it is.
    constexpr double kShareOfMeanDecay = 0.1;
    roulette_steps_per_metre_ = kSteps / max_distance_;
    for (std::size_t step = 0; step <= kSteps; ++step) {
        const double time = options_.length * static_cast<double>(step) / kSteps;
        const double decayed =
            options_.decay_time > 0.0 ? math::pow10(-6.0 * time / options_.decay_time) : 0.0;
        roulette_thresholds_.push_back(std::max(kMinThreshold, kShareOfMeanDecay * decayed));
    }
}

// The irradiance at what listeners see near them is known: cos / r^2 of the source, if it is
// visible.
void RayTracer::find_direct_scattering(Executor& executor) {
    std::vector<geometry::Segment> shadow_rays;
    const Vec3& source = source_.pose.position;
    for (std::uint32_t k = 0; k < receivers_.size(); ++k) {
        if (!receivers_[k].near_field) {
            continue;
        }
        const NearField& near_field = *receivers_[k].near_field;
        for (const NearView& view : near_field.views()) {
            const Vec3 to_source = source - view.seen.point;
            const double distance = glm::length(to_source);
            const double along = glm::dot(to_source, view.seen.side);
            if (!(along > 0.0)) {
                continue;
            }
            const audio::Spectrum sent = source_.directivity.pressure(
                options_.bands, source_.pose.seen_from(-to_source / distance));
            const audio::Spectrum& scattered =
                surfaces_[scene_.material_of_triangle[view.triangle]].scattered;
            const audio::Spectrum& factor = near_field.reflection_factor(view.seen.reflections);
            const double irradiance = along / (distance * distance * distance);
            DirectScattering direct{.listener = k};
            direct.towards = view.seen.image - receivers_[k].position;
            direct.travelled = distance + glm::length(direct.towards);
            for (std::size_t band = 0; band < bands_; ++band) {
                direct.energy[band] = view.seen.weight * irradiance * (sent[band] * sent[band]) *
                                      (scattered[band] * factor[band]);
            }
            shadow_rays.push_back(
                {view.seen.point + self_intersection_offset_ * view.seen.side, source});
            direct_scattering_.push_back(direct);
        }
    }
    const std::vector<std::uint8_t> occluded =
        bvh::occluded(wide_, scene_.mesh, shadow_rays, executor);
    std::size_t kept = 0;
    for (std::size_t i = 0; i < direct_scattering_.size(); ++i) {
        if (occluded[i] == 0) {
            direct_scattering_[kept++] = direct_scattering_[i];
        }
    }
    direct_scattering_.resize(kept);
}

void RayTracer::describe_surfaces() {
    for (const Material& material : scene_.materials) {
        const audio::Spectrum absorption = material.absorption.over(options_.bands);
        const audio::Spectrum scattering = material.scattering.over(options_.bands);
        const audio::Spectrum transmission = transmitted_energy(material, options_.bands);
        RaySurface& surface = surfaces_.emplace_back();
        surface.one_sided = material.one_sided;
        for (std::size_t band = 0; band < bands_; ++band) {
            const double kept = 1.0 - absorption[band];
            // Transmitted energy is a part of the energy that is not reflected.
            const double transmitted = options_.transmission ? transmission[band] : 0.0;
            surface.specular[band] = kept * (1.0 - scattering[band]);
            surface.scattered[band] = kept * scattering[band];
            surface.transmitted[band] = transmitted;
            surface.absorbed[band] = absorption[band] - transmitted;
        }
        set_probabilities(surface);
    }
}

void RayTracer::describe_triangles() {
    triangle_surfaces_.reserve(scene_.mesh.triangles.size());
    for (std::size_t i = 0; i < scene_.mesh.triangles.size(); ++i) {
        const auto [a, b, c] = geometry::corners(scene_.mesh, i);
        triangle_surfaces_.push_back({.normal = glm::normalize(glm::cross(b - a, c - a)),
                                      .surface = scene_.material_of_triangle[i]});
    }
}

std::size_t RayTracer::spans() const noexcept {
    return chunk_count(bins_, audio::kBinsPerSpan);
}

}  // namespace earshot::propagation
