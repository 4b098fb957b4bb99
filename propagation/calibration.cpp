// SPDX-License-Identifier: MIT
#include "earshot/propagation/calibration.h"

#include "earshot/propagation/internal/band_fit.h"
#include "earshot/propagation/internal/calibration_summary.h"
#include "earshot/propagation/internal/material_model.h"
#include "earshot/propagation/least_squares.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <utility>

namespace earshot::propagation {

namespace {

using audio::BandMetricKind;
using audio::Spectrum;

double just_noticeable_difference(const MeasuredMetric& measured) {
    const BandMetricKind& kind = audio::kBandMetricKinds[measured.kind];
    return kind.just_noticeable_difference * (kind.relative ? std::abs(measured.value) : 1.0);
}

void require_option(bool is_met, const char* name, const char* range) {
    if (!is_met) {
        throw Error("calibration", std::string(name) + " is out of range", range);
    }
}

void check(const Scene& scene,
           std::span<const MeasuredMetric> measured,
           const CalibrationOptions& options) {
    const auto is_positive = [](double value) { return value > 0.0 && std::isfinite(value); };
    require_option(is_positive(options.default_error), "default_error", "give a positive number");
    require_option(
        is_positive(options.prior_deviation), "prior_deviation", "give a positive number");
    require_option(is_positive(options.outlier_limit), "outlier_limit", "give a positive number");
    require_option(options.max_simulations >= 1, "max_simulations", "give at least 1");
    for (const auto& list : {options.unknown_materials, options.fixed_materials}) {
        for (const std::uint32_t material : list) {
            require_option(
                material < scene.materials.size(), "a material", "give indices of the scene");
        }
    }
    if (measured.empty()) {
        throw Error("calibration", "there is no measured value", "give some");
    }
    std::set<std::array<std::size_t, 4>> keys;
    for (const MeasuredMetric& value : measured) {
        require_option(value.source < scene.sources.size() &&
                           value.listener < scene.listeners.size() &&
                           value.kind < audio::kBandMetricKinds.size() &&
                           value.band < options.simulation.bands.count(),
                       "an index of a measured value",
                       "give indices of the scene, the metrics and the bands");
        // Times are never 0, and neither is an error.
        require_option(std::isfinite(value.value) && just_noticeable_difference(value) > 0.0 &&
                           (!value.error || is_positive(*value.error)),
                       "a measured value",
                       "give finite values, positive times and positive errors");
        require_option(keys.insert({value.source, value.listener, value.kind, value.band}).second,
                       "a measured value",
                       "give one value for each pair, metric and band");
    }
}

/// The scene with those sources and listeners alone that were measured.
struct MeasuredScene {
    Scene scene;
    std::vector<std::size_t> sources, listeners;  // new indices of the old ones

    MeasuredScene(const Scene& whole, std::span<const MeasuredMetric> measured) : scene(whole) {
        const auto keep = [&](std::vector<Emitter>& emitters, auto index_of) {
            std::vector<bool> is_kept(emitters.size(), false);
            for (const MeasuredMetric& value : measured) {
                is_kept[index_of(value)] = true;
            }
            std::vector<std::size_t> indices;
            std::vector<Emitter> kept;
            for (std::size_t i = 0; i < emitters.size(); ++i) {
                indices.push_back(kept.size());
                if (is_kept[i]) {
                    kept.push_back(emitters[i]);
                }
            }
            emitters = std::move(kept);
            return indices;
        };
        sources = keep(scene.sources, [](const MeasuredMetric& value) { return value.source; });
        listeners =
            keep(scene.listeners, [](const MeasuredMetric& value) { return value.listener; });
    }

    std::size_t pair_of(const MeasuredMetric& value) const {
        return sources[value.source] * scene.listeners.size() + listeners[value.listener];
    }
};

/// A coefficient that is a number in each band.
template <typename ValueOf>
EnergyCoefficient per_band(const audio::Bands& bands, ValueOf value_of) {
    std::vector<EnergyCoefficient::Point> points;
    for (std::size_t band = 0; band < bands.count(); ++band) {
        points.push_back({bands.nominal_hz()[band], value_of(band)});
    }
    return EnergyCoefficient(std::move(points));
}

/// Gives a material its absorption per band. Transmission, of which points between bands might
/// exceed it, then stands per band too.
template <typename AbsorptionOf>
void set_absorption(const audio::Bands& bands, AbsorptionOf absorption_of, Material& material) {
    const Spectrum transmitted = transmitted_energy(material, bands);
    if (*std::max_element(transmitted.begin(), transmitted.end()) > 0.0) {
        material.transmission =
            per_band(bands, [&](std::size_t band) { return transmitted[band]; });
    }
    material.absorption = per_band(bands, absorption_of);
}

bool is_fitted(std::span<const FittedCoefficient> bands) {
    return std::any_of(
        bands.begin(), bands.end(), [](const FittedCoefficient& band) { return band.is_fitted; });
}

class Calibration {
public:
    Calibration(const Scene& scene,
                std::span<const MeasuredMetric> measured,
                const CalibrationOptions& options,
                Executor& executor,
                Progress* progress)
        : scene_(scene),
          options_(options),
          bands_(options.simulation.bands),
          materials_(scene.materials.size()),
          of_scene_(scene, measured),
          executor_(executor),
          progress_(progress) {
        for (const MeasuredMetric& value : measured) {
            const double jnd = just_noticeable_difference(value);
            result_.metrics.push_back({.measured = value,
                                       .error = value.error.value_or(options.default_error * jnd),
                                       .just_noticeable_difference = jnd});
        }
        set_absorption_priors();
        if (options.fit_scattering) {
            set_scattering_priors();
        }
        group_data();
        require_parameters();
    }

    CalibrationResult run() {
        for (;;) {
            simulate();
            std::vector<BandFit> fits(bands_.count());
            executor_.for_each(bands_.count(), 1, [&](std::size_t begin, std::size_t end) {
                for (std::size_t band = begin; band < end; ++band) {
                    fits[band] = fit_band(problem_of(band));
                }
            });
            if (result_.simulations == 1) {
                read_values(fits, &CalibratedMetric::before);
            }
            // The first simulation may give listeners different numbers of rays.
            const bool is_settled =
                take(fits) && (result_.simulations > 1 || options_.simulation.max_error == 0.0);
            if (is_settled || result_.simulations == options_.max_simulations) {
                result_.converged = is_settled;
                read_fits(fits);
                read_groups(fits);
                break;
            }
        }
        summarize(scene_, bands_, result_);
        return std::move(result_);
    }

private:
    static bool contains(const std::vector<std::uint32_t>& list, std::size_t material) {
        return std::find(list.begin(), list.end(), material) != list.end();
    }

    void set_absorption_priors() {
        for (std::size_t material = 0; material < materials_; ++material) {
            const Material& target = of_scene_.scene.materials[material];
            const Spectrum absorption = target.absorption.over(bands_);
            transmitted_.push_back(transmitted_energy(target, bands_));
            auto& fitted = result_.absorption.emplace_back(bands_.count());
            coefficients_.push_back(absorption);
            const double deviation = contains(options_.unknown_materials, material)
                                         ? kUnknownDeviation
                                         : options_.prior_deviation;
            for (std::size_t band = 0; band < bands_.count(); ++band) {
                const double mean = absorption[band];
                const bool is_fixed =
                    contains(options_.fixed_materials, material) || mean > kMaxFittedAbsorption;
                set_prior({.mean = mean, .deviation = is_fixed ? 0.0 : deviation}, fitted[band]);
            }
        }
    }

    /// What absorbs everything does not scatter.
    void set_scattering_priors() {
        for (std::size_t material = 0; material < materials_; ++material) {
            Spectrum scattering = of_scene_.scene.materials[material].scattering.over(bands_);
            auto& fitted = result_.scattering.emplace_back(bands_.count());
            const bool is_kept = contains(options_.fixed_materials, material);
            const bool is_unset = *std::max_element(scattering.begin(), scattering.end()) == 0.0;
            const bool is_unknown = is_unset || contains(options_.unknown_materials, material);
            const double deviation = is_unknown ? kUnknownDeviation : options_.prior_deviation;
            for (std::size_t band = 0; band < bands_.count(); ++band) {
                const bool is_fixed =
                    is_kept || coefficients_[material][band] > kMaxFittedAbsorption;
                double& mean = scattering[band];
                if (!is_fixed) {
                    mean = std::clamp(is_unset ? kUnknownScattering : mean,
                                      kMinFittedScattering,
                                      kMaxFittedScattering);
                }
                set_prior({.of = Coefficient::scattering,
                           .mean = mean,
                           .deviation = is_fixed ? 0.0 : deviation},
                          fitted[band]);
            }
            coefficients_.push_back(scattering);
        }
    }

    static void set_prior(const CoefficientPrior& prior, FittedCoefficient& fitted) {
        fitted.prior = prior;
        read_interval(prior.deviation > 0.0 ? 1.0 : 0.0, prior.mean, fitted);
    }

    /// Of an index into coefficients_.
    std::vector<FittedCoefficient>& fitted_of(std::size_t coefficient) {
        return coefficient < materials_ ? result_.absorption[coefficient]
                                        : result_.scattering[coefficient - materials_];
    }
    const FittedCoefficient& fitted_of(std::size_t coefficient, std::size_t band) const {
        return coefficient < materials_ ? result_.absorption[coefficient][band]
                                        : result_.scattering[coefficient - materials_][band];
    }

    /// The measured values of each band, pair by pair.
    void group_data() {
        data_of_band_.resize(bands_.count());
        for (std::size_t i = 0; i < result_.metrics.size(); ++i) {
            data_of_band_[result_.metrics[i].measured.band].push_back(i);
        }
        for (std::vector<std::size_t>& data : data_of_band_) {
            std::stable_sort(data.begin(), data.end(), [&](std::size_t a, std::size_t b) {
                return of_scene_.pair_of(result_.metrics[a].measured) <
                       of_scene_.pair_of(result_.metrics[b].measured);
            });
        }
    }

    void require_parameters() const {
        for (const CalibratedMetric& metric : result_.metrics) {
            for (std::size_t i = 0; i < coefficients_.size(); ++i) {
                if (fitted_of(i, metric.measured.band).prior.deviation > 0.0) {
                    return;
                }
            }
        }
        throw Error("calibration", "there is nothing to fit", "let some material change");
    }

    void simulate() {
        Scene& scene = of_scene_.scene;
        for (std::size_t material = 0; material < materials_; ++material) {
            set_material(material, scene.materials[material]);
        }
        Options simulation = options_.simulation;
        simulation.report_paths = true;
        simulation.report_materials = true;
        simulation.report_scattering = options_.fit_scattering;
        simulation.late_directions = false;
        if (result_.simulations > 0) {
            // As many rays as the first time: the same random numbers.
            simulation.rays = result_.rays;
            simulation.max_error = 0.0;
        }
        Simulator simulator(scene, simulation, executor_);
        simulator.set_time(options_.time, executor_);
        models_.clear();
        for (PairResult& pair : simulator.run(executor_, progress_)) {
            if (result_.simulations == 0) {
                result_.rays = std::max(result_.rays, pair.late_errors.rays);
            }
            models_.emplace_back(scene, std::move(pair), bands_);
        }
        ++result_.simulations;
    }

    void set_material(std::size_t material, Material& target) const {
        const auto value_of = [&](std::size_t coefficient) {
            return
                [&values = coefficients_[coefficient]](std::size_t band) { return values[band]; };
        };
        if (options_.fit_scattering) {
            target.scattering = per_band(bands_, value_of(materials_ + material));
        }
        // Nothing changes before the first fit.
        if (result_.simulations > 0) {
            set_absorption(bands_, value_of(material), target);
        }
    }

    BandFitProblem problem_of(std::size_t band) const {
        BandFitProblem problem = {
            .band = band, .models = models_, .outlier_limit = options_.outlier_limit};
        for (const std::size_t i : data_of_band_[band]) {
            const CalibratedMetric& metric = result_.metrics[i];
            problem.data.push_back({.pair = of_scene_.pair_of(metric.measured),
                                    .kind = metric.measured.kind,
                                    .value = metric.measured.value,
                                    .error = metric.error});
        }
        for (std::size_t i = 0; i < coefficients_.size(); ++i) {
            problem.coefficients.push_back(coefficients_[i][band]);
            problem.priors.push_back(fitted_of(i, band).prior);
            problem.min_values.push_back(min_value(i, band));
            problem.max_values.push_back(i < materials_ ? kMaxFittedAbsorption
                                                        : kMaxFittedScattering);
        }
        return problem;
    }

    /// Absorption is never below what is transmitted.
    double min_value(std::size_t coefficient, std::size_t band) const {
        return coefficient < materials_
                   ? std::max(kMinFittedAbsorption, transmitted_[coefficient][band])
                   : kMinFittedScattering;
    }

    /// Moves on to the fitted coefficients; whether they stay where they were simulated.
    bool take(const std::vector<BandFit>& fits) {
        constexpr double kRounding = 0.0015, kShareOfError = 0.1;
        bool is_settled = true;
        for (std::size_t band = 0; band < fits.size(); ++band) {
            const BandFit& fit = fits[band];
            for (std::size_t k = 0; k < fit.parameters.size() && fit.identifiability; ++k) {
                const std::size_t i = fit.parameters[k];
                double& value = coefficients_[i][band];
                const double error = fitted_of(i, band).prior.rate_at(value) *
                                     std::sqrt(fit.identifiability->variance_of(k));
                const double rounded =
                    std::max(rounded_to(0.001, fit.coefficients[i]), min_value(i, band));
                is_settled = is_settled && std::abs(rounded - value) <=
                                               std::max(kRounding, kShareOfError * error);
                value = rounded;
            }
        }
        return is_settled;
    }

    /// The model's values at the coefficients that it was simulated with.
    void read_values(const std::vector<BandFit>& fits,
                     std::optional<double> CalibratedMetric::*value) {
        for (std::size_t band = 0; band < fits.size(); ++band) {
            for (std::size_t k = 0; k < data_of_band_[band].size(); ++k) {
                result_.metrics[data_of_band_[band][k]].*value = fits[band].values[k];
            }
        }
    }

    void read_fits(const std::vector<BandFit>& fits) {
        for (std::size_t band = 0; band < fits.size(); ++band) {
            const BandFit& fit = fits[band];
            CalibratedBand& summary = result_.bands.emplace_back();
            summary.converged = fit.converged;
            summary.reduced_chi_squared = fit.reduced_chi_squared;
            std::vector<double> at;
            for (const Spectrum& coefficient : coefficients_) {
                at.push_back(coefficient[band]);
            }
            std::map<std::size_t, ModelledMetrics> of_pair;
            for (std::size_t k = 0; k < data_of_band_[band].size(); ++k) {
                CalibratedMetric& metric = result_.metrics[data_of_band_[band][k]];
                const std::size_t pair = of_scene_.pair_of(metric.measured);
                if (!of_pair.contains(pair)) {
                    of_pair.emplace(pair, models_[pair].evaluate(band, at));
                }
                metric.after = of_pair.at(pair).values[metric.measured.kind];
                metric.model_error = fit.model_errors[k];
                metric.weight = rounded_to(0.01, fit.weights[k]);
                summary.values += metric.weight > 0.0 ? 1 : 0;
            }
            for (std::size_t k = 0; k < fit.parameters.size() && fit.identifiability; ++k) {
                read_parameter(fit, band, k);
            }
        }
    }

    /// `share`: of the prior's variance that is left.
    static void read_interval(double share, double value, FittedCoefficient& fitted) {
        constexpr double kTwoSided95 = 1.959964;
        const double root = std::sqrt(share);
        const auto limit = [&](double errors) {
            const Coefficient of = fitted.prior.of;
            const double position =
                to_spread_scale(of, value) + errors * root * fitted.prior.deviation;
            return rounded_to(0.001, std::clamp(from_spread_scale(of, position), 0.0, 1.0));
        };
        fitted.value = value;
        fitted.error = share > 0.0 ? rounded_error(root * fitted.prior.rate_at(value)) : 0.0;
        fitted.lower = limit(-kTwoSided95);
        fitted.upper = limit(kTwoSided95);
    }

    void read_parameter(const BandFit& fit, std::size_t band, std::size_t k) {
        const std::size_t i = fit.parameters[k];
        FittedCoefficient& fitted = fitted_of(i)[band];
        const double share = std::min(fit.identifiability->variance_of(k), 1.0);
        read_interval(share, coefficients_[i][band], fitted);
        fitted.is_fitted = true;
        fitted.data_share = rounded_to(0.01, 1.0 - share);
        const double data_error = fitted.prior.rate_at(fitted.value) *
                                  std::sqrt(fit.identifiability->data_variance_of(k));
        // More than the range of a coefficient says nothing.
        if (data_error < 1.0) {
            fitted.data_error = rounded_error(data_error);
        }
        fitted.is_at_bound = fit.is_at_bound[k];
    }

    void read_groups(const std::vector<BandFit>& fits) {
        for (std::size_t band = 0; band < fits.size(); ++band) {
            if (!fits[band].identifiability) {
                continue;
            }
            for (const std::vector<std::size_t>& group : fits[band].identifiability->groups()) {
                result_.groups.push_back(read_group(fits[band], band, group));
            }
        }
    }

    UnidentifiedGroup read_group(const BandFit& fit,
                                 std::size_t band,
                                 const std::vector<std::size_t>& group) const {
        UnidentifiedGroup result = {.band = band};
        const std::vector<double> direction = fit.identifiability->known_direction(group);
        std::vector<double> of_parameters(fit.parameters.size(), 0.0);
        double sum = 0.0, magnitude = 0.0;
        for (std::size_t k = 0; k < group.size(); ++k) {
            const std::size_t i = fit.parameters[group[k]];
            auto& list = i < materials_ ? result.materials : result.scattering;
            list.push_back(static_cast<std::uint32_t>(i % materials_));
            of_parameters[group[k]] = direction[k];
            result.weights.push_back(direction[k] /
                                     fitted_of(i, band).prior.rate_at(coefficients_[i][band]));
            sum += result.weights.back();
            magnitude += std::abs(result.weights.back());
        }
        // A direction that the data tell, of coefficients that count in one sense: a mean.
        constexpr double kToldVariance = 0.25, kMainlyOneSense = 0.8;
        const double variance = fit.identifiability->variance(of_parameters);
        if (group.size() < 2 || !result.scattering.empty() || variance > kToldVariance ||
            std::abs(sum) < kMainlyOneSense * magnitude) {
            result.weights.clear();
            return result;
        }
        for (std::size_t k = 0; k < group.size(); ++k) {
            result.weights[k] /= sum;
            result.value += result.weights[k] * coefficients_[result.materials[k]][band];
            result.weights[k] = rounded_to(0.01, result.weights[k]);
        }
        result.value = rounded_to(0.001, result.value);
        result.error = rounded_error(std::sqrt(variance) / std::abs(sum));
        return result;
    }

    static double rounded_error(double error) { return std::max(rounded_to(0.001, error), 0.001); }

    const Scene& scene_;
    const CalibrationOptions& options_;
    const audio::Bands& bands_;
    std::size_t materials_;
    MeasuredScene of_scene_;
    Executor& executor_;
    Progress* progress_;
    // As simulated next: absorption of each material, and then scattering if it is fitted.
    std::vector<Spectrum> coefficients_;
    std::vector<Spectrum> transmitted_;  // per material
    std::vector<std::vector<std::size_t>> data_of_band_;
    std::vector<MaterialModel> models_;  // per pair
    CalibrationResult result_;
};

}  // namespace

CalibrationResult calibrate_materials(const Scene& scene,
                                      std::span<const MeasuredMetric> measured,
                                      const CalibrationOptions& options,
                                      Executor& executor,
                                      Progress* progress) {
    check(scene, measured, options);
    return Calibration(scene, measured, options, executor, progress).run();
}

std::vector<Material> calibrated_materials(const Scene& scene,
                                           const CalibrationResult& result,
                                           const audio::Bands& bands) {
    std::vector<Material> materials = scene.materials;
    for (std::size_t material = 0; material < materials.size(); ++material) {
        const auto value_of = [](const std::vector<FittedCoefficient>& fitted) {
            return [&fitted](std::size_t band) { return fitted[band].value; };
        };
        if (is_fitted(result.absorption[material])) {
            set_absorption(bands, value_of(result.absorption[material]), materials[material]);
        }
        if (!result.scattering.empty() && is_fitted(result.scattering[material])) {
            materials[material].scattering = per_band(bands, value_of(result.scattering[material]));
        }
    }
    return materials;
}

}  // namespace earshot::propagation
