// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/propagation/calibration.h"

#include "calibration_room.h"
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace earshot::propagation {

/// How 95 % intervals of coefficients agree with the truth.
struct Coverage {
    std::size_t identified = 0;       ///< intervals of coefficients that the data alone tell
    std::size_t identified_held = 0;  ///< of these hold the truth
    std::size_t all = 0;              ///< of all coefficients that were fitted
    std::size_t all_held = 0;
    double max_deviation = 0.0;  ///< largest distance from the truth in standard errors, identified

    void add(const FittedCoefficient& fitted, double truth) {
        const bool holds = fitted.lower <= truth && truth <= fitted.upper;
        ++all;
        all_held += holds ? 1 : 0;
        if (fitted.is_identified()) {
            ++identified;
            identified_held += holds ? 1 : 0;
            const Coefficient of = fitted.prior.of;
            const double spreads = to_spread_scale(of, fitted.value) - to_spread_scale(of, truth);
            max_deviation =
                std::max(max_deviation,
                         std::abs(spreads) * coefficient_spread(of, fitted.value) / fitted.error);
        }
    }
};

struct CalibrationStatistic {
    Coverage absorption{}, scattering{};
    double reduced_chi_squared = 0.0;  ///< mean of all fits
    double simulations = 0.0;          ///< mean
};

struct StatisticOptions {
    std::uint64_t first_seed = 1;
    std::uint64_t seeds = 20;
    std::size_t rays = 65536;         ///< of the calibrations
    std::size_t truth_rays = 262144;  ///< tell what is measured; a chance that no fit can know of
    std::size_t noise_rays = 2048;    ///< measurements are off by the standard errors of so many
    std::vector<std::size_t> bands{2, 3, 5, 6};
    bool fit_scattering = false;  ///< which is off then as absorption is
};

/// A room whose metrics are known, but for the noise of many rays, measured with normal errors, and
/// priors drawn about the truth: all of them, and the rays, anew for each seed.
class CalibrationCampaign {
public:
    explicit CalibrationCampaign(const StatisticOptions& options, Scene truth = calibration_room())
        : options_(options), truth_(std::move(truth)) {
        // The seeds of the truth and of the errors are not among those of the calibrations.
        constexpr std::uint64_t kTruthSeed = 1000001, kNoiseSeed = 1000002;
        exact_ = expected_metrics(truth_, simulation(options.truth_rays, kTruthSeed));
        noise_ = expected_metrics(truth_, simulation(options.noise_rays, kNoiseSeed));
    }

    CalibrationResult calibrate(std::uint64_t seed, Executor& executor) const {
        constexpr std::array<std::size_t, 7> kKinds = {0, 1, 2, 4, 5, 6, 7};  // all but C50
        const std::vector<MeasuredMetric> measured = measured_metrics(
            truth_, exact_, noise_, {kKinds.begin(), kKinds.end()}, options_.bands, seed);
        Scene scene = with_wrong_absorption(truth_, seed);
        if (options_.fit_scattering) {
            scene = with_wrong_scattering(scene, seed);
        }
        return calibrate_materials(scene,
                                   measured,
                                   {.simulation = simulation(options_.rays, seed),
                                    .fit_scattering = options_.fit_scattering},
                                   executor);
    }

    void add(const CalibrationResult& result, CalibrationStatistic& sum) const {
        for (std::size_t material = 0; material < truth_.materials.size(); ++material) {
            const Material& truth = truth_.materials[material];
            const audio::Spectrum absorption = truth.absorption.over(calibration_bands());
            const audio::Spectrum scattering = truth.scattering.over(calibration_bands());
            for (const std::size_t band : options_.bands) {
                sum.absorption.add(result.absorption[material][band], absorption[band]);
                if (options_.fit_scattering) {
                    sum.scattering.add(result.scattering[material][band], scattering[band]);
                }
            }
        }
        const auto seeds = static_cast<double>(options_.seeds);
        for (const std::size_t band : options_.bands) {
            sum.reduced_chi_squared += result.bands[band].reduced_chi_squared.value_or(0.0) /
                                       (seeds * static_cast<double>(options_.bands.size()));
        }
        sum.simulations += result.simulations / seeds;
    }

    CalibrationStatistic run(Executor& executor = Executor::serial()) const {
        CalibrationStatistic sum;
        for (std::uint64_t i = 0; i < options_.seeds; ++i) {
            add(calibrate(options_.first_seed + i, executor), sum);
        }
        return sum;
    }

private:
    static Options simulation(std::size_t rays, std::uint64_t seed) {
        return {.specular_order = 2, .rays = rays, .seed = seed};
    }

    StatisticOptions options_;
    Scene truth_;
    std::vector<audio::RoomMetrics> exact_, noise_;
};

}  // namespace earshot::propagation
