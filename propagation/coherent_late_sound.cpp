// SPDX-License-Identifier: MIT
#include "earshot/propagation/coherent_late_sound.h"

#include "earshot/base/assert.h"
#include "earshot/base/math.h"
#include "earshot/propagation/internal/listener_sums.h"
#include "earshot/propagation/internal/virtual_sources.h"
#include "earshot/propagation/late_rays.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace earshot::propagation {

using audio::EnergyHistogram;
using geometry::Vec3;

namespace {

// Strata of a decay have so many choices at least. Fewer would leave some of them to a single
// virtual source.
constexpr std::size_t kMinBudgetOfStratum = 4;

/// Validated, so that the members that follow may use them.
const RayOptions& checked(const RayOptions& options) {
    validate(options);
    return options;
}

}  // namespace

struct CoherentLateSound::State {
    explicit State(const RayOptions& the_options)
        : sources(checked(the_options)),
          bins(static_cast<std::size_t>(std::ceil(the_options.length / the_options.bin))),
          intervals(chunk_count(bins, audio::kBinsPerSpan)),
          bins_per_metre(1.0 / (speed_of_sound(the_options.air) * the_options.bin)),
          air_loss(air_losses(the_options, bins)) {}

    const RayOptions& options() const noexcept { return sources.options(); }

    /// The bin in which sound of a virtual source arrives; `bins` past the end.
    std::size_t bin_of(const VirtualSource& source, const Vec3& listener) const {
        const double travelled = source.travelled + glm::length(listener - source.position);
        const double position = travelled * bins_per_metre;
        return position < static_cast<double>(bins) ? static_cast<std::size_t>(position) : bins;
    }

    /// Importances, and the interval of each virtual source; `intervals` past the end.
    struct Importances {
        std::vector<double> importance;
        std::vector<std::size_t> interval;
    };
    Importances importances(const Vec3& listener) const {
        const std::span<const VirtualSource> list = sources.list();
        const std::size_t bands = options().bands.count();
        Importances result{std::vector<double>(list.size(), 0.0),
                           std::vector<std::size_t>(list.size(), intervals)};
        // What arrives per interval and band if nothing stands between; its inverse afterwards.
        std::vector<double> sums(intervals * bands, 0.0);
        for (std::size_t i = 0; i < list.size(); ++i) {
            const std::size_t bin = bin_of(list[i], listener);
            const double share = lambert_share(list[i], listener);
            if (bin == bins || share == 0.0) {
                continue;
            }
            result.importance[i] = share;
            result.interval[i] = bin / audio::kBinsPerSpan;
            double* sum = sums.data() + result.interval[i] * bands;
            const double* energies = sources.energies(list[i]).data();
            for (std::size_t band = 0; band < bands; ++band) {
                sum[band] += share * energies[band];
            }
        }
        for (double& sum : sums) {
            sum = sum > 0.0 ? 1.0 / (sum * static_cast<double>(bands)) : 0.0;
        }
        for (std::size_t i = 0; i < list.size(); ++i) {
            if (result.importance[i] > 0.0) {
                const double* scale = sums.data() + result.interval[i] * bands;
                const double* energies = sources.energies(list[i]).data();
                double part = 0.0;
                for (std::size_t band = 0; band < bands; ++band) {
                    part += scale[band] * energies[band];
                }
                result.importance[i] *= part;
            }
        }
        return result;
    }

    VirtualSources sources;
    std::size_t bins, intervals;
    double bins_per_metre;
    std::vector<double> air_loss;
    std::optional<bvh::MeshBvh> bvh{};
    std::vector<SamplingKey> keys{};
};

CoherentLateSound::CoherentLateSound(const RayOptions& options)
    : state_(std::make_unique<State>(options)) {}
CoherentLateSound::~CoherentLateSound() = default;
CoherentLateSound::CoherentLateSound(CoherentLateSound&&) noexcept = default;
CoherentLateSound& CoherentLateSound::operator=(CoherentLateSound&&) noexcept = default;

std::size_t CoherentLateSound::update(const RayScene& scene,
                                      const RaySource& source,
                                      Executor& executor) {
    const std::size_t traced = state_->sources.update(scene, source, executor);
    state_->bvh = scene.bvh;
    state_->keys.clear();
    for (const VirtualSource& virtual_source : state_->sources.list()) {
        state_->keys.push_back(virtual_source.key);
    }
    return traced;
}

std::size_t CoherentLateSound::virtual_sources() const noexcept {
    return state_->sources.list().size();
}

std::span<const SamplingKey> CoherentLateSound::keys() const noexcept {
    return state_->keys;
}

std::vector<double> CoherentLateSound::importances(const Vec3& listener) const {
    return state_->importances(listener).importance;
}

// Strata of successive intervals have equal parts of the budget, so that no part of the decay is
// left to chance.
std::vector<WeightedSample> CoherentLateSound::choose(const Vec3& listener,
                                                      std::size_t budget) const {
    const State& state = *state_;
    const State::Importances all = state.importances(listener);
    const std::size_t strata =
        std::clamp<std::size_t>(budget / kMinBudgetOfStratum, 1, state.intervals);
    std::vector<std::vector<std::size_t>> members(strata);
    for (std::size_t i = 0; i < all.importance.size(); ++i) {
        if (all.importance[i] > 0.0) {
            members[all.interval[i] * strata / state.intervals].push_back(i);
        }
    }
    std::vector<WeightedSample> samples;
    std::vector<double> importances;
    std::vector<SamplingKey> keys;
    for (std::size_t stratum = 0; stratum < strata; ++stratum) {
        importances.clear();
        keys.clear();
        for (const std::size_t i : members[stratum]) {
            importances.push_back(all.importance[i]);
            keys.push_back(state.keys[i]);
        }
        const std::size_t part = (stratum + 1) * budget / strata - stratum * budget / strata;
        for (const WeightedSample& sample : coherent_samples(importances, keys, part)) {
            samples.push_back({members[stratum][sample.index], sample.weight});
        }
    }
    return samples;
}

EnergyHistogram CoherentLateSound::energy_of(const Vec3& listener,
                                             std::span<const WeightedSample> samples) const {
    const State& state = *state_;
    EARSHOT_ASSERT(state.bvh);
    const std::span<const VirtualSource> list = state.sources.list();
    EnergyHistogram histogram{.bin = state.options().bin,
                              .energy = std::vector<audio::Spectrum>(state.bins),
                              .error = std::vector<audio::Spectrum>(state.bins)};
    if (state.options().report_directions) {
        histogram.directions.resize(state.intervals);
    }
    // Lines of sight of what would arrive.
    std::vector<WeightedSample> audible;
    std::vector<geometry::Segment> segments;
    std::vector<geometry::TriangleId> triangles;
    for (const WeightedSample& sample : samples) {
        const VirtualSource& source = list[sample.index];
        const double share = sample.weight * lambert_share(source, listener);
        if (share > 0.0 && state.bin_of(source, listener) < state.bins) {
            audible.push_back({sample.index, share});
            segments.push_back({source.position, listener});
            triangles.push_back(source.triangle);
        }
    }
    std::vector<std::uint8_t> occluded(segments.size());
    state.bvh->occluded(bvh::SecondarySegments{.segments = segments, .origin_triangles = triangles},
                        occluded);
    const std::size_t bands = state.options().bands.count();
    for (std::size_t j = 0; j < audible.size(); ++j) {
        if (occluded[j] != 0) {
            continue;
        }
        const VirtualSource& source = list[audible[j].index];
        const std::span<const double> energies = state.sources.energies(source);
        const std::size_t bin = state.bin_of(source, listener);
        const Vec3 from = source.position - listener;
        audio::Spectrum* part =
            state.options().report_directions
                ? &histogram.directions[bin / audio::kBinsPerSpan]
                                       [audio::direction_part({from.x, from.y, from.z})]
                : nullptr;
        for (std::size_t band = 0; band < bands; ++band) {
            const double energy = audible[j].weight * energies[band];
            histogram.energy[bin][band] += energy * state.air_loss[bin * bands + band];
            if (part != nullptr) {
                (*part)[band] += energy;
            }
        }
    }
    return histogram;
}

std::vector<EnergyHistogram> CoherentLateSound::estimate(std::span<const Vec3> listeners,
                                                         std::size_t budget,
                                                         Executor& executor) const {
    std::vector<EnergyHistogram> histograms(listeners.size());
    const double speed = speed_of_sound(state_->options().air);
    const double volume = state_->sources.visible_volume();
    executor.for_each(listeners.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
            histograms[k] = energy_of(listeners[k], choose(listeners[k], budget));
            if (volume > 0.0) {
                histograms[k].reflection_growth = 4.0 * math::kPi * speed * speed * speed / volume;
            }
        }
    });
    return histograms;
}

}  // namespace earshot::propagation
