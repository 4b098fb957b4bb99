// SPDX-License-Identifier: MIT
#include "earshot/propagation/late_rays.h"

#include "earshot/base/error.h"
#include "earshot/base/math.h"
#include "earshot/base/random.h"
#include "earshot/propagation/internal/listener_sums.h"
#include "earshot/propagation/internal/ray_tracer.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <mutex>
#include <utility>

namespace earshot::propagation {

using audio::EnergyHistogram;
using audio::Spectrum;
using geometry::Vec3;

namespace {

void add(double weight, const Spectrum& part, Spectrum& sum) {
    for (std::size_t band = 0; band < sum.size(); ++band) {
        sum[band] += weight * part[band];
    }
}

void add(double weight, const EnergyBalance& part, EnergyBalance& sum) {
    add(weight, part.emitted, sum.emitted);
    add(weight, part.absorbed, sum.absorbed);
    add(weight, part.escaped, sum.escaped);
    add(weight, part.remaining, sum.remaining);
    add(weight, part.roulette_surplus, sum.roulette_surplus);
    sum.bounces += part.bounces;
}

/// How the rays are divided into batches, and when a listener has enough of them.
class Batches {
public:
    explicit Batches(const RayOptions& options)
        : max_error_(options.max_error),
          rays_(options.rays),
          count_(max_error_ > 0.0
                     ? std::max<std::size_t>(rays_ / kMaxBatchRays, 2)
                     : std::max(chunk_count(rays_, kMaxBatchRays), std::min(rays_, kMinBatches))) {}

    std::size_t count() const { return count_; }
    std::size_t rays_of(std::size_t batch) const {
        return max_error_ > 0.0 ? kMaxBatchRays : rays_ / count_ + (batch < rays_ % count_ ? 1 : 0);
    }
    std::size_t rays() const { return max_error_ > 0.0 ? count_ * kMaxBatchRays : rays_; }

    /// Whether errors are looked at after `done` batches: few looks at growing numbers (16, 32, 48,
    /// 64, 96, 128, ...), so that chance does not end the search.
    bool is_look(std::size_t done) const {
        const std::size_t third = done % 3 == 0 && done > kFewBatches ? done / 3 : done;
        return max_error_ > 0.0 &&
               (done == count_ || (done >= kFewBatches && std::has_single_bit(third)));
    }
    bool are_small(const LateErrors& errors, std::size_t done) const {
        const double caution = caution_after(done);
        return caution * errors.t30 <= max_error_ &&
               caution * errors.level_db <= kDecibelsPerShare * max_error_;
    }
    /// How many batches it takes, about, where so many have these errors, which fall with the
    /// square root of their number. Precondition: an error is asked for.
    std::size_t expected(const LateErrors& errors, std::size_t done) const {
        const double ratio = caution_after(done) *
                             std::max(errors.t30, errors.level_db / kDecibelsPerShare) / max_error_;
        return static_cast<std::size_t>(std::min(
            static_cast<double>(done) * std::max(1.0, ratio * ratio), static_cast<double>(count_)));
    }
    /// The same before the first look.
    std::size_t expected() const {
        constexpr std::size_t kUsual = 64;
        return max_error_ > 0.0 ? std::min(count_, kUsual) : count_;
    }

private:
    static constexpr std::size_t kMinBatches = 4;     // so that there are standard errors
    static constexpr std::size_t kFewBatches = 16;    // whose errors are known to a fifth
    static constexpr double kDecibelsPerShare = 5.0;  // 0.1 dB for 2 %

    /// For the errors' own error, and skewness.
    static double caution_after(std::size_t done) { return done > kFewBatches ? 1.3 : 2.0; }

    double max_error_;
    std::size_t rays_, count_;
};

/// Reports rays; how many there will be is found out on the way.
class RayProgress {
public:
    RayProgress(Progress* progress, std::size_t total) : progress_(progress), total_(total) {
        add(0);
    }

    /// Callable from any thread.
    void add(std::size_t rays) {
        if (progress_ != nullptr) {
            const std::lock_guard lock(mutex_);
            done_ += rays;
            total_ = std::max(total_, done_);
            progress_->report("late rays", done_, total_);
        }
    }
    void expect(std::size_t total) {
        const std::lock_guard lock(mutex_);
        total_ = std::max(total, done_);
    }
    /// The last report tells as many rays as there were. To call when no thread adds any more.
    void finish() {
        if (total_ != done_) {
            expect(0);
            add(0);
        }
    }

private:
    Progress* progress_;
    std::size_t done_ = 0, total_;
    std::mutex mutex_;
};

/// Traces batches and adds them up, listener by listener.
class Experiment {
public:
    Experiment(const RayTracer& tracer, std::size_t listeners, const RayOptions& options)
        : tracer_(tracer),
          options_(options),
          batches_(options),
          air_loss_(air_losses(options, listeners > 0 ? tracer.bins() : 0)),
          is_active_(listeners, 1),
          end_(listeners, 0),
          expected_(listeners, batches_.expected()) {
        for (std::size_t k = 0; k < listeners; ++k) {
            sums_.emplace_back(options,
                               air_loss_,
                               k,
                               tracer.bins(),
                               tracer.direction_intervals(),
                               tracer.reported_materials());
        }
    }

    void run(Executor& executor, Progress* progress) {
        // A few batches at a time, so that memory does not grow with their number.
        const std::size_t round = 2 * static_cast<std::size_t>(executor.threads());
        RayProgress traced(progress, batches_.expected() * batches_.rays() / batches_.count());
        while (!is_over_ && done_ < batches_.count()) {
            std::vector<BatchResult> results(std::min(round, batches_.count() - done_));
            executor.for_each(results.size(), 1, [&](std::size_t begin, std::size_t end) {
                for (std::size_t i = begin; i < end; ++i) {
                    results[i] = tracer_.trace(done_ + i, batches_.rays_of(done_ + i), is_active_);
                    traced.add(batches_.rays_of(done_ + i));
                }
            });
            executor.for_each(sums_.size(), kListenersPerTask, [&](std::size_t k, std::size_t end) {
                for (; k < end; ++k) {
                    add_to_listener(k, results);
                }
            });
            for (std::size_t i = 0; i < results.size() && !is_over_; ++i) {
                add_batch(results[i]);
            }
            if (!expected_.empty() && options_.max_error > 0.0) {
                traced.expect(*std::max_element(expected_.begin(), expected_.end()) *
                              kMaxBatchRays);
            }
        }
        traced.finish();
    }

    LateTotals totals() const {
        LateTotals totals{.visible_volume = visible_volume_ / volume_rays_};
        add(1.0 / rays_, balance_, totals.balance);
        return totals;
    }

    LateSound result_of(std::size_t k) const {
        LateSound result{.histogram = sums_[k].histogram(),
                         .errors = sums_[k].errors(),
                         .replicates = sums_[k].replicates()};
        if (options_.report_materials) {
            result.materials = sums_[k].materials();
        }
        // Images of a room of volume V lie one to each V (Kuttruff 2009, section 4.2).
        const double volume = visible_volume_ / volume_rays_;
        result.visible_volume = volume;
        const double speed = speed_of_sound(options_.air);
        if (volume > 0.0) {
            result.histogram.reflection_growth = 4.0 * math::kPi * speed * speed * speed / volume;
        }
        result.errors.reached = options_.max_error == 0.0 || is_active_[k] == 0;
        return result;
    }

private:
    static constexpr std::size_t kListenersPerTask = 8;

    /// Adds the batches after the first done_ ones, up to the one at which the listener has enough.
    void add_to_listener(std::size_t k, std::span<const BatchResult> results) {
        for (std::size_t i = 0; i < results.size() && is_active_[k] != 0; ++i) {
            const std::size_t done = done_ + i + 1;
            sums_[k].add(results[i], batches_.rays_of(done - 1));
            if (!batches_.is_look(done)) {
                continue;
            }
            const LateErrors errors = sums_[k].errors();
            expected_[k] = batches_.expected(errors, done);
            if (batches_.are_small(errors, done)) {
                is_active_[k] = 0;
                end_[k] = done;
            }
        }
    }

    /// What concerns no listener. The batches are over with the one at which the last listener has
    /// enough.
    void add_batch(const BatchResult& result) {
        const std::size_t rays = batches_.rays_of(done_);
        const auto weight = static_cast<double>(rays);
        ++done_;
        rays_ += weight;
        add(weight, result.balance, balance_);
        // Of the first batches alone where the number of batches is open, so that the answer of a
        // listener does not depend on that of others.
        constexpr std::size_t kVolumeBatches = 16;
        if (options_.max_error == 0.0 || done_ <= kVolumeBatches) {
            visible_volume_ += weight * result.visible_volume;
            volume_rays_ += weight;
        }
        is_over_ =
            batches_.is_look(done_) && std::all_of(end_.begin(), end_.end(), [&](std::size_t end) {
                return end != 0 && end <= done_;
            });
    }

    const RayTracer& tracer_;
    const RayOptions& options_;
    Batches batches_;
    std::vector<double> air_loss_;  // of all listeners
    std::vector<ListenerSums> sums_;
    std::vector<std::uint8_t> is_active_;  // per listener: it needs more batches
    std::vector<std::size_t> end_;         // per listener: batches that it has; 0: not known yet
    std::vector<std::size_t> expected_;    // per listener: batches that it needs, about
    EnergyBalance balance_;                // times the rays
    double visible_volume_ = 0.0;          // times volume_rays_
    double volume_rays_ = 0.0, rays_ = 0.0;
    std::size_t done_ = 0;  // batches
    bool is_over_ = false;
};

/// The window for the decay of a few rays with random numbers of their own.
WeightWindow find_weight_window(const RayScene& scene,
                                const RaySource& source,
                                const RayOptions& options,
                                Executor& executor) {
    constexpr std::size_t kParts = 8;  // of the length
    constexpr std::uint64_t kPilotStream = (std::uint64_t{1} << 60);
    RayOptions few = options;
    few.rays = 512;
    few.max_error = 0.0;
    few.report_materials = false;
    few.decay_time = 0.0;
    few.seed = random_bits(options.seed, kPilotStream, 0);
    few.bin = options.length;
    RayTracer tracer(scene, source, {}, few, executor);
    std::vector<Spectrum> decay;
    for (std::size_t part = 1; part <= kParts; ++part) {
        few.length = options.length * static_cast<double>(part) / kParts;
        tracer.set_length();
        Experiment experiment(tracer, 0, few);
        experiment.run(executor, nullptr);
        const EnergyBalance balance = experiment.totals().balance;
        Spectrum& left = decay.emplace_back();
        for (std::size_t band = 0; band < options.bands.count(); ++band) {
            left[band] = balance.remaining[band] / balance.emitted[band];
        }
    }
    return WeightWindow(decay, options.bands, speed_of_sound(options.air) * options.length);
}

}  // namespace

void validate(const RayOptions& options) {
    const auto positive = [](double value) { return value > 0.0 && std::isfinite(value); };
    if (options.rays == 0) {
        throw Error("rays", "must be 1 or more");
    }
    if (!positive(options.length) || !positive(options.bin) || options.length / options.bin > 1e7) {
        throw Error("histogram", "must have a positive length and up to 10 million intervals");
    }
    if (!(options.max_error >= 0.0 && options.max_error <= 1.0)) {
        throw Error("error of rays", "must lie in 0 ... 100 %");
    }
    if (!(options.rain_radius > 0.0)) {
        throw Error("radius of diffuse rain", "must be positive");
    }
    if (!positive(options.receiver_radius)) {
        throw Error("receiver radius", "must be positive");
    }
    validate(options.air);
}

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
    few.max_error = 0.0;
    few.report_materials = false;
    few.bin = kMaxLength;
    few.length = kMinLength;
    validate(few);
    // One tracer for all lengths, which refers to the options.
    RayTracer tracer(scene, source, {}, few, executor);
    for (; few.length < kMaxLength; few.length *= 1.5) {
        tracer.set_length();
        Experiment experiment(tracer, 0, few);
        experiment.run(executor, nullptr);
        const EnergyBalance balance = experiment.totals().balance;
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

LateTotals visit_late_sound(const RayScene& scene,
                            const RaySource& source,
                            std::span<const Vec3> listeners,
                            const VisitLateSound& visit,
                            const RayOptions& options,
                            Executor& executor,
                            Progress* progress) {
    validate(options);
    RayTracer tracer(scene, source, listeners, options, executor);
    if (options.weight_window) {
        tracer.set_weight_window(find_weight_window(scene, source, options, executor));
    }
    Experiment experiment(tracer, listeners.size(), options);
    experiment.run(executor, progress);
    executor.for_each(listeners.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
            visit(k, experiment.result_of(k));
        }
    });
    return experiment.totals();
}

LateEnergy trace_late_rays(const RayScene& scene,
                           const RaySource& source,
                           std::span<const Vec3> listeners,
                           const RayOptions& options,
                           Executor& executor,
                           Progress* progress) {
    LateEnergy result;
    result.listeners.resize(listeners.size());
    result.errors.resize(listeners.size());
    result.replicates.resize(listeners.size());
    result.materials.resize(options.report_materials ? listeners.size() : 0);
    const auto keep = [&](std::size_t k, LateSound&& sound) {
        result.listeners[k] = std::move(sound.histogram);
        result.errors[k] = sound.errors;
        result.replicates[k] = std::move(sound.replicates);
        if (options.report_materials) {
            result.materials[k] = std::move(sound.materials);
        }
    };
    const LateTotals totals =
        visit_late_sound(scene, source, listeners, keep, options, executor, progress);
    result.balance = totals.balance;
    result.visible_volume = totals.visible_volume;
    return result;
}

}  // namespace earshot::propagation
