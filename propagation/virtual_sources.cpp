// SPDX-License-Identifier: MIT
#include "earshot/propagation/internal/virtual_sources.h"

#include "earshot/base/math.h"
#include "earshot/base/random.h"
#include "earshot/geometry/intersect.h"
#include "earshot/propagation/internal/lambert.h"
#include "earshot/propagation/internal/ray_tracer.h"
#include "earshot/propagation/internal/spiral.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <utility>

namespace earshot::propagation {

using geometry::Aabb;
using geometry::Ray;
using geometry::Vec3;

namespace {

// Streams of random numbers of a reflection.
constexpr std::uint64_t kBranchStream = 2;  // 0 and 1 are those of sampling_key()
constexpr std::uint64_t kDirectionStream = 3;

// Virtual sources of a ray are numbered below that: half of the numbers are for those on the side
// of a surface from which the ray comes, half for those on the other.
constexpr std::uint64_t kMaxLegs = std::uint64_t{1} << 20;

// A ray ends when its loudest band has less than this share of its first energy: no histogram of a
// decay of 65 dB feels what it had.
constexpr double kMinEnergy = 1e-8;

/// Selects the random numbers of a ray's reflection.
std::uint64_t random_key(std::uint64_t ray, std::uint64_t reflection) {
    return ray * kMaxLegs + reflection;
}

constexpr std::size_t kRaysPerChunk = 64;

// What moved is told by so many boxes, at most.
constexpr std::size_t kMaxBoxes = 16;

bool same(const Vec3& a, const Vec3& b) {
    return a.x == b.x && a.y == b.y && a.z == b.z;
}

double loudest(const audio::Spectrum& energy) {
    return *std::max_element(energy.begin(), energy.end());
}

/// How the energy of a ray splits at a surface, over all bands together.
struct Split {
    double scattered = 0.0, transmitted = 0.0, specular = 0.0;
};

Split split_at(const RaySurface& surface, const audio::Spectrum& energy, std::size_t bands) {
    Split split;
    for (std::size_t band = 0; band < bands; ++band) {
        split.scattered += surface.scattered[band] * energy[band];
        split.transmitted += surface.transmitted[band] * energy[band];
        split.specular += surface.specular[band] * energy[band];
    }
    return split;
}

}  // namespace

VirtualSources::VirtualSources(const RayOptions& options)
    : options_(options), max_distance_(speed_of_sound(options.air) * options.length) {}

std::size_t VirtualSources::update(const RayScene& scene,
                                   const RaySource& source,
                                   Executor& executor) {
    const double offset = kSelfIntersectionOffset *
                          (scene.bvh.max_abs_coordinate() + glm::length(source.pose.position));
    const std::optional<std::vector<Aabb>> boxes = moved_boxes(scene);
    if (legs_.empty() || !boxes || offset != self_intersection_offset_ || !is_same_start(source)) {
        self_intersection_offset_ = offset;
        start(scene, source);
    } else if (boxes->empty()) {
        return 0;
    } else {
        forget_legs_in(*boxes);
    }
    remember(scene, source);
    std::atomic<std::size_t> traced = 0;
    executor.for_each(legs_.size(), kRaysPerChunk, [&](std::size_t begin, std::size_t end) {
        traced += trace(scene, begin, end);
    });
    list_sources(scene);
    return traced;
}

bool VirtualSources::is_same_start(const RaySource& source) const {
    const Pose& pose = source.pose;
    return same(pose.position, source_.pose.position) && same(pose.front, source_.pose.front) &&
           same(pose.left, source_.pose.left) && same(pose.up, source_.pose.up);
}

/// Boxes of where the triangles that moved are and were; nothing if the triangles are others.
std::optional<std::vector<Aabb>> VirtualSources::moved_boxes(const RayScene& scene) const {
    const geometry::MeshView& mesh = scene.mesh();
    if (!std::equal(
            mesh.triangles.begin(), mesh.triangles.end(), triangles_.begin(), triangles_.end()) ||
        mesh.positions.size() != positions_.size() ||
        !std::equal(scene.material_of_triangle.begin(),
                    scene.material_of_triangle.end(),
                    materials_.begin(),
                    materials_.end())) {
        return std::nullopt;
    }
    std::vector<std::size_t> moved;
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        const geometry::Triangle& triangle = mesh.triangles[i];
        if (std::any_of(triangle.begin(), triangle.end(), [&](geometry::VertexId vertex) {
                return !same(mesh.positions[vertex], positions_[vertex]);
            })) {
            moved.push_back(i);
        }
    }
    // Triangles that follow each other in a mesh are mostly neighbours.
    const std::size_t per_box = std::max<std::size_t>(1, chunk_count(moved.size(), kMaxBoxes));
    std::vector<Aabb> boxes;
    for (std::size_t k = 0; k < moved.size(); ++k) {
        if (k % per_box == 0) {
            boxes.push_back(Aabb::empty());
        }
        for (const geometry::VertexId vertex : mesh.triangles[moved[k]]) {
            boxes.back().include(mesh.positions[vertex]);
            boxes.back().include(positions_[vertex]);
        }
    }
    return boxes;
}

/// Every ray begins anew.
void VirtualSources::start(const RayScene& scene, const RaySource& source) {
    surfaces_.clear();
    for (const Material& material : scene.materials) {
        surfaces_.push_back(ray_surface(material, options_.bands, options_.transmission));
        surfaces_.push_back(material.one_sided ? perfect_absorber() : surfaces_.back());
    }
    const auto count = static_cast<double>(options_.rays);
    const glm::dmat3 rotation = random_rotation(options_.seed, 0, 0);
    legs_.assign(options_.rays, {});
    for (std::size_t i = 0; i < legs_.size(); ++i) {
        Leg leg{.ray = {source.pose.position, rotation * spiral_direction(i, count)}};
        audio::Spectrum pressure{};
        std::fill_n(pressure.begin(), options_.bands.count(), 1.0);
        if (!source.directivity.is_omnidirectional()) {
            pressure = source.directivity.pressure(options_.bands,
                                                   source.pose.seen_from(leg.ray.direction));
        }
        for (std::size_t band = 0; band < options_.bands.count(); ++band) {
            leg.energy[band] = 4.0 * math::kPi / count * (pressure[band] * pressure[band]);
        }
        legs_[i].push_back(leg);
    }
}

/// Each ray is traced again from its first leg that touches a box.
void VirtualSources::forget_legs_in(std::span<const Aabb> boxes) {
    double max_abs_coordinate = 0.0;
    for (const Aabb& box : boxes) {
        for (std::size_t k = 0; k < 3; ++k) {
            max_abs_coordinate = std::max({max_abs_coordinate,
                                           std::abs(static_cast<double>(box.lower[k])),
                                           std::abs(static_cast<double>(box.upper[k]))});
        }
    }
    for (std::vector<Leg>& legs : legs_) {
        const auto touches = [&](const Leg& leg) {
            const geometry::SlabTest test(leg.ray.origin, leg.ray.direction, max_abs_coordinate);
            const double end = leg.hit ? leg.hit->t : std::numeric_limits<double>::infinity();
            return std::any_of(boxes.begin(), boxes.end(), [&](const Aabb& box) {
                return !test.interval(box, end).is_empty();
            });
        };
        const auto first = std::find_if(legs.begin(), legs.end(), touches);
        if (first != legs.end()) {
            first->is_traced = false;
            first->hit.reset();
            legs.erase(first + 1, legs.end());
        }
    }
}

void VirtualSources::remember(const RayScene& scene, const RaySource& source) {
    const geometry::MeshView& mesh = scene.mesh();
    positions_.assign(mesh.positions.begin(), mesh.positions.end());
    triangles_.assign(mesh.triangles.begin(), mesh.triangles.end());
    materials_.assign(scene.material_of_triangle.begin(), scene.material_of_triangle.end());
    source_ = source;
}

/// Traces rays to their ends, a reflection of all at a time. Returns how many legs were traced.
std::size_t VirtualSources::trace(const RayScene& scene, std::size_t first, std::size_t last) {
    std::vector<std::size_t> active;
    for (std::size_t i = first; i < last; ++i) {
        if (!legs_[i].back().is_traced) {
            active.push_back(i);
        }
    }
    std::size_t traced = 0;
    std::vector<Ray> rays;
    std::vector<geometry::TriangleId> from;
    std::vector<std::optional<geometry::Hit>> hits;
    while (!active.empty()) {
        // First legs start at no triangle.
        const auto first_legs = static_cast<std::size_t>(
            std::partition(
                active.begin(), active.end(), [&](std::size_t i) { return legs_[i].size() == 1; }) -
            active.begin());
        rays.clear();
        from.clear();
        for (const std::size_t i : active) {
            rays.push_back(legs_[i].back().ray);
            from.push_back(legs_[i].back().from);
        }
        hits.assign(rays.size(), std::nullopt);
        scene.bvh.closest_hits(std::span(rays).first(first_legs),
                               std::span(hits).first(first_legs));
        scene.bvh.closest_hits(
            bvh::SecondaryRays{.rays = std::span(rays).subspan(first_legs),
                               .origin_triangles = std::span(from).subspan(first_legs)},
            std::span(hits).subspan(first_legs));
        traced += active.size();
        std::size_t kept = 0;
        for (std::size_t k = 0; k < active.size(); ++k) {
            const std::size_t i = active[k];
            Leg& leg = legs_[i].back();
            leg.is_traced = true;
            leg.hit = hits[k];
            if (!leg.hit) {
                continue;
            }
            const std::uint64_t key = random_key(i, legs_[i].size() - 1);
            leg.key = sampling_key(key, options_.seed);
            const std::optional<Leg> next = next_leg(arrival(scene, leg), leg, key);
            if (next && legs_[i].size() < kMaxLegs / 2) {
                legs_[i].push_back(*next);
                active[kept++] = i;
            }
        }
        active.resize(kept);
    }
    return traced;
}

/// Precondition: the leg hits something.
VirtualSources::Arrival VirtualSources::arrival(const RayScene& scene, const Leg& leg) const {
    const geometry::TriangleId triangle = leg.hit->triangle;
    const auto [a, b, c] = scene.bvh.corners(triangle);
    const Vec3 normal = glm::normalize(glm::cross(b - a, c - a));
    const double along = glm::dot(normal, leg.ray.direction);
    const std::size_t front = 2 * scene.material_of_triangle[triangle];
    return {.surface = surfaces_[front + (along > 0.0 ? 1 : 0)],
            .point = leg.ray.origin + leg.hit->t * leg.ray.direction,
            .normal = std::copysign(1.0, -along) * normal,
            .along = along,
            .triangle_normal = normal};
}

/// Reflects, scatters or transmits. Nothing: the ray ends here. `key` selects the random numbers.
std::optional<VirtualSources::Leg> VirtualSources::next_leg(const Arrival& arrival,
                                                            const Leg& leg,
                                                            std::uint64_t key) const {
    const RaySurface& surface = arrival.surface;
    const Split split = split_at(surface, leg.energy, options_.bands.count());
    const double total = split.scattered + split.transmitted + split.specular;
    Leg next = leg;
    next.is_traced = false;
    next.hit.reset();
    next.from = leg.hit->triangle;
    next.travelled += leg.hit->t;
    if (!(total > 0.0) || next.travelled > max_distance_) {
        return std::nullopt;
    }
    const audio::Spectrum* share = &surface.specular;
    double probability = split.specular / total;
    double side = 1.0;
    const double number = random(options_.seed, kBranchStream, key) * total;
    if (number < split.scattered) {
        share = &surface.scattered;
        probability = split.scattered / total;
        next.scattered_before = true;
        next.ray.direction =
            lambert_direction(arrival.normal, random_bits(options_.seed, kDirectionStream, key));
    } else if (number < split.scattered + split.transmitted) {
        share = &surface.transmitted;
        probability = split.transmitted / total;
        ++next.specular_reflections;
        side = -1.0;
    } else {
        ++next.specular_reflections;
        const Vec3 mirrored = leg.ray.direction - 2.0 * arrival.along * arrival.triangle_normal;
        next.ray.direction = glm::normalize(mirrored);
    }
    if (!(probability > 0.0)) {
        return std::nullopt;
    }
    next.ray.origin = arrival.point + side * self_intersection_offset_ * arrival.normal;
    for (std::size_t band = 0; band < options_.bands.count(); ++band) {
        next.energy[band] = (*share)[band] * leg.energy[band] / probability;
    }
    const double first_energy = 4.0 * math::kPi / static_cast<double>(options_.rays);
    if (loudest(next.energy) < kMinEnergy * first_energy) {
        return std::nullopt;
    }
    return next;
}

void VirtualSources::list_sources(const RayScene& scene) {
    list_.clear();
    energies_.clear();
    visible_volume_ = 0.0;
    for (std::size_t i = 0; i < legs_.size(); ++i) {
        if (const auto& hit = legs_[i].front().hit) {
            visible_volume_ += 4.0 / 3.0 * math::kPi / static_cast<double>(options_.rays) *
                               (hit->t * hit->t * hit->t);
        }
        for (std::size_t k = 0; k < legs_[i].size(); ++k) {
            const Leg& leg = legs_[i][k];
            if (!leg.hit) {
                continue;
            }
            const Arrival place = arrival(scene, leg);
            // Exact paths hold what was only reflected specularly, up to their order.
            const bool is_held =
                !leg.scattered_before && leg.specular_reflections + 1 <= options_.specular_order;
            audio::Spectrum front{}, back{};
            for (std::size_t band = 0; band < options_.bands.count(); ++band) {
                const double energy = leg.energy[band];
                front[band] = energy * (place.surface.scattered[band] +
                                        (is_held ? 0.0 : place.surface.specular[band]));
                back[band] = is_held ? 0.0 : energy * place.surface.transmitted[band];
            }
            add_source(place, leg, 1.0, leg.key, front);
            if (!is_held && options_.transmission) {
                add_source(place,
                           leg,
                           -1.0,
                           sampling_key(random_key(i, k + kMaxLegs / 2), options_.seed),
                           back);
            }
        }
    }
}

/// On the side from which the leg comes (1) or the other (-1).
void VirtualSources::add_source(const Arrival& arrival,
                                const Leg& leg,
                                double side,
                                const SamplingKey& key,
                                const audio::Spectrum& energy) {
    const std::size_t bands = options_.bands.count();
    const double travelled = leg.travelled + leg.hit->t;
    if (!(loudest(energy) > 0.0) || travelled > max_distance_) {
        return;
    }
    const Vec3 normal = side * arrival.normal;
    list_.push_back({.position = arrival.point + self_intersection_offset_ * normal,
                     .normal = normal,
                     .triangle = leg.hit->triangle,
                     .travelled = travelled,
                     .key = key,
                     .first_of_bands = energies_.size()});
    energies_.insert(
        energies_.end(), energy.begin(), energy.begin() + static_cast<std::ptrdiff_t>(bands));
}

double lambert_share(const VirtualSource& source, const Vec3& point) noexcept {
    const Vec3 to = point - source.position;
    const double along = glm::dot(to, source.normal);
    if (!(along > 0.0)) {
        return 0.0;
    }
    const double squared = glm::dot(to, to);
    const double bounded = std::max(squared, kMinVirtualDistance * kMinVirtualDistance);
    return along / (math::kPi * std::sqrt(squared) * bounded);
}

}  // namespace earshot::propagation
