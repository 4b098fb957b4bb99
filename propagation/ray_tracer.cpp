// SPDX-License-Identifier: MIT
#include "earshot/propagation/internal/ray_tracer.h"

#include "earshot/base/math.h"
#include "earshot/base/random.h"
#include "earshot/bvh/closest_point.h"
#include "earshot/bvh/wide_batch.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace earshot::propagation {

using geometry::Ray;
using geometry::Vec3;

namespace {

constexpr double kGoldenRatio = 1.618033988749895;

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
    const double max_radius =
        options.receiver_radius > 0.0 ? options.receiver_radius : default_radius();
    for (const Vec3& listener : listeners) {
        const auto closest = bvh::closest_point(scene.tree, scene.mesh, listener, max_radius);
        const double radius =
            closest ? std::max(closest->distance, self_intersection_offset_) : max_radius;
        receivers_.push_back({.position = listener,
                              .radius_squared = radius * radius,
                              .inverse_volume = 0.75 / (math::kPi * radius * radius * radius)});
    }
}

double RayTracer::default_radius() const {
    constexpr std::size_t kProbes = 256;
    constexpr double kShareOfEdge = 0.06;
    std::vector<Ray> probes;
    for (std::size_t i = 0; i < kProbes; ++i) {
        probes.push_back({source_.pose.position, direction_of(i, kProbes)});
    }
    double cubes = 0.0;
    for (const auto& hit : bvh::closest_hits(wide_, scene_.mesh, probes)) {
        cubes += hit ? hit->t * hit->t * hit->t : 0.0;
    }
    const double volume = 4.0 / 3.0 * math::kPi * cubes / kProbes;
    return std::clamp(kShareOfEdge * math::pow(volume, 1.0 / 3.0), 0.5, 2.0);
}

void RayTracer::describe_surfaces() {
    for (const Material& material : scene_.materials) {
        const audio::Spectrum absorption = material.absorption.over(options_.bands);
        const audio::Spectrum scattering = material.scattering.over(options_.bands);
        const audio::Spectrum transmission = material.transmission.over(options_.bands);
        RaySurface& surface = surfaces_.emplace_back();
        surface.one_sided = material.one_sided;
        for (std::size_t band = 0; band < bands_; ++band) {
            const double kept = 1.0 - absorption[band];
            // Transmitted energy is a part of the energy that is not reflected.
            const double transmitted =
                options_.transmission ? std::min(transmission[band], absorption[band]) : 0.0;
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

// On a spiral that covers the sphere evenly, turned by the seed.
Vec3 RayTracer::direction_of(std::uint64_t id, double count) const {
    const double z = 1.0 - (2.0 * static_cast<double>(id) + 1.0) / count;
    const double turns = static_cast<double>(id) / kGoldenRatio + random(options_.seed, 0, 0);
    const double angle = 2.0 * math::kPi * (turns - std::floor(turns));
    const double r = std::sqrt(std::max(0.0, 1.0 - z * z));
    return {r * math::cos(angle), r * math::sin(angle), z};
}

}  // namespace earshot::propagation
