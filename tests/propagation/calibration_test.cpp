// SPDX-License-Identifier: MIT
// Absorption fitted to metrics of rooms whose absorption is known.
#include "earshot/propagation/calibration.h"

#include "earshot/base/error.h"
#include "earshot/propagation/internal/identifiability.h"
#include "earshot/propagation/internal/ray_covariance.h"
#include "earshot/propagation/least_squares.h"

#include <gtest/gtest.h>

#include "calibration_room.h"
#include "calibration_statistic.h"
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

namespace earshot::propagation {
namespace {

// Indices into audio::kBandMetricKinds.
constexpr std::size_t kEdt = 0, kT30 = 2, kC80 = 4, kTs = 6, kG = 7;
constexpr std::size_t kBand500 = 4;

#define REQUIRE_SOLVER()                       \
    if (!least_squares_available()) {          \
        GTEST_SKIP() << "built without Ceres"; \
    }

Options simulation(std::size_t rays, std::uint64_t seed) {
    return {.specular_order = 2, .rays = rays, .seed = seed};
}

double true_absorption(const Scene& truth, std::size_t material, std::size_t band) {
    return truth.materials[material].absorption.over(calibration_bands())[band];
}

TEST(CoefficientPrior, ScaleOfSpreadsHasTheSpreadAsItsDerivative) {
    for (const Coefficient of : {Coefficient::absorption, Coefficient::scattering}) {
        for (double value = 0.002; value < 1.0; value += 0.013) {
            const double position = to_spread_scale(of, value);
            EXPECT_NEAR(from_spread_scale(of, position), value, 1e-12);
            constexpr double kStep = 1e-5;
            const double slope = (from_spread_scale(of, position + kStep) -
                                  from_spread_scale(of, position - kStep)) /
                                 (2.0 * kStep);
            // Half a step at the kinks of the spread.
            const double spread = coefficient_spread(of, value);
            EXPECT_NEAR(slope, spread, 1e-5 * spread);
        }
    }
}

// Two parameters of which the data tell the sum alone, a third that they tell, and two of which
// they tell nothing.
TEST(Identifiability, NamesWhatTheDataDoNotPart) {
    // Information J^T J in units of the priors; with that of the priors, 1, it is inverted by hand:
    // (1, 1) / sqrt 2 has 1 + 2 * 50, (1, -1) / sqrt 2 has 1, the third 1 + 99.
    const double sum = 1.0 / 101.0, difference = 1.0;
    std::vector<double> covariance(25, 0.0);
    const auto at = [&](std::size_t i, std::size_t j) -> double& { return covariance[5 * i + j]; };
    at(0, 0) = at(1, 1) = 0.5 * (sum + difference);
    at(0, 1) = at(1, 0) = 0.5 * (sum - difference);
    at(2, 2) = 0.01;
    at(3, 3) = at(4, 4) = 1.0;
    const Identifiability data(covariance, 5);
    const std::vector<std::vector<std::size_t>> expected = {{0, 1}, {3}, {4}};
    EXPECT_EQ(data.groups(), expected);
    const std::vector<double> known = data.known_direction(expected[0]);
    EXPECT_NEAR(known[0], known[1], 1e-12);
    EXPECT_NEAR(data.told_parameters(), 0.99 + 100.0 / 101.0, 1e-9);
    EXPECT_NEAR(data.data_variance_of(2), 1.0 / 99.0, 1e-12);
    EXPECT_EQ(data.data_variance_of(0), std::numeric_limits<double>::infinity());
    // Four times the variance of the data: a quarter of their information.
    const Identifiability scaled(covariance, 5, 4.0);
    EXPECT_NEAR(scaled.variance_of(2), 1.0 / (1.0 + 99.0 / 4.0), 1e-12);
}

// Deviations of known covariance: a part that all pairs share, and a part of each.
TEST(RayCovariance, FindsWhatPairsShare) {
    constexpr std::size_t kPairs = 20, kReplicates = 64;
    std::vector<std::vector<MetricVector>> deviations(kPairs);
    for (std::size_t r = 0; r < kReplicates; ++r) {
        const double shared = test::random_normal(1, 0, r);
        for (std::size_t pair = 0; pair < kPairs; ++pair) {
            MetricVector step{};
            step[kT30] = 0.6 * shared + 0.8 * test::random_normal(2 + pair, 0, r);
            step[kG] = 2.0 * test::random_normal(50 + pair, 0, r);
            deviations[pair].push_back(step);
        }
    }
    const RayCovariance found(deviations);
    // Of a mean of 64; the part in common is known to a quarter or so.
    EXPECT_NEAR(kReplicates * found.covariance(3, kT30, 3, kT30), 1.0, 0.25);
    EXPECT_NEAR(kReplicates * found.covariance(3, kT30, 4, kT30), 0.36, 0.18);
    EXPECT_NEAR(kReplicates * found.covariance(3, kG, 3, kG), 4.0, 1.0);
    EXPECT_NEAR(kReplicates * found.covariance(3, kG, 4, kG), 0.0, 0.4);
    EXPECT_NEAR(kReplicates * found.covariance(3, kG, 3, kT30), 0.0, 0.4);
}

// Without noise and with the same random numbers the truth explains everything.
TEST(Calibration, FindsTheAbsorptionThatMadeTheMeasurements) {
    REQUIRE_SOLVER();
    const Scene truth = calibration_room();
    const auto exact = expected_metrics(truth, simulation(1024, 1));
    std::vector<MeasuredMetric> measured =
        measured_metrics(truth, exact, exact, {kEdt, kT30, kC80, kTs, kG}, {kBand500}, 0);
    for (MeasuredMetric& value : measured) {
        value.error = 0.002 * (audio::kBandMetricKinds[value.kind].relative ? value.value : 1.0);
    }
    Scene scene = with_wrong_absorption(truth, 3);
    const CalibrationResult result = calibrate_materials(
        scene, measured, {.simulation = simulation(1024, 1), .max_simulations = 6});
    const CalibratedBand& band = result.bands[kBand500];
    EXPECT_EQ(band.values, measured.size());
    EXPECT_GT(band.before, 0.5);
    EXPECT_LT(band.after, 0.1 * band.before);
    for (std::size_t material = 0; material < truth.materials.size(); ++material) {
        const FittedCoefficient& fitted = result.absorption[material][kBand500];
        EXPECT_TRUE(fitted.is_fitted);
        EXPECT_LT(std::abs(fitted.value - true_absorption(truth, material, kBand500)),
                  0.005 + 2.5 * fitted.error)
            << truth.materials[material].name;
        EXPECT_LE(fitted.lower, fitted.value);
        EXPECT_GE(fitted.upper, fitted.value);
        // Other bands are not measured.
        EXPECT_FALSE(result.absorption[material][kBand500 + 1].is_fitted);
        EXPECT_EQ(result.absorption[material][kBand500 + 1].value,
                  true_absorption(scene, material, kBand500 + 1));
    }
    // Simulating what was found gives what the result says.
    scene.materials = calibrated_materials(scene, result, calibration_bands());
    const auto again = expected_metrics(scene, simulation(1024, 1));
    for (const CalibratedMetric& metric : result.metrics) {
        const std::size_t pair =
            metric.measured.source * scene.listeners.size() + metric.measured.listener;
        const auto kind = audio::kBandMetricKinds[metric.measured.kind].value;
        EXPECT_NEAR(*metric.after,
                    (again[pair].bands[kBand500].*kind).value(),
                    0.2 * metric.just_noticeable_difference);
    }
}

// Without noise; random decisions fall otherwise with other scattering.
TEST(Calibration, FindsTheScatteringThatMadeTheMeasurements) {
    REQUIRE_SOLVER();
    const Scene truth = calibration_room();
    const auto exact = expected_metrics(truth, simulation(4096, 1));
    const auto measured =
        measured_metrics(truth, exact, exact, {kEdt, kT30, kC80, kTs, kG}, {kBand500}, 0);
    const Scene scene = with_wrong_scattering(truth, 3);
    const CalibrationResult result = calibrate_materials(
        scene, measured, {.simulation = simulation(4096, 1), .fit_scattering = true});
    const CalibratedBand& band = result.bands[kBand500];
    EXPECT_LT(band.after, 0.8 * band.before);
    ASSERT_EQ(result.scattering.size(), truth.materials.size());
    double before = 0.0, after = 0.0;  // squared distances from the truth in spreads
    for (std::size_t material = 0; material < truth.materials.size(); ++material) {
        const FittedCoefficient& fitted = result.scattering[material][kBand500];
        EXPECT_TRUE(fitted.is_fitted);
        EXPECT_LE(fitted.lower, fitted.value);
        EXPECT_GE(fitted.upper, fitted.value);
        const double true_value =
            truth.materials[material].scattering.over(calibration_bands())[kBand500];
        EXPECT_LT(std::abs(fitted.value - true_value), 0.005 + 3.0 * fitted.error)
            << truth.materials[material].name;
        const auto squared = [&](double value) {
            const double spreads = to_spread_scale(Coefficient::scattering, value) -
                                   to_spread_scale(Coefficient::scattering, true_value);
            return spreads * spreads;
        };
        before += squared(fitted.prior.mean);
        after += squared(fitted.value);
        // Other bands are not measured.
        const FittedCoefficient& other = result.scattering[material][kBand500 + 1];
        EXPECT_FALSE(other.is_fitted);
        EXPECT_EQ(other.value, other.prior.mean);
    }
    EXPECT_LT(after, 0.7 * before);
    const Material floor = calibrated_materials(scene, result, calibration_bands())[0];
    EXPECT_EQ(floor.scattering.over(calibration_bands())[kBand500],
              result.scattering[0][kBand500].value);
}

TEST(Calibration, TakesScatteringOfNothingAsUnknown) {
    REQUIRE_SOLVER();
    Scene truth = calibration_room();
    const auto exact = expected_metrics(truth, simulation(512, 1));
    const auto measured = measured_metrics(truth, exact, exact, {kT30}, {kBand500}, 0);
    truth.materials[0].scattering = truth.materials[1].scattering = EnergyCoefficient(0.0);
    const CalibrationResult result = calibrate_materials(truth,
                                                         measured,
                                                         {.simulation = simulation(512, 1),
                                                          .fit_scattering = true,
                                                          .fixed_materials = {0},
                                                          .max_simulations = 1});
    EXPECT_EQ(result.scattering[0][kBand500].value, 0.0);
    EXPECT_FALSE(result.scattering[0][kBand500].is_fitted);
    EXPECT_EQ(result.scattering[1][kBand500].prior.mean, kUnknownScattering);
    EXPECT_EQ(result.scattering[1][kBand500].prior.deviation, kUnknownDeviation);
    EXPECT_EQ(result.scattering[2][kBand500].prior.deviation, 1.0);
    // One metric tells scattering from absorption nowhere.
    ASSERT_FALSE(result.groups.empty());
    EXPECT_TRUE(
        std::any_of(result.groups.begin(), result.groups.end(), [](const UnidentifiedGroup& group) {
            return !group.scattering.empty() && group.weights.empty();
        }));
}

TEST(Calibration, IsTheSameForAnyThreads) {
    REQUIRE_SOLVER();
    const Scene truth = calibration_room();
    const auto exact = expected_metrics(truth, simulation(512, 1));
    const auto measured = measured_metrics(truth, exact, exact, {kT30, kC80}, {3, 4}, 5);
    const CalibrationOptions options = {.simulation = simulation(512, 2), .max_simulations = 2};
    Executor executor(3);
    const CalibrationResult one = calibrate_materials(truth, measured, options);
    const CalibrationResult many = calibrate_materials(truth, measured, options, executor);
    for (std::size_t material = 0; material < truth.materials.size(); ++material) {
        for (std::size_t band = 0; band < calibration_bands().count(); ++band) {
            EXPECT_EQ(one.absorption[material][band].value, many.absorption[material][band].value);
            EXPECT_EQ(one.absorption[material][band].error, many.absorption[material][band].error);
        }
    }
    for (std::size_t i = 0; i < measured.size(); ++i) {
        EXPECT_EQ(one.metrics[i].after, many.metrics[i].after);
    }
}

// One wild value of fifty moves nothing by much, and is told.
TEST(Calibration, DoesNotFollowOutliers) {
    REQUIRE_SOLVER();
    const Scene truth = calibration_room();
    const auto exact = expected_metrics(truth, simulation(1024, 1));
    std::vector<MeasuredMetric> measured =
        measured_metrics(truth, exact, exact, {kEdt, kT30, kC80, kG}, {kBand500}, 9);
    const CalibrationOptions options = {.simulation = simulation(1024, 1), .max_simulations = 2};
    const CalibrationResult before = calibrate_materials(truth, measured, options);
    MeasuredMetric& wild = measured[kC80];
    wild.value += 40.0 * *wild.error;
    const CalibrationResult after = calibrate_materials(truth, measured, options);
    EXPECT_LT(after.metrics[kC80].weight, 0.2);
    EXPECT_TRUE(std::any_of(after.warnings.begin(), after.warnings.end(), [](const Warning& w) {
        return w.subject == "outliers";
    }));
    for (std::size_t material = 0; material < truth.materials.size(); ++material) {
        const FittedCoefficient& fitted = after.absorption[material][kBand500];
        EXPECT_LT(std::abs(fitted.value - before.absorption[material][kBand500].value),
                  1.5 * fitted.error);
    }
}

TEST(Calibration, KeepsFixedMaterialsAndTellsUnknownOnesApart) {
    REQUIRE_SOLVER();
    Scene truth = calibration_room();
    truth.materials[2].name = truth.materials[3].name = "wall";
    const auto exact = expected_metrics(truth, simulation(512, 1));
    const auto measured = measured_metrics(truth, exact, exact, {kT30}, {kBand500}, 0);
    const CalibrationResult result = calibrate_materials(truth,
                                                         measured,
                                                         {.simulation = simulation(512, 1),
                                                          .unknown_materials = {1},
                                                          .fixed_materials = {0},
                                                          .max_simulations = 1});
    EXPECT_FALSE(result.absorption[0][kBand500].is_fitted);
    EXPECT_EQ(result.absorption[0][kBand500].value, true_absorption(truth, 0, kBand500));
    EXPECT_EQ(result.absorption[1][kBand500].prior.deviation, kUnknownDeviation);
    EXPECT_EQ(result.absorption[2][kBand500].prior.deviation, 1.0);
    // One metric of a diffuse room tells one mean of all surfaces.
    ASSERT_FALSE(result.groups.empty());
    EXPECT_GT(result.groups.front().materials.size(), 2U);
    EXPECT_TRUE(std::any_of(result.warnings.begin(), result.warnings.end(), [](const Warning& w) {
        return w.subject == "wall" && w.what.starts_with("2 materials have this name");
    }));
}

TEST(Calibration, NeverGoesBelowTransmission) {
    REQUIRE_SOLVER();
    Scene truth = calibration_room();
    const auto exact = expected_metrics(truth, simulation(512, 1));
    std::vector<MeasuredMetric> measured =
        measured_metrics(truth, exact, exact, {kT30}, {kBand500}, 0);
    for (MeasuredMetric& value : measured) {
        value.value *= 2.0;
    }
    truth.materials[1].transmission = EnergyCoefficient(0.4);
    const CalibrationResult result = calibrate_materials(
        truth, measured, {.simulation = simulation(512, 1), .max_simulations = 2});
    EXPECT_GE(result.absorption[1][kBand500].value, 0.4);
    for (const Material& material : calibrated_materials(truth, result, calibration_bands())) {
        EXPECT_NO_THROW(validate(material));
    }
}

void expect_coverage(const Coverage& found, std::size_t min_identified) {
    EXPECT_GT(found.identified, min_identified);
    EXPECT_GE(static_cast<double>(found.identified_held),
              0.95 * static_cast<double>(found.identified) -
                  2.0 * std::sqrt(0.05 * 0.95 * static_cast<double>(found.identified)));
    EXPECT_GE(static_cast<double>(found.all_held), 0.85 * static_cast<double>(found.all));
    EXPECT_LT(found.max_deviation, 4.0);
}

// Two bands of six seeds: some forty intervals, of which one in twenty should miss the truth, and
// more than five do in one of forty runs. bench_calibration runs the full statistic.
TEST(SlowCalibration, IntervalsHoldTheTruth) {
    REQUIRE_SOLVER();
    Executor executor;
    const CalibrationStatistic found =
        CalibrationCampaign(
            {.seeds = 6, .rays = 32768, .truth_rays = 65536, .noise_rays = 1024, .bands = {3, 5}})
            .run(executor);
    expect_coverage(found.absorption, 15);
    EXPECT_NEAR(found.reduced_chi_squared, 1.0, 0.15);
}

// In a room whose decays tell the scattering of its walls, though not that of its floor.
TEST(SlowCalibration, IntervalsHoldTheTruthOfScattering) {
    REQUIRE_SOLVER();
    Executor executor;
    const CalibrationStatistic found = CalibrationCampaign({.seeds = 8,
                                                            .rays = 32768,
                                                            .noise_rays = 1024,
                                                            .bands = {3, 5},
                                                            .fit_scattering = true},
                                                           flutter_room())
                                           .run(executor);
    expect_coverage(found.scattering, 5);
    EXPECT_GE(static_cast<double>(found.absorption.all_held),
              0.85 * static_cast<double>(found.absorption.all));
    EXPECT_NEAR(found.reduced_chi_squared, 1.0, 0.25);
}

TEST(Calibration, RefusesWhatIsOutOfRange) {
    const Scene scene = calibration_room();
    const MeasuredMetric good = {.kind = kT30, .band = 4, .value = 0.5};
    const auto fails = [&](MeasuredMetric value, const CalibrationOptions& options = {}) {
        const std::vector<MeasuredMetric> measured = {value};
        EXPECT_THROW(calibrate_materials(scene, measured, options), Error);
    };
    EXPECT_THROW(calibrate_materials(scene, {}, {}), Error);
    const auto with = [&](auto member, auto number) {
        MeasuredMetric value = good;
        value.*member = number;
        return value;
    };
    fails(with(&MeasuredMetric::source, std::size_t{2}));
    fails(with(&MeasuredMetric::listener, std::size_t{5}));
    fails(with(&MeasuredMetric::kind, std::size_t{8}));
    fails(with(&MeasuredMetric::band, std::size_t{10}));
    fails(with(&MeasuredMetric::value, std::nan("")));
    fails(with(&MeasuredMetric::value, 0.0));
    fails(with(&MeasuredMetric::error, std::optional(0.0)));
    fails(with(&MeasuredMetric::error, std::optional(std::nan(""))));
    fails(good, {.default_error = 0.0});
    fails(good, {.prior_deviation = -1.0});
    fails(good, {.fixed_materials = {8}});
    fails(good, {.max_simulations = 0});
    const std::vector<MeasuredMetric> twice = {good, good};
    EXPECT_THROW(calibrate_materials(scene, twice, {}), Error);
}

}  // namespace
}  // namespace earshot::propagation
