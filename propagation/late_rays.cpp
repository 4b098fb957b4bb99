// SPDX-License-Identifier: MIT
#include "earshot/propagation/late_rays.h"

#include "earshot/base/error.h"
#include "earshot/base/math.h"
#include "earshot/base/random.h"
#include "earshot/bvh/closest_point.h"
#include "earshot/bvh/wide_batch.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

namespace earshot::propagation {

using audio::EnergyHistogram;
using audio::Spectrum;
using geometry::Ray;
using geometry::Vec3;

namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kGoldenRatio = 1.618033988749895;

// Rays of a batch stay together, so that the hierarchy is asked for many at a time.
constexpr std::size_t kBatch = 1024;

// A ray is played for when it is this faint; the odds keep the mean.
constexpr double kFaint = 1e-7;
constexpr double kSurvival = 0.5;

// New rays and rain start so far from a surface, as a share of the scene: more than the rounding of
// a hit, less than anything that is heard.
constexpr double kLift = 0x1p-32;

struct Surface {
    Spectrum absorption{}, scattering{};
};

struct Sound {
    Ray ray;
    double travelled = 0.0;  // metres
    Spectrum energy{};
    std::uint64_t id = 0;
    int mirrors = 0;
    bool was_scattered = false;  // ever
    bool is_rain = false;        // the leg that begins has been heard as rain
};

/// What one batch brings home.
struct Tally {
    std::vector<std::vector<Spectrum>> energy;  // per listener, per bin
    EnergyBalance balance;
};

/// Everything that the batches share and only read.
class Tracer {
public:
    Tracer(const RayScene& scene,
           const Vec3& source,
           std::span<const Vec3> listeners,
           const RayOptions& options,
           Executor& executor)
        : scene_(scene),
          source_(source),
          listeners_(listeners),
          options_(options),
          wide_(bvh::WideTree::build(scene.tree, scene.mesh, executor)),
          speed_(speed_of_sound(options.air)),
          bins_(static_cast<std::size_t>(std::ceil(options.length / options.bin))),
          lift_(kLift * (wide_.reach() + glm::length(source))) {
        for (const Material& material : scene.materials) {
            surfaces_.push_back(
                {material.absorption.over(options.bands), material.scattering.over(options.bands)});
        }
        for (const Vec3& listener : listeners) {
            const auto nearest =
                bvh::closest_point(scene.tree, scene.mesh, listener, options.receiver_radius);
            radii_.push_back(nearest ? std::max(nearest->distance, lift_)
                                     : options.receiver_radius);
        }
    }

    std::size_t bins() const { return bins_; }

    Tally trace(std::uint64_t begin, std::uint64_t end) const {
        Tally tally;
        tally.energy.assign(listeners_.size(), std::vector<Spectrum>(bins_));
        std::vector<Sound> sounds;
        for (std::uint64_t i = begin; i < end; ++i) {
            sounds.push_back(emit(i));
            add(tally.balance.emitted, sounds.back().energy);
        }
        for (std::uint64_t bounce = 0; !sounds.empty(); ++bounce) {
            advance(sounds, bounce, tally);
        }
        return tally;
    }

private:
    /// Directions on a spiral that covers the sphere evenly, turned by the seed.
    Sound emit(std::uint64_t i) const {
        const double z =
            1.0 - (2.0 * static_cast<double>(i) + 1.0) / static_cast<double>(options_.rays);
        const double turns = static_cast<double>(i) / kGoldenRatio + random(options_.seed, 0, 0);
        const double angle = 2.0 * kPi * (turns - std::floor(turns));
        const double r = std::sqrt(std::max(0.0, 1.0 - z * z));
        Sound sound;
        sound.ray = {source_, {r * math::cos(angle), r * math::sin(angle), z}};
        sound.id = i;
        std::fill_n(sound.energy.begin(),
                    options_.bands.count(),
                    4.0 * kPi / static_cast<double>(options_.rays));
        return sound;
    }

    void add(Spectrum& sum, const Spectrum& energy) const {
        for (std::size_t band = 0; band < options_.bands.count(); ++band) {
            sum[band] += energy[band];
        }
    }

    /// One leg of every ray, and what happens at its end.
    void advance(std::vector<Sound>& sounds, std::uint64_t bounce, Tally& tally) const {
        std::vector<Ray> rays;
        for (const Sound& sound : sounds) {
            rays.push_back(sound.ray);
        }
        const auto hits = bvh::closest_hits(wide_, scene_.mesh, rays);
        std::vector<Rain> rain;
        rain.reserve(sounds.size());
        std::size_t kept = 0;
        for (std::size_t i = 0; i < sounds.size(); ++i) {
            Sound& sound = sounds[i];
            count_passages(
                sound, hits[i] ? hits[i]->t : std::numeric_limits<double>::infinity(), tally);
            if (!hits[i]) {
                add(tally.balance.escaped, sound.energy);
                continue;
            }
            ++tally.balance.bounces;
            if (reflect(sound, *hits[i], bounce, rain, tally.balance)) {
                if (kept != i) {
                    sounds[kept] = sound;
                }
                ++kept;
            }
        }
        let_it_rain(rain, tally);
        sounds.resize(kept);
    }

    /// Energy density along the ray's way through each listener's sphere.
    void count_passages(const Sound& sound, double reach, Tally& tally) const {
        if (sound.is_rain || (!sound.was_scattered && sound.mirrors <= options_.specular_order)) {
            return;
        }
        for (std::size_t k = 0; k < listeners_.size(); ++k) {
            const Vec3 to = listeners_[k] - sound.ray.origin;
            const double along = glm::dot(to, sound.ray.direction);
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
            hear(tally.energy[k],
                 sound.travelled + 0.5 * (begin + end),
                 sound.energy,
                 (end - begin) / volume);
        }
    }

    void hear(std::vector<Spectrum>& bins,
              double travelled,
              const Spectrum& energy,
              double share) const {
        const double place = travelled / (speed_ * options_.bin);
        if (!(place < static_cast<double>(bins_))) {
            return;
        }
        Spectrum& bin = bins[static_cast<std::size_t>(place)];
        for (std::size_t band = 0; band < options_.bands.count(); ++band) {
            bin[band] += share * energy[band];
        }
    }

    /// Energy that leaves a point of a surface after Lambert.
    struct Rain {
        Vec3 from, normal;
        double travelled = 0.0;
        Spectrum energy{};
    };

    /// False: the ray ends here.
    bool reflect(Sound& sound,
                 const geometry::Hit& hit,
                 std::uint64_t bounce,
                 std::vector<Rain>& rain,
                 EnergyBalance& balance) const {
        const Surface& surface = surfaces_[scene_.material_of_triangle[hit.triangle]];
        const std::size_t bands = options_.bands.count();
        const auto dice = [&](std::uint64_t k) {
            return random(options_.seed, 4 * bounce + k + 1, sound.id);
        };
        Vec3 normal = normal_of(hit.triangle);
        if (glm::dot(normal, sound.ray.direction) > 0.0) {
            normal = -normal;
        }
        sound.travelled += hit.t;
        sound.ray.origin += hit.t * sound.ray.direction + lift_ * normal;
        double total = 0.0;
        double scattered = 0.0;
        Spectrum diffuse{};
        for (std::size_t band = 0; band < bands; ++band) {
            const double lost = surface.absorption[band] * sound.energy[band];
            balance.absorbed[band] += lost;
            sound.energy[band] -= lost;
            diffuse[band] = surface.scattering[band] * sound.energy[band];
            total += sound.energy[band];
            scattered += diffuse[band];
        }
        if (!(total > 0.0) || sound.travelled > speed_ * options_.length) {
            add(balance.left, sound.energy);
            return false;
        }
        if (scattered > 0.0) {
            rain.push_back({sound.ray.origin, normal, sound.travelled, diffuse});
        }
        // The chance is the mean's; a band that scatters otherwise changes its weight.
        const double chance = std::min(1.0, scattered / total);
        sound.is_rain = dice(0) < chance;
        for (std::size_t band = 0; band < bands; ++band) {
            sound.energy[band] = sound.is_rain
                                     ? diffuse[band] / chance
                                     : (sound.energy[band] - diffuse[band]) / (1.0 - chance);
        }
        if (sound.is_rain) {
            sound.was_scattered = true;
            sound.ray.direction = lambert_direction(normal, dice(1), dice(2));
        } else {
            ++sound.mirrors;
            sound.ray.direction -= 2.0 * glm::dot(normal, sound.ray.direction) * normal;
            sound.ray.direction = glm::normalize(sound.ray.direction);
        }
        return stays(sound, dice(3), balance);
    }

    /// Russian roulette for faint rays.
    bool stays(Sound& sound, double die, EnergyBalance& balance) const {
        const double start = 4.0 * kPi / static_cast<double>(options_.rays);
        const auto end = sound.energy.begin() + static_cast<std::ptrdiff_t>(options_.bands.count());
        const double largest = *std::max_element(sound.energy.begin(), end);
        if (largest >= kFaint * start) {
            return true;
        }
        if (die >= kSurvival) {
            add(balance.left, sound.energy);
            return false;
        }
        for (std::size_t band = 0; band < options_.bands.count(); ++band) {
            const double raised = sound.energy[band] / kSurvival;
            balance.left[band] -= raised - sound.energy[band];
            sound.energy[band] = raised;
        }
        return true;
    }

    Vec3 normal_of(geometry::TriangleId id) const {
        const geometry::Triangle& triangle = scene_.mesh.triangles[id];
        const Vec3& a = scene_.mesh.positions[triangle[0]];
        return glm::normalize(glm::cross(scene_.mesh.positions[triangle[1]] - a,
                                         scene_.mesh.positions[triangle[2]] - a));
    }

    static Vec3 lambert_direction(const Vec3& normal, double u, double v) {
        const Vec3 other = std::abs(normal.x) < 0.5 ? Vec3(1, 0, 0) : Vec3(0, 1, 0);
        const Vec3 right = glm::normalize(glm::cross(normal, other));
        const Vec3 up = glm::cross(normal, right);
        const double r = std::sqrt(u);
        const double angle = 2.0 * kPi * v;
        return glm::normalize(r * math::cos(angle) * right + r * math::sin(angle) * up +
                              std::sqrt(1.0 - u) * normal);
    }

    /// Scattered energy on its straight way to every listener in sight (Heinz 1993).
    void let_it_rain(const std::vector<Rain>& rain, Tally& tally) const {
        std::vector<geometry::Segment> ways;
        std::vector<std::pair<std::size_t, std::size_t>> which;  // of the rain, of the listener
        for (std::size_t i = 0; i < rain.size(); ++i) {
            for (std::size_t k = 0; k < listeners_.size(); ++k) {
                if (glm::dot(listeners_[k] - rain[i].from, rain[i].normal) > 0.0) {
                    ways.push_back({rain[i].from, listeners_[k]});
                    which.emplace_back(i, k);
                }
            }
        }
        const auto blocked = bvh::occluded(wide_, scene_.mesh, ways);
        for (std::size_t j = 0; j < which.size(); ++j) {
            if (blocked[j] != 0) {
                continue;
            }
            const Rain& drop = rain[which[j].first];
            const Vec3 way = listeners_[which[j].second] - drop.from;
            const double distance = glm::length(way);
            const double cosine = glm::dot(way, drop.normal) / distance;
            hear(tally.energy[which[j].second],
                 drop.travelled + distance,
                 drop.energy,
                 cosine / (kPi * distance * distance));
        }
    }

    const RayScene& scene_;
    Vec3 source_;
    std::span<const Vec3> listeners_;
    const RayOptions& options_;
    bvh::WideTree wide_;
    double speed_;
    std::size_t bins_;
    double lift_;
    std::vector<Surface> surfaces_;
    std::vector<double> radii_;
};

void check(const RayOptions& options) {
    const auto positive = [](double value) { return value > 0.0 && std::isfinite(value); };
    if (options.rays == 0) {
        throw Error("rays", "must be 1 or more");
    }
    if (!positive(options.length) || !positive(options.bin) || options.length / options.bin > 1e7) {
        throw Error("histogram", "must have a positive length and up to 10 million intervals");
    }
    if (!positive(options.receiver_radius)) {
        throw Error("receiver radius", "must be positive");
    }
    validate(options.air);
}

/// Adds up batches in their order: sums, and squares for the errors.
class Sums {
public:
    Sums(std::size_t listeners, std::size_t bins)
        : sum_(listeners, std::vector<Spectrum>(bins)), squares_(sum_) {}

    void add(const Tally& tally) {
        ++count_;
        for (std::size_t k = 0; k < sum_.size(); ++k) {
            for (std::size_t n = 0; n < sum_[k].size(); ++n) {
                for (std::size_t band = 0; band < audio::kMaxBands; ++band) {
                    const double energy = tally.energy[k][n][band];
                    sum_[k][n][band] += energy;
                    squares_[k][n][band] += energy * energy;
                }
            }
        }
    }

    /// Batches are equally large but for the last, and as good as independent.
    EnergyHistogram histogram(std::size_t listener, const RayOptions& options) const {
        EnergyHistogram result{.bin = options.bin, .energy = sum_[listener], .error = {}};
        result.error.resize(result.energy.size());
        const auto count = static_cast<double>(count_);
        const double speed = speed_of_sound(options.air);
        for (std::size_t n = 0; n < result.energy.size(); ++n) {
            const double travelled = (static_cast<double>(n) + 0.5) * options.bin * speed;
            const Spectrum air = air_pressure(options.air, options.bands, travelled);
            for (std::size_t band = 0; band < options.bands.count(); ++band) {
                const double loss = options.air_absorption ? air[band] * air[band] : 1.0;
                const double mean = result.energy[n][band] / count;
                const double variance =
                    std::max(0.0, squares_[listener][n][band] / count - mean * mean);
                result.energy[n][band] *= loss;
                result.error[n][band] =
                    count > 1.0 ? loss * count * std::sqrt(variance / (count - 1.0)) : 0.0;
            }
        }
        return result;
    }

private:
    std::vector<std::vector<Spectrum>> sum_, squares_;
    std::size_t count_ = 0;
};

}  // namespace

double late_length(const RayScene& scene,
                   const Vec3& source,
                   const RayOptions& options,
                   Executor& executor) {
    constexpr double kShortest = 0.05;  // seconds
    constexpr double kLongest = 20.0;
    constexpr double kReliable = 1e-5;  // of the energy: far above what the roulette disturbs
    constexpr double kWanted = -6.5;    // decades
    RayOptions few = options;
    few.rays = std::min<std::size_t>(options.rays, 512);
    few.bin = kLongest;
    for (few.length = kShortest; few.length < kLongest; few.length *= 1.5) {
        const EnergyBalance balance = trace_late_rays(scene, source, {}, few, executor).balance;
        double left = 0.0;
        for (std::size_t band = 0; band < options.bands.count(); ++band) {
            left = std::max(left, balance.left[band] / balance.emitted[band]);
        }
        if (left < kReliable) {
            const double decades = left > 0.0 ? std::min(math::log10(left), -5.0) : kWanted;
            return std::clamp(few.length * std::max(1.0, kWanted / decades), kShortest, kLongest);
        }
    }
    return kLongest;
}

LateEnergy trace_late_rays(const RayScene& scene,
                           const Vec3& source,
                           std::span<const Vec3> listeners,
                           const RayOptions& options,
                           Executor& executor) {
    check(options);
    const Tracer tracer(scene, source, listeners, options, executor);
    Sums sums(listeners.size(), tracer.bins());
    LateEnergy result;
    const auto add = [](Spectrum& sum, const Spectrum& part) {
        for (std::size_t band = 0; band < sum.size(); ++band) {
            sum[band] += part[band];
        }
    };
    // A few batches at a time, so that memory does not grow with their number.
    constexpr std::size_t kRound = 32;
    const std::size_t batches = chunk_count(options.rays, kBatch);
    for (std::size_t first = 0; first < batches; first += kRound) {
        std::vector<Tally> tallies(std::min(kRound, batches - first));
        executor.for_each(tallies.size(), 1, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                const std::size_t from = kBatch * (first + i);
                tallies[i] = tracer.trace(from, std::min(from + kBatch, options.rays));
            }
        });
        for (const Tally& tally : tallies) {
            sums.add(tally);
            add(result.balance.emitted, tally.balance.emitted);
            add(result.balance.absorbed, tally.balance.absorbed);
            add(result.balance.escaped, tally.balance.escaped);
            add(result.balance.left, tally.balance.left);
            result.balance.bounces += tally.balance.bounces;
        }
    }
    for (std::size_t k = 0; k < listeners.size(); ++k) {
        result.listeners.push_back(sums.histogram(k, options));
    }
    return result;
}

}  // namespace earshot::propagation
