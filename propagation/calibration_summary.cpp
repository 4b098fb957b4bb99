// SPDX-License-Identifier: MIT
#include "earshot/propagation/internal/calibration_summary.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <span>
#include <string>
#include <utility>

namespace earshot::propagation {

namespace {

/// Root mean squares of residuals in just-noticeable differences, before and after.
class ResidualSums {
public:
    void add(const CalibratedMetric& metric) {
        if (!metric.before || !metric.after || metric.weight == 0.0) {
            return;
        }
        const auto squared = [&](double value) {
            const double residual =
                (value - metric.measured.value) / metric.just_noticeable_difference;
            return residual * residual;
        };
        before_ += squared(*metric.before);
        after_ += squared(*metric.after);
        ++count_;
    }
    double before() const { return root(before_); }
    double after() const { return root(after_); }

private:
    double root(double sum) const {
        return count_ > 0 ? std::sqrt(sum / static_cast<double>(count_)) : 0.0;
    }
    double before_ = 0.0, after_ = 0.0;
    std::size_t count_ = 0;
};

std::string text_of(const char* format, double number) {
    std::array<char, 64> text{};
    std::snprintf(text.data(), text.size(), format, number);
    return text.data();
}

std::string band_name(const audio::Bands& bands, std::size_t band) {
    return text_of("%g Hz", bands.nominal_hz()[band]);
}

std::string counted(std::size_t count, const char* what) {
    return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
}

void warn_of_missing_values(const audio::Bands& bands, CalibrationResult& result) {
    std::map<std::pair<std::size_t, std::size_t>, std::size_t> missing;  // by band and kind
    for (const CalibratedMetric& metric : result.metrics) {
        if (metric.weight == 0.0) {
            ++missing[{metric.measured.band, metric.measured.kind}];
        }
    }
    for (const auto& [key, count] : missing) {
        result.warnings.push_back(
            {std::string(audio::kBandMetricKinds[key.second].key) + " at " +
                 band_name(bands, key.first),
             counted(count, "measured value") +
                 " left out: the model's decay does not support the metric there"});
    }
}

/// Fits that are worse than the noise of measurement explains.
void warn_of_pairs(const Scene& scene, CalibrationResult& result) {
    constexpr double kWorse = 0.1;  // just-noticeable differences
    std::map<std::pair<std::size_t, std::size_t>, ResidualSums> of_pair;
    for (const CalibratedMetric& metric : result.metrics) {
        of_pair[{metric.measured.source, metric.measured.listener}].add(metric);
    }
    for (const auto& [pair, sums] : of_pair) {
        if (sums.after() > sums.before() + kWorse) {
            result.warnings.push_back(
                {scene.sources[pair.first].name + " to " + scene.listeners[pair.second].name,
                 "agrees less after the fit: " + text_of("%.1f", sums.before()) + " to " +
                     text_of("%.1f just-noticeable differences", sums.after()) +
                     "; check positions and the recording of this pair"});
        }
    }
}

void warn_of_outliers(CalibrationResult& result) {
    constexpr double kOutlier = 0.5;  // twice the limit of outliers
    std::size_t outliers = 0;
    for (const CalibratedMetric& metric : result.metrics) {
        outliers += metric.weight > 0.0 && metric.weight < kOutlier ? 1 : 0;
    }
    if (outliers > 0) {
        result.warnings.push_back(
            {"outliers",
             counted(outliers, "measured value") +
                 " far from what the others say count less than half (weight in --json)"});
    }
}

/// The chance of the rays acts on the derivatives too, so it must be small beside the errors of
/// measurement.
void warn_of_rays(CalibrationResult& result) {
    constexpr double kMaxShare = 0.3;
    double sum = 0.0, count = 0.0;
    for (const CalibratedMetric& metric : result.metrics) {
        if (metric.weight > 0.0) {
            const double share = metric.model_error / metric.error;
            sum += share * share;
            count += 1.0;
        }
    }
    if (count > 0.0 && sum > kMaxShare * kMaxShare * count) {
        result.warnings.push_back(
            {"rays",
             "their chance is " + text_of("%.1f", std::sqrt(sum / count)) +
                 " of the errors of measurement, so intervals are too narrow; more rays (--rays, "
                 "--rays-error) mend that"});
    }
}

void warn_of_bands(const audio::Bands& bands, CalibrationResult& result) {
    constexpr double kPoor = 3.0;
    for (std::size_t band = 0; band < result.bands.size(); ++band) {
        const CalibratedBand& fit = result.bands[band];
        if (fit.reduced_chi_squared && *fit.reduced_chi_squared > kPoor) {
            result.warnings.push_back(
                {band_name(bands, band),
                 "the model differs from the measurements by " +
                     text_of("%.1f", std::sqrt(*fit.reduced_chi_squared)) +
                     " times their errors, so intervals are so much wider: absorption alone does "
                     "not explain them, or --error is too small"});
        }
        if (!fit.converged) {
            result.warnings.push_back({band_name(bands, band), "the fit did not converge"});
        }
    }
}

/// Files of materials go by names.
void warn_of_names(const Scene& scene, CalibrationResult& result) {
    std::map<std::string, std::size_t> counts;
    for (std::size_t material = 0; material < scene.materials.size(); ++material) {
        const std::vector<FittedCoefficient>& bands = result.absorption[material];
        if (std::any_of(bands.begin(), bands.end(), [](const auto& b) { return b.is_fitted; })) {
            ++counts[scene.materials[material].name];
        }
    }
    for (const auto& [name, count] : counts) {
        if (count > 1) {
            result.warnings.push_back(
                {name,
                 std::to_string(count) +
                     " materials have this name; from a file of materials all take the absorption "
                     "of the last"});
        }
    }
}

void warn_of_bounds(const Scene& scene,
                    const audio::Bands& bands,
                    const char* coefficient,
                    std::span<const std::vector<FittedCoefficient>> fitted,
                    CalibrationResult& result) {
    for (std::size_t material = 0; material < fitted.size(); ++material) {
        std::string list;
        for (std::size_t band = 0; band < bands.count(); ++band) {
            if (fitted[material][band].is_at_bound) {
                list += (list.empty() ? "" : ", ") + band_name(bands, band);
            }
        }
        if (!list.empty()) {
            result.warnings.push_back(
                {scene.materials[material].name,
                 std::string(coefficient) + " is at the end of its range at " + list});
        }
    }
}

}  // namespace

double rounded_to(double step, double value) noexcept {
    // Through the inverse, which is a whole number, so that 0.013 is the double of "0.013".
    const double steps = std::round(1.0 / step);
    return std::round(value * steps) / steps;
}

void summarize(const Scene& scene, const audio::Bands& bands, CalibrationResult& result) {
    std::vector<ResidualSums> of_band(bands.count());
    for (const CalibratedMetric& metric : result.metrics) {
        of_band[metric.measured.band].add(metric);
    }
    for (std::size_t band = 0; band < result.bands.size(); ++band) {
        result.bands[band].before = of_band[band].before();
        result.bands[band].after = of_band[band].after();
    }
    if (!result.converged) {
        result.warnings.push_back({"calibration",
                                   "the coefficients still change after " +
                                       counted(std::size_t(result.simulations), "simulation") +
                                       "; allow more (--simulations)"});
    }
    warn_of_missing_values(bands, result);
    warn_of_rays(result);
    warn_of_bands(bands, result);
    warn_of_pairs(scene, result);
    warn_of_outliers(result);
    warn_of_bounds(scene, bands, "absorption", result.absorption, result);
    warn_of_bounds(scene, bands, "scattering", result.scattering, result);
    warn_of_names(scene, result);
}

}  // namespace earshot::propagation
