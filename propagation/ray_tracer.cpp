// SPDX-License-Identifier: MIT
#include "earshot/propagation/internal/ray_tracer.h"

#include "earshot/base/math.h"
#include "earshot/base/random.h"
#include "earshot/bvh/closest_point.h"
#include "earshot/bvh/wide_batch.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace earshot::propagation {

using geometry::Ray;
using geometry::Vec3;

namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kGoldenRatio = 1.618033988749895;

// New rays and rain start so far from a surface, as a share of the scene: more than the rounding of
// a hit, less than anything that is heard.
constexpr double kLift = 0x1p-32;

/// Sets what follows from the shares alone.
void set_chances(RaySurface& surface) {
    double total = 0.0;
    for (std::size_t band = 0; band < surface.kept.size(); ++band) {
        surface.kept[band] =
            surface.mirrored[band] + surface.scattered[band] + surface.through[band];
        if (surface.kept[band] > total) {
            total = surface.kept[band];
            surface.chance_scattered = surface.scattered[band] / total;
            surface.chance_through = surface.through[band] / total;
        }
    }
    surface.chance_heard = std::sqrt(surface.chance_scattered);
    surface.is_even = total > 0.0;
    for (std::size_t band = 0; band < surface.kept.size(); ++band) {
        // A few roundings, which the balance of energy does not feel.
        constexpr double kRounding = 0x1p-50;
        const auto is_share = [&](double part, double chance) {
            return std::abs(part - chance * surface.kept[band]) <= kRounding * surface.kept[band];
        };
        surface.is_even = surface.is_even &&
                          is_share(surface.scattered[band], surface.chance_scattered) &&
                          is_share(surface.through[band], surface.chance_through);
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
      reach_(speed_of_sound(options.air) * options.length),
      bins_per_metre_(1.0 / (speed_of_sound(options.air) * options.bin)),
      bins_(static_cast<std::size_t>(std::ceil(options.length / options.bin))),
      lift_(kLift * (wide_.max_abs_coordinate() + glm::length(source.pose.position))) {
    describe_surfaces();
    describe_walls();
    const double widest =
        options.receiver_radius > 0.0 ? options.receiver_radius : radius_for_space();
    for (const Vec3& listener : listeners) {
        const auto nearest = bvh::closest_point(scene.tree, scene.mesh, listener, widest);
        const double radius = nearest ? std::max(nearest->distance, lift_) : widest;
        ears_.push_back({.position = listener,
                         .radius_squared = radius * radius,
                         .inverse_volume = 0.75 / (kPi * radius * radius * radius)});
    }
}

double RayTracer::radius_for_space() const {
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
    const double volume = 4.0 / 3.0 * kPi * cubes / kProbes;
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
            // What goes through is a part of what does not come back.
            const double through =
                options_.transmission ? std::min(transmission[band], absorption[band]) : 0.0;
            surface.mirrored[band] = kept * (1.0 - scattering[band]);
            surface.scattered[band] = kept * scattering[band];
            surface.through[band] = through;
            surface.absorbed[band] = absorption[band] - through;
        }
        set_chances(surface);
    }
}

void RayTracer::describe_walls() {
    walls_.reserve(scene_.mesh.triangles.size());
    for (std::size_t i = 0; i < scene_.mesh.triangles.size(); ++i) {
        const geometry::Triangle& triangle = scene_.mesh.triangles[i];
        const Vec3& a = scene_.mesh.positions[triangle[0]];
        walls_.push_back(
            {.normal = glm::normalize(glm::cross(scene_.mesh.positions[triangle[1]] - a,
                                                 scene_.mesh.positions[triangle[2]] - a)),
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
    const double angle = 2.0 * kPi * (turns - std::floor(turns));
    const double r = std::sqrt(std::max(0.0, 1.0 - z * z));
    return {r * math::cos(angle), r * math::sin(angle), z};
}

}  // namespace earshot::propagation
