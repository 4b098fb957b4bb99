// SPDX-License-Identifier: MIT
#include "earshot/propagation/internal/ray_tracer.h"

#include "earshot/base/math.h"
#include "earshot/base/random.h"
#include "earshot/bvh/closest_point.h"
#include "earshot/bvh/wide_batch.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace earshot::propagation {

using geometry::Ray;
using geometry::Vec3;

namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kGoldenRatio = 1.618033988749895;

// A ray is played for when it is this faint; the odds keep the mean.
constexpr std::uint64_t kDice = 5;  // thrown at a bounce
constexpr double kFaint = 1e-7;
constexpr double kSurvival = 0.5;

// New rays and rain start so far from a surface, as a share of the scene: more than the rounding of
// a hit, less than anything that is heard.
constexpr double kLift = 0x1p-32;

Vec3 lambert_direction(const Vec3& normal, double u, double v) {
    const Vec3 other = std::abs(normal.x) < 0.5 ? Vec3(1, 0, 0) : Vec3(0, 1, 0);
    const Vec3 right = glm::normalize(glm::cross(normal, other));
    const Vec3 up = glm::cross(normal, right);
    const double r = std::sqrt(u);
    const double angle = 2.0 * kPi * v;
    return glm::normalize(r * math::cos(angle) * right + r * math::sin(angle) * up +
                          std::sqrt(1.0 - u) * normal);
}

}  // namespace

RayTracer::RayTracer(const RayScene& scene,
                     const RaySource& source,
                     std::span<const Vec3> listeners,
                     const RayOptions& options,
                     Executor& executor)
    : scene_(scene),
      source_(source),
      listeners_(listeners),
      options_(options),
      wide_(bvh::WideTree::build(scene.tree, scene.mesh, executor)),
      bands_(options.bands.count()),
      speed_(speed_of_sound(options.air)),
      bins_(static_cast<std::size_t>(std::ceil(options.length / options.bin))),
      lift_(kLift * (wide_.reach() + glm::length(source.pose.position))) {
    describe_surfaces();
    normals_.reserve(scene.mesh.triangles.size());
    for (const geometry::Triangle& triangle : scene.mesh.triangles) {
        const Vec3& a = scene.mesh.positions[triangle[0]];
        normals_.push_back(glm::normalize(glm::cross(scene.mesh.positions[triangle[1]] - a,
                                                     scene.mesh.positions[triangle[2]] - a)));
    }
    const double radius =
        options.receiver_radius > 0.0 ? options.receiver_radius : radius_for_space();
    for (const Vec3& listener : listeners) {
        const auto nearest = bvh::closest_point(scene.tree, scene.mesh, listener, radius);
        radii_.push_back(nearest ? std::max(nearest->distance, lift_) : radius);
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
        Surface& surface = surfaces_.emplace_back();
        surface.one_sided = material.one_sided;
        for (std::size_t band = 0; band < bands_; ++band) {
            const double kept = 1.0 - absorption[band];
            // What goes through is a part of what does not come back.
            const double through =
                options_.transmission ? std::min(transmission[band], absorption[band]) : 0.0;
            surface.mirrored.push_back(kept * (1.0 - scattering[band]));
            surface.scattered.push_back(kept * scattering[band]);
            surface.through.push_back(through);
            surface.absorbed.push_back(absorption[band] - through);
        }
    }
}

std::size_t RayTracer::spans() const noexcept {
    return chunk_count(bins_, audio::kBinsPerSpan);
}

RayTally RayTracer::trace(std::uint64_t begin, std::uint64_t end) const {
    RayTally tally;
    tally.energy.assign(listeners_.size() * bins_ * bands_, 0.0);
    if (options_.tells_directions) {
        tally.directions.assign(listeners_.size() * spans() * audio::kDirectionParts * bands_, 0.0);
    }
    Flock flock;
    for (std::uint64_t id = begin; id < end; ++id) {
        emit(id, flock, tally.balance);
    }
    Rain rain;
    for (std::uint64_t bounce = 0; !flock.rays.empty(); ++bounce) {
        advance(flock, bounce, rain, tally);
    }
    return tally;
}

// On a spiral that covers the sphere evenly, turned by the seed.
Vec3 RayTracer::direction_of(std::uint64_t id, double count) const {
    const double z = 1.0 - (2.0 * static_cast<double>(id) + 1.0) / count;
    const double turns = static_cast<double>(id) / kGoldenRatio + random(options_.seed, 0, 0);
    const double angle = 2.0 * kPi * (turns - std::floor(turns));
    const double r = std::sqrt(std::max(0.0, 1.0 - z * z));
    return {r * math::cos(angle), r * math::sin(angle), z};
}

void RayTracer::emit(std::uint64_t id, Flock& flock, EnergyBalance& balance) const {
    const auto count = static_cast<double>(options_.rays);
    const Vec3 direction = direction_of(id, count);
    audio::Spectrum pressure;
    pressure.fill(1.0);
    if (!source_.directivity.is_omnidirectional()) {
        pressure = source_.directivity.pressure(options_.bands, source_.pose.seen_from(direction));
    }
    flock.rays.push_back({source_.pose.position, direction});
    flock.paths.push_back({.id = id});
    for (std::size_t band = 0; band < bands_; ++band) {
        const double energy = 4.0 * kPi / count * (pressure[band] * pressure[band]);
        flock.energy.push_back(energy);
        balance.emitted[band] += energy;
    }
}

// One leg of every ray, and what happens at its end.
void RayTracer::advance(Flock& flock, std::uint64_t bounce, Rain& rain, RayTally& tally) const {
    const auto hits = bvh::closest_hits(wide_, scene_.mesh, flock.rays);
    rain.drops.clear();
    rain.energy.clear();
    std::size_t kept = 0;
    for (std::size_t i = 0; i < hits.size(); ++i) {
        Ray& ray = flock.rays[i];
        Path& path = flock.paths[i];
        double* energy = flock.energy.data() + i * bands_;
        count_passages(ray,
                       path,
                       energy,
                       hits[i] ? hits[i]->t : std::numeric_limits<double>::infinity(),
                       tally);
        if (!hits[i]) {
            for (std::size_t band = 0; band < bands_; ++band) {
                tally.balance.escaped[band] += energy[band];
            }
            continue;
        }
        if (bounce == 0) {
            tally.cubed_first_legs += hits[i]->t * hits[i]->t * hits[i]->t;
        }
        ++tally.balance.bounces;
        if (reflect(*hits[i], bounce, ray, path, energy, rain, tally.balance)) {
            if (kept != i) {
                flock.rays[kept] = ray;
                flock.paths[kept] = path;
                std::copy_n(energy, bands_, flock.energy.data() + kept * bands_);
            }
            ++kept;
        }
    }
    let_it_rain(rain, tally);
    flock.rays.resize(kept);
    flock.paths.resize(kept);
    flock.energy.resize(kept * bands_);
}

// Energy density along the ray's way through each listener's sphere.
void RayTracer::count_passages(
    const Ray& ray, const Path& path, const double* energy, double reach, RayTally& tally) const {
    if (path.is_rain || (!path.was_scattered && path.mirrors <= options_.specular_order)) {
        return;
    }
    for (std::size_t k = 0; k < listeners_.size(); ++k) {
        const Vec3 to = listeners_[k] - ray.origin;
        const double along = glm::dot(to, ray.direction);
        const double half_squared = radii_[k] * radii_[k] - (glm::dot(to, to) - along * along);
        if (!(half_squared > 0.0)) {
            continue;
        }
        const double half = std::sqrt(half_squared);
        const double begin = std::max(0.0, along - half);
        const double end = std::min(reach, along + half);
        if (begin >= end) {
            continue;
        }
        const double volume = 4.0 / 3.0 * kPi * radii_[k] * radii_[k] * radii_[k];
        hear(k,
             path.travelled + 0.5 * (begin + end),
             -ray.direction,
             energy,
             (end - begin) / volume,
             tally);
    }
}

void RayTracer::hear(std::size_t listener,
                     double travelled,
                     const Vec3& towards,
                     const double* energy,
                     double share,
                     RayTally& tally) const {
    const double place = travelled / (speed_ * options_.bin);
    if (!(place < static_cast<double>(bins_))) {
        return;
    }
    const auto bin = static_cast<std::size_t>(place);
    double* heard = tally.energy.data() + (listener * bins_ + bin) * bands_;
    for (std::size_t band = 0; band < bands_; ++band) {
        heard[band] += share * energy[band];
    }
    if (tally.directions.empty()) {
        return;
    }
    const std::size_t part = audio::direction_part({towards.x, towards.y, towards.z});
    const std::size_t span = listener * spans() + bin / audio::kBinsPerSpan;
    double* from = tally.directions.data() + (span * audio::kDirectionParts + part) * bands_;
    for (std::size_t band = 0; band < bands_; ++band) {
        from[band] += share * energy[band];
    }
}

// False: the ray ends here.
bool RayTracer::reflect(const geometry::Hit& hit,
                        std::uint64_t bounce,
                        Ray& ray,
                        Path& path,
                        double* energy,
                        Rain& rain,
                        EnergyBalance& balance) const {
    const Surface& surface = surfaces_[scene_.material_of_triangle[hit.triangle]];
    const auto dice = [&](std::uint64_t k) {
        return random(options_.seed, kDice * bounce + k + 1, path.id);
    };
    const bool is_back = glm::dot(normals_[hit.triangle], ray.direction) > 0.0;
    const Vec3 normal = is_back ? -normals_[hit.triangle] : normals_[hit.triangle];
    path.travelled += hit.t;
    ray.origin += hit.t * ray.direction;
    double mirrored = 0.0;
    double scattered = 0.0;
    double through = 0.0;
    for (std::size_t band = 0; band < bands_; ++band) {
        mirrored += surface.mirrored[band] * energy[band];
        scattered += surface.scattered[band] * energy[band];
        through += surface.through[band] * energy[band];
    }
    const double total = mirrored + scattered + through;
    if (!(total > 0.0) || (is_back && surface.one_sided)) {
        for (std::size_t band = 0; band < bands_; ++band) {
            balance.absorbed[band] += energy[band];
        }
        return false;
    }
    for (std::size_t band = 0; band < bands_; ++band) {
        balance.absorbed[band] += surface.absorbed[band] * energy[band];
    }
    const Vec3 lifted = ray.origin + lift_ * normal;
    // Little that is scattered is heard seldom, and then as the more.
    const double heard = std::sqrt(scattered / total);
    if (dice(4) < heard) {
        rain.drops.push_back({lifted, normal, path.travelled});
        for (std::size_t band = 0; band < bands_; ++band) {
            rain.energy.push_back(surface.scattered[band] * energy[band] / heard);
        }
    }
    // The chances are the means'; a band that differs from them changes its weight.
    const double die = dice(0) * total;
    path.is_rain = die < scattered;
    const bool passes = !path.is_rain && die < scattered + through;
    const double chance = (path.is_rain ? scattered : passes ? through : mirrored) / total;
    const std::vector<double>& share = path.is_rain ? surface.scattered
                                       : passes     ? surface.through
                                                    : surface.mirrored;
    for (std::size_t band = 0; band < bands_; ++band) {
        energy[band] *= share[band] / chance;
    }
    if (path.travelled > speed_ * options_.length) {
        for (std::size_t band = 0; band < bands_; ++band) {
            balance.left[band] += energy[band];
        }
        return false;
    }
    if (path.is_rain) {
        path.was_scattered = true;
        ray = {lifted, lambert_direction(normal, dice(1), dice(2))};
    } else {
        ++path.mirrors;
        ray.origin = passes ? ray.origin - lift_ * normal : lifted;
        if (!passes) {
            ray.direction -= 2.0 * glm::dot(normal, ray.direction) * normal;
            ray.direction = glm::normalize(ray.direction);
        }
    }
    return stays(dice(3), energy, balance);
}

// Russian roulette for faint rays.
bool RayTracer::stays(double die, double* energy, EnergyBalance& balance) const {
    const double start = 4.0 * kPi / static_cast<double>(options_.rays);
    const double largest = *std::max_element(energy, energy + bands_);
    if (largest >= kFaint * start) {
        return true;
    }
    if (die >= kSurvival) {
        for (std::size_t band = 0; band < bands_; ++band) {
            balance.left[band] += energy[band];
        }
        return false;
    }
    for (std::size_t band = 0; band < bands_; ++band) {
        const double raised = energy[band] / kSurvival;
        balance.left[band] -= raised - energy[band];
        energy[band] = raised;
    }
    return true;
}

// Scattered energy on its straight way to every listener in sight (Heinz 1993).
void RayTracer::let_it_rain(const Rain& rain, RayTally& tally) const {
    std::vector<geometry::Segment> ways;
    std::vector<std::pair<std::size_t, std::size_t>> which;  // drop, listener
    ways.reserve(rain.drops.size() * listeners_.size());
    which.reserve(rain.drops.size() * listeners_.size());
    for (std::size_t i = 0; i < rain.drops.size(); ++i) {
        for (std::size_t k = 0; k < listeners_.size(); ++k) {
            if (glm::dot(listeners_[k] - rain.drops[i].from, rain.drops[i].normal) > 0.0) {
                ways.push_back({rain.drops[i].from, listeners_[k]});
                which.emplace_back(i, k);
            }
        }
    }
    const auto blocked = bvh::occluded(wide_, scene_.mesh, ways);
    for (std::size_t j = 0; j < which.size(); ++j) {
        if (blocked[j] != 0) {
            continue;
        }
        const auto& [i, k] = which[j];
        const Drop& drop = rain.drops[i];
        const Vec3 way = listeners_[k] - drop.from;
        const double distance = glm::length(way);
        const double cosine = glm::dot(way, drop.normal) / distance;
        hear(k,
             drop.travelled + distance,
             -way,
             rain.energy.data() + i * bands_,
             cosine / (kPi * distance * distance),
             tally);
    }
}

}  // namespace earshot::propagation
