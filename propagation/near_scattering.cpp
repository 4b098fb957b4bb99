// SPDX-License-Identifier: MIT
// Where rays that start at a listener may be scattered first by a surface near it.
#include "earshot/base/random.h"
#include "earshot/propagation/internal/near_field.h"
#include "earshot/propagation/internal/ray_tracer.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <numeric>
#include <optional>
#include <span>
#include <vector>

namespace earshot::propagation {

using audio::Spectrum;
using geometry::Ray;
using geometry::TriangleId;
using geometry::Vec3;

namespace {

/// A ray from the listener, reflected specularly.
struct SpecularRay {
    std::size_t start = 0;   // index of its direction
    std::size_t choice = 0;  // of its choices
    Ray ray;
    TriangleId origin_triangle = 0;
    double travelled = 0.0;
    Spectrum energy{};  // re the start
    std::array<std::uint32_t, kMaxNearReflections + 1> materials{};
    std::size_t reflections = 0;
};

/// One of the places of a ray, each chosen with the probability of its share of the scattered
/// energy.
struct Choice {
    NearScattering place;
    double chosen = 0.0, all = 0.0;  // scattered energy, sums over bands
};

/// Adds the place that a ray meets to its choice, and reflects it there. `random` is even in 0
/// ... 1.
void add_place(const geometry::Hit& hit,
               const RaySurface& surface,
               double random,
               SpecularRay& ray,
               Choice& choice) {
    ray.travelled += hit.t;
    const double scattered =
        std::inner_product(ray.energy.begin(), ray.energy.end(), surface.scattered.begin(), 0.0);
    choice.all += scattered;
    if (scattered > 0.0 && scattered > choice.all * random) {
        choice.chosen = scattered;
        choice.place = {.start = ray.start,
                        .ray = ray.ray,
                        .hit = hit,
                        .travelled = ray.travelled,
                        .energy = ray.energy,
                        .reflections = ray.reflections};
        std::copy_n(ray.materials.begin(), ray.reflections, choice.place.materials.begin());
    }
    for (std::size_t band = 0; band < ray.energy.size(); ++band) {
        ray.energy[band] *= surface.specular[band];
    }
}

void reflect(const geometry::Hit& hit,
             const Vec3& triangle_normal,
             double offset,
             SpecularRay& ray) {
    const double along = glm::dot(triangle_normal, ray.ray.direction);
    const Vec3 normal = (along > 0.0 ? -1.0 : 1.0) * triangle_normal;
    ray.ray.origin += hit.t * ray.ray.direction + offset * normal;
    ray.ray.direction = glm::normalize(ray.ray.direction - 2.0 * along * triangle_normal);
    ray.origin_triangle = hit.triangle;
}

std::vector<std::optional<geometry::Hit>> closest_hits(const bvh::MeshBvh& bvh,
                                                       std::span<const SpecularRay> reflected) {
    std::vector<Ray> rays;
    std::vector<TriangleId> origin_triangles;
    for (const SpecularRay& ray : reflected) {
        rays.push_back(ray.ray);
        origin_triangles.push_back(ray.origin_triangle);
    }
    std::vector<std::optional<geometry::Hit>> hits(rays.size());
    bvh.closest_hits(bvh::SecondaryRays{.rays = rays, .origin_triangles = origin_triangles}, hits);
    return hits;
}

}  // namespace

const RaySurface& RayTracer::reversed_surface(TriangleId triangle, const Vec3& direction) const {
    const TriangleSurface& surface = triangle_surfaces_[triangle];
    return reversed_surfaces_[surface.front + (glm::dot(surface.normal, direction) > 0.0 ? 1 : 0)];
}

// A ray meets up to kMaxNearReflections + 1 places. It goes on from one of them: each energy is
// divided by the probability of the choice.
std::vector<NearScattering> RayTracer::find_near_scattering(
    const Vec3& from,
    std::span<const Vec3> directions,
    std::span<const std::optional<geometry::Hit>> first_hits,
    std::uint64_t first_id) const {
    Spectrum whole;
    whole.fill(1.0);
    std::vector<SpecularRay> specular;
    std::vector<std::optional<geometry::Hit>> hits;
    for (std::size_t i = 0; i < directions.size(); ++i) {
        if (first_hits[i] && first_hits[i]->t < kNearDistance) {
            specular.push_back({.start = i,
                                .choice = specular.size(),
                                .ray = {from, directions[i]},
                                .energy = whole});
            hits.push_back(first_hits[i]);
        }
    }
    std::vector<Choice> choices(specular.size());
    for (std::uint64_t reflections = 0; reflections <= kMaxNearReflections; ++reflections) {
        if (reflections > 0) {
            hits = closest_hits(scene_.bvh, specular);
        }
        std::size_t kept = 0;
        for (std::size_t i = 0; i < specular.size(); ++i) {
            SpecularRay& ray = specular[i];
            if (!hits[i] || !(ray.travelled + hits[i]->t < kNearDistance)) {
                continue;
            }
            const std::uint64_t id =
                (first_id + ray.start) * (kMaxNearReflections + 1) + reflections;
            add_place(*hits[i],
                      reversed_surface(hits[i]->triangle, ray.ray.direction),
                      random(options_.seed, kNearScatteringStream, id),
                      ray,
                      choices[ray.choice]);
            if (*std::max_element(ray.energy.begin(), ray.energy.end()) > 0.0) {
                ray.materials[ray.reflections++] = triangle_surfaces_[hits[i]->triangle].front / 2;
                reflect(*hits[i],
                        triangle_surfaces_[hits[i]->triangle].normal,
                        self_intersection_offset_,
                        ray);
                specular[kept++] = ray;
            }
        }
        specular.resize(kept);
    }
    std::vector<NearScattering> places;
    for (Choice& choice : choices) {
        if (!(choice.chosen > 0.0)) {
            continue;
        }
        NearScattering& place = choice.place;
        const RaySurface& surface = reversed_surface(place.hit.triangle, place.ray.direction);
        for (std::size_t band = 0; band < bands_; ++band) {
            place.energy[band] *= choice.all / choice.chosen;
            place.share = std::max(place.share, place.energy[band] * surface.scattered[band]);
        }
        places.push_back(place);
    }
    return places;
}

}  // namespace earshot::propagation
