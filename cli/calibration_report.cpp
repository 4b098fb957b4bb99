// SPDX-License-Identifier: MIT
#include "earshot/cli/calibration_report.h"

#include "earshot/cli/formatted.h"
#include "earshot/cli/output.h"

#include <algorithm>
#include <map>
#include <set>
#include <utility>
#include <vector>

namespace earshot::cli {
namespace {

using namespace propagation;

class CalibrationText {
public:
    explicit CalibrationText(const io::CalibrationParts& parts)
        : parts_(parts), result_(parts.result) {
        for (const Material& material : parts.scene.materials) {
            name_width_ = std::max(name_width_, on_one_line(material.name).size());
        }
        name_width_ = std::min(name_width_, kMaxNameWidth);
        for (std::size_t band = 0; band < result_.bands.size(); ++band) {
            if (result_.bands[band].values > 0) {
                bands_.push_back(band);
            }
        }
    }

    std::string text() const {
        std::string text = head() + residuals();
        if (result_.scattering.empty()) {
            text += coefficients(result_.absorption);
        } else {
            text += "absorption\n" + coefficients(result_.absorption) + "\nscattering\n" +
                    coefficients(result_.scattering);
        }
        return text +
               "* told by the measurements alone; others lean on what the scene or the library "
               "says\n" +
               groups();
    }

private:
    std::string head() const {
        std::set<std::pair<std::size_t, std::size_t>> pairs;
        std::size_t values = 0, left_out = 0;
        for (const CalibratedMetric& metric : result_.metrics) {
            pairs.insert({metric.measured.source, metric.measured.listener});
            ++(metric.weight > 0.0 ? values : left_out);
        }
        return formatted("%zu values of %zu pairs%s; %d simulations, %zu rays each%s\n\n",
                         values,
                         pairs.size(),
                         left_out > 0 ? formatted(", %zu left out", left_out).c_str() : "",
                         result_.simulations,
                         result_.rays,
                         result_.converged ? "" : "; not converged");
    }

    std::string row(const std::string& name,
                    const std::string& what,
                    const std::vector<std::string>& cells) const {
        std::string text = on_one_line(name);
        text.resize(std::max(text.size(), name_width_), ' ');
        text += formatted("  %-7s", what.c_str());
        for (const std::string& cell : cells) {
            text += formatted(" %7s", cell.c_str());
        }
        while (text.ends_with(' ')) {
            text.pop_back();
        }
        return text + "\n";
    }

    template <typename CellOf>
    std::vector<std::string> cells(CellOf cell_of) const {
        std::vector<std::string> result;
        for (const std::size_t band : bands_) {
            result.push_back(cell_of(band));
        }
        return result;
    }

    std::string residuals() const {
        const auto of_bands = [&](double CalibratedBand::*value) {
            return cells(
                [&](std::size_t band) { return formatted("%.2f ", result_.bands[band].*value); });
        };
        return row("", "Hz", cells([&](std::size_t band) {
                       return formatted("%g ", parts_.bands.nominal_hz()[band]);
                   })) +
               row("differences, JND", "before", of_bands(&CalibratedBand::before)) +
               row("", "after", of_bands(&CalibratedBand::after)) + "\n";
    }

    /// Of each material.
    std::string coefficients(const std::vector<std::vector<FittedCoefficient>>& list) const {
        std::string text;
        for (std::size_t material = 0; material < list.size(); ++material) {
            const auto& fitted = list[material];
            if (std::none_of(fitted.begin(), fitted.end(), [](const FittedCoefficient& band) {
                    return band.is_fitted;
                })) {
                text += row(parts_.scene.materials[material].name, "kept", {});
                continue;
            }
            text += row(parts_.scene.materials[material].name, "prior", cells([&](std::size_t b) {
                            return formatted("%.3f ", fitted[b].prior.mean);
                        }));
            text += row("", "fitted", cells([&](std::size_t b) {
                            return formatted(
                                "%.3f%s", fitted[b].value, fitted[b].is_identified() ? "*" : " ");
                        }));
            text += row("", "+-", cells([&](std::size_t b) {
                            return formatted("%.3f ", fitted[b].error);
                        }));
        }
        return text;
    }

    /// One line for each set of coefficients, with its bands.
    std::string groups() const {
        using Materials = std::vector<std::uint32_t>;
        std::map<std::pair<Materials, Materials>, std::vector<const UnidentifiedGroup*>> of_sets;
        for (const UnidentifiedGroup& group : result_.groups) {
            of_sets[{group.materials, group.scattering}].push_back(&group);
        }
        std::string text;
        for (const auto& [set, list] : of_sets) {
            std::string names, bands, means;
            for (const std::uint32_t material : set.first) {
                names += (names.empty() ? "" : ", ") + name(material);
            }
            for (const std::uint32_t material : set.second) {
                names += (names.empty() ? "scattering of " : ", scattering of ") + name(material);
            }
            for (const UnidentifiedGroup* group : list) {
                const double band_hz = parts_.bands.nominal_hz()[group->band];
                bands += (bands.empty() ? "" : ", ") + formatted("%g", band_hz);
                means += group->weights.empty() ? "" : mean(*group);
            }
            text += "\n" + names +
                    (set.first.size() + set.second.size() > 1 ? ": not told apart"
                                                              : ": hardly told at all") +
                    " at " + bands + " Hz" + (means.empty() ? "" : "; known are") + "\n" + means;
        }
        return text;
    }

    std::string name(std::uint32_t material) const {
        return on_one_line(parts_.scene.materials[material].name);
    }

    /// What is known of a group: "  1000 Hz: 0.54 floor + 0.46 ceiling = 0.245 +- 0.008".
    std::string mean(const UnidentifiedGroup& group) const {
        std::string sum;
        for (std::size_t k = 0; k < group.materials.size(); ++k) {
            sum += (sum.empty() ? "" : " + ") + formatted("%.2f ", group.weights[k]) +
                   name(group.materials[k]);
        }
        return formatted("  %5g Hz: ", parts_.bands.nominal_hz()[group.band]) + sum +
               formatted(" = %.3f +- %.3f\n", group.value, group.error);
    }

    static constexpr std::size_t kMaxNameWidth = 32;

    const io::CalibrationParts& parts_;
    const CalibrationResult& result_;
    std::size_t name_width_ = 16;
    std::vector<std::size_t> bands_;  // that were measured
};

}  // namespace

std::string calibration_text(const io::CalibrationParts& parts) {
    return CalibrationText(parts).text();
}

}  // namespace earshot::cli
