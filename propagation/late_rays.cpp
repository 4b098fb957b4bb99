// SPDX-License-Identifier: MIT
#include "earshot/propagation/late_rays.h"

#include "earshot/base/error.h"
#include "earshot/base/math.h"
#include "earshot/base/stage_progress.h"
#include "earshot/propagation/internal/ray_tracer.h"

#include <algorithm>
#include <cmath>

namespace earshot::propagation {

using audio::EnergyHistogram;
using audio::Spectrum;
using geometry::Vec3;

namespace {

// Rays of a batch are traced together, so that the hierarchy answers many at a time.
constexpr std::size_t kBatchSize = 1024;

void check(const RayOptions& options) {
    const auto positive = [](double value) { return value > 0.0 && std::isfinite(value); };
    if (options.rays == 0) {
        throw Error("rays", "must be 1 or more");
    }
    if (!positive(options.length) || !positive(options.bin) || options.length / options.bin > 1e7) {
        throw Error("histogram", "must have a positive length and up to 10 million intervals");
    }
    if (options.receiver_radius != 0.0 && !positive(options.receiver_radius)) {
        throw Error("receiver radius", "cannot be negative");
    }
    validate(options.air);
}

/// Adds up batches in their order: sums, and squares for the errors.
class Sums {
public:
    explicit Sums(const RayOptions& options) : options_(options) {}

    void add(const RayTally& tally) {
        ++count_;
        energy_.resize(tally.energy.size(), 0.0);
        squares_.resize(tally.energy.size(), 0.0);
        directions_.resize(tally.directions.size(), 0.0);
        for (std::size_t i = 0; i < energy_.size(); ++i) {
            energy_[i] += tally.energy[i];
            squares_[i] += tally.energy[i] * tally.energy[i];
        }
        for (std::size_t i = 0; i < directions_.size(); ++i) {
            directions_[i] += tally.directions[i];
        }
        cubed_first_legs_ += tally.cubed_first_distances;
        add(tally.balance.emitted, balance_.emitted);
        add(tally.balance.absorbed, balance_.absorbed);
        add(tally.balance.escaped, balance_.escaped);
        add(tally.balance.remaining, balance_.remaining);
        add(tally.balance.roulette_surplus, balance_.roulette_surplus);
        balance_.bounces += tally.balance.bounces;
    }

    const EnergyBalance& balance() const { return balance_; }
    /// Of a sphere of solid angle, a ray a cone.
    double visible_volume() const {
        return 4.0 / 3.0 * math::kPi / static_cast<double>(options_.rays) * cubed_first_legs_;
    }

    /// Batches are equally large but for the last, and as good as independent.
    EnergyHistogram histogram(std::size_t listener, std::size_t bins, std::size_t spans) const {
        EnergyHistogram result{.bin = options_.bin,
                               .energy = std::vector<Spectrum>(bins),
                               .error = std::vector<Spectrum>(bins)};
        const std::size_t bands = options_.bands.count();
        const auto count = static_cast<double>(count_);
        const double speed = speed_of_sound(options_.air);
        for (std::size_t n = 0; n < bins; ++n) {
            const double travelled = (static_cast<double>(n) + 0.5) * options_.bin * speed;
            const Spectrum air = air_pressure(options_.air, options_.bands, travelled);
            for (std::size_t band = 0; band < bands; ++band) {
                const std::size_t i = (listener * bins + n) * bands + band;
                const double loss = options_.air_absorption ? air[band] * air[band] : 1.0;
                const double mean = energy_[i] / count;
                const double variance = std::max(0.0, squares_[i] / count - mean * mean);
                result.energy[n][band] = loss * energy_[i];
                result.error[n][band] =
                    count > 1.0 ? loss * count * std::sqrt(variance / (count - 1.0)) : 0.0;
            }
        }
        if (options_.report_directions) {
            result.directions.resize(spans);
            const double* from =
                directions_.data() + listener * spans * audio::kDirectionParts * bands;
            for (auto& parts : result.directions) {
                for (Spectrum& part : parts) {
                    std::copy_n(from, bands, part.begin());
                    from += bands;
                }
            }
        }
        // Images of a room of volume V lie one to each V (Kuttruff 2009, section 4.2).
        if (visible_volume() > 0.0) {
            result.reflection_growth = 4.0 * math::kPi * speed * speed * speed / visible_volume();
        }
        return result;
    }

private:
    static void add(const Spectrum& part, Spectrum& sum) {
        for (std::size_t band = 0; band < sum.size(); ++band) {
            sum[band] += part[band];
        }
    }

    const RayOptions& options_;
    std::vector<double> energy_, squares_, directions_;  // as in RayTally
    EnergyBalance balance_;
    double cubed_first_legs_ = 0.0;
    std::size_t count_ = 0;
};

}  // namespace

double late_length(const RayScene& scene,
                   const RaySource& source,
                   const RayOptions& options,
                   Executor& executor) {
    constexpr double kMinLength = 0.05;  // seconds
    constexpr double kMaxLength = 20.0;
    constexpr double kReliable = 1e-5;  // of the energy: far above the threshold of the roulette
    constexpr double kWanted = -6.5;    // decades
    RayOptions few = options;
    few.rays = std::min<std::size_t>(options.rays, 512);
    few.bin = kMaxLength;
    for (few.length = kMinLength; few.length < kMaxLength; few.length *= 1.5) {
        const EnergyBalance balance = trace_late_rays(scene, source, {}, few, executor).balance;
        double left = 0.0;
        for (std::size_t band = 0; band < options.bands.count(); ++band) {
            left = std::max(left, balance.remaining[band] / balance.emitted[band]);
        }
        if (left < kReliable) {
            const double decades = left > 0.0 ? std::min(math::log10(left), -5.0) : kWanted;
            return std::clamp(
                few.length * std::max(1.0, kWanted / decades), kMinLength, kMaxLength);
        }
    }
    return kMaxLength;
}

LateEnergy trace_late_rays(const RayScene& scene,
                           const RaySource& source,
                           std::span<const Vec3> listeners,
                           const RayOptions& options,
                           Executor& executor,
                           Progress* progress) {
    check(options);
    const RayTracer tracer(scene, source, listeners, options, executor);
    Sums sums(options);
    // A few batches at a time, so that memory does not grow with their number.
    const std::size_t round = 2 * static_cast<std::size_t>(executor.threads());
    const std::size_t batches = chunk_count(options.rays, kBatchSize);
    StageProgress traced(progress, "late rays", options.rays);
    for (std::size_t first = 0; first < batches; first += round) {
        std::vector<RayTally> tallies(std::min(round, batches - first));
        executor.for_each(tallies.size(), 1, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                const std::size_t from = kBatchSize * (first + i);
                const std::size_t end_of_batch = std::min(from + kBatchSize, options.rays);
                tallies[i] = tracer.trace(from, end_of_batch);
                traced.add(end_of_batch - from);
            }
        });
        for (const RayTally& tally : tallies) {
            sums.add(tally);
        }
    }
    LateEnergy result;
    result.balance = sums.balance();
    result.visible_volume = sums.visible_volume();
    for (std::size_t k = 0; k < listeners.size(); ++k) {
        result.listeners.push_back(sums.histogram(k, tracer.bins(), tracer.spans()));
    }
    return result;
}

}  // namespace earshot::propagation
