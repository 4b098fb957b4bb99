// SPDX-License-Identifier: MIT
#include "earshot/propagation/long_decay.h"

#include "earshot/base/math.h"
#include "earshot/base/random.h"
#include "earshot/propagation/internal/lambert.h"
#include "earshot/propagation/internal/spiral.h"
#include "earshot/propagation/plausibility.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <optional>
#include <vector>

namespace earshot::propagation {

using geometry::Ray;
using geometry::TriangleId;
using geometry::Vec3;

namespace {

constexpr std::size_t kRays = 2048;
constexpr std::size_t kChunk = 256;  // rays that are traced together
constexpr std::uint64_t kSeed = 1;
constexpr std::uint64_t kStreams = 2;
constexpr std::size_t kMid = 2;  // bands: 500 Hz and 1 kHz
constexpr double kSelfIntersectionOffset = 0x1p-32;

using MidEnergies = std::array<double, kMid>;

std::array<std::size_t, kMid> mid_bands(const audio::Bands& bands) {
    const auto index_of = [&](double frequency_hz) {
        const auto nominal = bands.nominal_hz();
        return static_cast<std::size_t>(std::find(nominal.begin(), nominal.end(), frequency_hz) -
                                        nominal.begin());
    };
    return {index_of(500.0), index_of(1000.0)};
}

/// What a material keeps of the energy, and how much of that it scatters.
struct MidSurface {
    MidEnergies kept{}, scattered{};  // shares of what arrives, and of what is kept
    bool one_sided = false;

    double scattering() const { return 0.5 * (scattered[0] + scattered[1]); }
};

/// Where energy is in a span of time, summed over rays.
struct RemainingEnergy {
    std::vector<double> of_material;     // that each sends back
    double reflected = 0.0;              // the sum
    Vec3 moment{0.0};                    // of the points that send it back
    std::array<double, 6> directions{};  // xx, yy, zz, xy, yz, zx of the directions of travel
    double travelling = 0.0;             // xx + yy + zz

    void add(const RemainingEnergy& other) {
        for (std::size_t i = 0; i < of_material.size(); ++i) {
            of_material[i] += other.of_material[i];
        }
        for (std::size_t i = 0; i < directions.size(); ++i) {
            directions[i] += other.directions[i];
        }
        reflected += other.reflected;
        moment += other.moment;
        travelling += other.travelling;
    }
};

/// Rays of a source, traced as those of late sound are, without an end by chance.
class RemainingEnergyTracer {
public:
    RemainingEnergyTracer(const RayScene& scene, const Vec3& source, const audio::Bands& bands)
        : scene_(scene),
          source_(source),
          offset_(kSelfIntersectionOffset *
                  (scene.bvh.max_abs_coordinate() + glm::length(source))) {
        const auto mid = mid_bands(bands);
        for (const Material& material : scene.materials) {
            const audio::Spectrum absorption = material.absorption.over(bands);
            const audio::Spectrum scattering = material.scattering.over(bands);
            MidSurface& surface = surfaces_.emplace_back();
            surface.one_sided = material.one_sided;
            for (std::size_t k = 0; k < kMid; ++k) {
                surface.kept[k] = 1.0 - absorption[mid[k]];
                surface.scattered[k] = scattering[mid[k]];
            }
        }
    }

    /// The energy that is under way from `begin` to `end` (metres that sound has travelled). Rays
    /// end that are fainter than `faintest` of their start.
    RemainingEnergy trace(double begin, double end, double faintest, Executor& executor) const {
        std::vector<RemainingEnergy> parts(chunk_count(kRays, kChunk));
        executor.for_each(kRays, kChunk, [&](std::size_t first, std::size_t last) {
            RemainingEnergy& part = parts[first / kChunk];
            part.of_material.assign(surfaces_.size(), 0.0);
            std::vector<Flight> flights;
            for (std::size_t i = first; i < last; ++i) {
                flights.push_back({.id = i,
                                   .ray = {source_, spiral_direction(i, double(kRays))},
                                   .energy = {1.0, 1.0}});
            }
            for (std::uint64_t leg = 0; !flights.empty(); ++leg) {
                advance(leg, begin, end, faintest, flights, part);
            }
        });
        RemainingEnergy sum = std::move(parts.front());
        for (std::size_t i = 1; i < parts.size(); ++i) {
            sum.add(parts[i]);
        }
        return sum;
    }

    const MidSurface& surface(std::size_t material) const { return surfaces_[material]; }

private:
    struct Flight {
        std::uint64_t id = 0;
        Ray ray;
        MidEnergies energy{};
        double travelled = 0.0;
        TriangleId origin = 0;
    };

    void advance(std::uint64_t leg,
                 double begin,
                 double end,
                 double faintest,
                 std::vector<Flight>& flights,
                 RemainingEnergy& sums) const {
        std::vector<Ray> rays;
        std::vector<TriangleId> origins;
        for (const Flight& flight : flights) {
            rays.push_back(flight.ray);
            origins.push_back(flight.origin);
        }
        std::vector<std::optional<geometry::Hit>> hits(rays.size());
        if (leg == 0) {
            scene_.bvh.closest_hits(rays, hits);
        } else {
            scene_.bvh.closest_hits(bvh::SecondaryRays{.rays = rays, .origin_triangles = origins},
                                    hits);
        }
        const RandomStream branch(kSeed, kStreams * leg + 1);
        const RandomStream direction(kSeed, kStreams * leg + 2);
        std::size_t kept = 0;
        for (std::size_t i = 0; i < flights.size(); ++i) {
            Flight& flight = flights[i];
            if (!hits[i]) {
                continue;
            }
            record(flight, *hits[i], begin, end, sums);
            reflect(*hits[i], branch.at(flight.id), direction.bits(flight.id), flight);
            if (flight.travelled < end && std::max(flight.energy[0], flight.energy[1]) > faintest) {
                flights[kept++] = flight;
            }
        }
        flights.resize(kept);
    }

    void record(const Flight& flight,
                const geometry::Hit& hit,
                double begin,
                double end,
                RemainingEnergy& sums) const {
        const double energy = flight.energy[0] + flight.energy[1];
        const double after = flight.travelled + hit.t;
        const double inside = std::min(after, end) - std::max(flight.travelled, begin);
        if (inside > 0.0) {
            const Vec3& d = flight.ray.direction;
            const std::array<double, 6> products = {
                d.x * d.x, d.y * d.y, d.z * d.z, d.x * d.y, d.y * d.z, d.z * d.x};
            for (std::size_t k = 0; k < products.size(); ++k) {
                sums.directions[k] += inside * energy * products[k];
            }
            sums.travelling += inside * energy;
        }
        if (after >= begin && after < end) {
            const std::uint32_t material = scene_.material_of_triangle[hit.triangle];
            const MidEnergies& kept = surfaces_[material].kept;
            const double reflected = kept[0] * flight.energy[0] + kept[1] * flight.energy[1];
            sums.of_material[material] += reflected;
            sums.reflected += reflected;
            sums.moment += reflected * (flight.ray.origin + hit.t * flight.ray.direction);
        }
    }

    void reflect(const geometry::Hit& hit,
                 double chance,
                 std::uint64_t direction,
                 Flight& flight) const {
        const auto [a, b, c] = scene_.bvh.corners(hit.triangle);
        Vec3 normal = glm::normalize(glm::cross(b - a, c - a));
        const double along = glm::dot(normal, flight.ray.direction);
        const MidSurface& surface = surfaces_[scene_.material_of_triangle[hit.triangle]];
        if (along > 0.0) {
            normal = -normal;
        }
        const bool is_dead = along > 0.0 && surface.one_sided;
        const double scattering = surface.scattering();
        const bool scatters = chance < scattering;
        for (std::size_t k = 0; k < kMid; ++k) {
            // Weighted where the bands scatter differently.
            const double weight = scatters ? surface.scattered[k] / scattering
                                  : scattering < 1.0
                                      ? (1.0 - surface.scattered[k]) / (1.0 - scattering)
                                      : 0.0;
            flight.energy[k] *= is_dead ? 0.0 : weight * surface.kept[k];
        }
        const Vec3 at = flight.ray.origin + hit.t * flight.ray.direction;
        flight.ray = {at + offset_ * normal,
                      scatters ? lambert_direction(normal, direction)
                               : glm::normalize(glm::reflect(flight.ray.direction, normal))};
        flight.travelled += hit.t;
        flight.origin = hit.triangle;
    }

    const RayScene& scene_;
    Vec3 source_;
    double offset_;
    std::vector<MidSurface> surfaces_;
};

/// Eigenvalues of a symmetric matrix (xx, yy, zz, xy, yz, zx), ascending, by the trigonometric
/// solution of its characteristic polynomial.
std::array<double, 3> eigenvalues(const std::array<double, 6>& m) {
    const auto [xx, yy, zz, xy, yz, zx] = m;
    const double mean = (xx + yy + zz) / 3.0;
    const double a = xx - mean, b = yy - mean, c = zz - mean;
    const double p = std::sqrt((a * a + b * b + c * c + 2.0 * (xy * xy + yz * yz + zx * zx)) / 6.0);
    if (!(p > 0.0)) {
        return {mean, mean, mean};
    }
    const double determinant =
        a * (b * c - yz * yz) - xy * (xy * c - yz * zx) + zx * (xy * yz - b * zx);
    const double cosine = std::clamp(determinant / (2.0 * p * p * p), -1.0, 1.0);
    const double angle = math::acos(cosine) / 3.0;
    const double largest = mean + 2.0 * p * math::cos(angle);
    const double smallest = mean + 2.0 * p * math::cos(angle + 2.0 * math::kPi / 3.0);
    return {smallest, 3.0 * mean - largest - smallest, largest};
}

/// The materials that hold most of the energy, the loudest first: `"wall" (no scattering)`.
std::vector<std::string> names_of_loudest(const RayScene& scene,
                                          const RemainingEnergyTracer& tracer,
                                          const RemainingEnergy& remaining) {
    constexpr double kMinHeldShare = 0.8;  // of the energy
    constexpr std::size_t kMaxNames = 4;
    std::vector<std::size_t> order(remaining.of_material.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        return remaining.of_material[a] > remaining.of_material[b];
    });
    std::vector<std::string> names;
    double held = 0.0;
    for (const std::size_t material : order) {
        if (held >= kMinHeldShare * remaining.reflected || names.size() == kMaxNames) {
            break;
        }
        held += remaining.of_material[material];
        const double scattering = tracer.surface(material).scattering();
        names.push_back(
            "\"" + scene.materials[material].name + "\" (" +
            (scattering > 0.0 ? "scattering " + short_text(scattering) : "no scattering") + ")");
    }
    return names;
}

std::string listed(const std::vector<std::string>& names) {
    std::string text = names.front();
    for (std::size_t i = 1; i < names.size(); ++i) {
        text += (i + 1 == names.size() ? " and " : ", ") + names[i];
    }
    return text;
}

std::string explanation(const RemainingEnergy& remaining, const std::vector<std::string>& names) {
    std::array<double, 6> directions = remaining.directions;
    for (double& product : directions) {
        product /= remaining.travelling;
    }
    // 1/3 each in a diffuse field. A field that keeps to a line or to a plane runs between surfaces
    // that face each other.
    constexpr double kDiffuse = 0.2;
    if (eigenvalues(directions).front() < kDiffuse) {
        return "late sound runs to and fro between " +
               (names.size() == 1 ? "surfaces of " + names.front() + " that face each other"
                                  : listed(names));
    }
    const Vec3 centre = remaining.moment / remaining.reflected;
    return "late sound stays about (" + short_text(centre.x) + ", " + short_text(centre.y) + ", " +
           short_text(centre.z) + "), where it meets " + listed(names) + ", as in coupled rooms";
}

}  // namespace

std::string long_decay_cause(const RayScene& scene,
                             const Vec3& source,
                             double t30_mid,
                             const RoomStatistics& room,
                             const RoomStatisticsOptions& options,
                             Executor& executor) {
    // T30 is the slope from -5 to -35 dB, which late sound has after a quarter of T30. Where that
    // takes very many reflections, the field has found its form earlier.
    constexpr double kMaxReflections = 300.0;
    const double mean_free_path = 4.0 * room.volume / (room.surface + room.opening);
    const double speed = speed_of_sound(options.air);
    const double begin = std::min(0.25 * t30_mid * speed, kMaxReflections * mean_free_path);
    const double end = 2.0 * begin;
    const double decades = 6.0 * end / (speed * t30_mid);
    constexpr double kNegligible = 1e-4;  // of the energy that a ray has on average
    const RemainingEnergyTracer tracer(scene, source, options.bands);
    const RemainingEnergy remaining =
        tracer.trace(begin, end, kNegligible * math::pow10(-decades), executor);
    return remaining.reflected > 0.0
               ? explanation(remaining, names_of_loudest(scene, tracer, remaining))
               : "";
}

std::string long_decay_note(double t30_mid, double eyring_mid, const std::string& cause) {
    return "T30 of " + short_text(t30_mid) + " s is " + short_text(t30_mid / eyring_mid) +
           " times Eyring's " + short_text(eyring_mid) + " s" + (cause.empty() ? "" : ": " + cause);
}

}  // namespace earshot::propagation
