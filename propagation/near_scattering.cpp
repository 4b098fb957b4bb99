// SPDX-License-Identifier: MIT
// Where rays that start at a listener may be scattered first by a surface near it.
#include "earshot/base/random.h"
#include "earshot/bvh/wide_batch.h"
#include "earshot/propagation/internal/near_field.h"
#include "earshot/propagation/internal/ray_tracer.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <optional>
#include <span>
#include <vector>

namespace earshot::propagation {

using audio::Spectrum;
using geometry::Ray;
using geometry::Vec3;

namespace {

/// A ray from the listener, reflected specularly.
struct SpecularRay {
    std::size_t start = 0;
    Ray ray;
    geometry::TriangleId origin_triangle = 0;
    double travelled = 0.0;
    Spectrum energy{};  // re the start
};

/// One of the places of a ray, each chosen with the probability of its share of the scattered
/// energy.
struct Choice {
    NearScattering place;
    double chosen = 0.0, all = 0.0;  // scattered energy, sums over bands
};

}  // namespace

// A ray meets up to kMaxNearReflections + 1 places. It goes on from one of them: each energy is
// divided by the probability of the choice.
std::vector<NearScattering> RayTracer::find_near_scattering(const Vec3& from,
                                                            std::span<const Vec3> directions,
                                                            std::uint64_t first_id) const {
    Spectrum whole;
    whole.fill(1.0);
    std::vector<SpecularRay> specular;
    for (std::size_t i = 0; i < directions.size(); ++i) {
        specular.push_back({.start = i, .ray = {from, directions[i]}, .energy = whole});
    }
    std::vector<Choice> choices(directions.size());
    std::vector<Ray> rays;
    std::vector<geometry::TriangleId> origin_triangles;
    std::vector<std::optional<geometry::Hit>> hits;
    for (int reflections = 0; reflections <= kMaxNearReflections && !specular.empty();
         ++reflections) {
        rays.clear();
        origin_triangles.clear();
        for (const SpecularRay& ray : specular) {
            rays.push_back(ray.ray);
            origin_triangles.push_back(ray.origin_triangle);
        }
        hits.resize(rays.size());
        if (reflections == 0) {
            bvh::closest_hits(wide_, scene_.mesh, rays, hits);
        } else {
            bvh::closest_hits(
                wide_,
                scene_.mesh,
                bvh::SecondaryRays{.rays = rays, .origin_triangles = origin_triangles},
                hits);
        }
        std::size_t kept = 0;
        for (std::size_t i = 0; i < specular.size(); ++i) {
            SpecularRay ray = specular[i];
            if (!hits[i] || !(ray.travelled + hits[i]->t < kNearDistance)) {
                continue;
            }
            const geometry::Hit& hit = *hits[i];
            const TriangleSurface& triangle = triangle_surfaces_[hit.triangle];
            const double along = glm::dot(triangle.normal, ray.ray.direction);
            const RaySurface& surface = reversed_surfaces_[triangle.front + (along > 0.0 ? 1 : 0)];
            ray.travelled += hit.t;
            const double scattered = std::inner_product(
                ray.energy.begin(), ray.energy.end(), surface.scattered.begin(), 0.0);
            Choice& choice = choices[ray.start];
            choice.all += scattered;
            const std::uint64_t id = (first_id + ray.start) * (kMaxNearReflections + 1);
            if (scattered > 0.0 &&
                scattered > choice.all * random(options_.seed,
                                                kNearScatteringStream,
                                                id + static_cast<std::uint64_t>(reflections))) {
                choice.chosen = scattered;
                choice.place = {.start = ray.start,
                                .ray = ray.ray,
                                .hit = hit,
                                .travelled = ray.travelled,
                                .energy = ray.energy};
            }
            double largest = 0.0;
            for (std::size_t band = 0; band < bands_; ++band) {
                ray.energy[band] *= surface.specular[band];
                largest = std::max(largest, ray.energy[band]);
            }
            if (largest > 0.0) {
                const Vec3 normal = (along > 0.0 ? -1.0 : 1.0) * triangle.normal;
                ray.ray.origin += hit.t * ray.ray.direction + self_intersection_offset_ * normal;
                ray.ray.direction =
                    glm::normalize(ray.ray.direction - 2.0 * along * triangle.normal);
                ray.origin_triangle = hit.triangle;
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
        const TriangleSurface& triangle = triangle_surfaces_[place.hit.triangle];
        const bool is_back = glm::dot(triangle.normal, place.ray.direction) > 0.0;
        const RaySurface& surface = reversed_surfaces_[triangle.front + (is_back ? 1 : 0)];
        for (std::size_t band = 0; band < bands_; ++band) {
            place.energy[band] *= choice.all / choice.chosen;
            place.share = std::max(place.share, place.energy[band] * surface.scattered[band]);
        }
        places.push_back(place);
    }
    return places;
}

}  // namespace earshot::propagation
