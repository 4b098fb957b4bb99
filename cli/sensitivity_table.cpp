// SPDX-License-Identifier: MIT
#include "earshot/cli/sensitivity_table.h"

#include "earshot/cli/formatted.h"
#include "earshot/cli/output.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <span>
#include <vector>

namespace earshot::cli {
namespace {

using Json = nlohmann::ordered_json;
using propagation::MaterialSensitivity;

constexpr std::size_t kMaxRows = 20;
constexpr std::size_t kNameWidth = 24;
/// Of the absorption coefficient: what a surface is changed by in practice.
constexpr double kChange = 0.1;

/// Means over the pairs; of those that have a number.
struct MaterialMeans {
    double absorbed_before = 0.0, absorbed_after = 0.0;
    std::optional<double> t30, c80, sti;  // per unit of the coefficient
};

template <typename Number>
std::optional<double> mean_over(std::span<const propagation::PairSensitivity> pairs,
                                std::size_t material,
                                Number number_of) {
    double sum = 0.0, count = 0.0;
    for (const propagation::PairSensitivity& pair : pairs) {
        if (const std::optional<double> number = number_of(pair.materials[material])) {
            sum += *number;
            count += 1.0;
        }
    }
    return count > 0.0 ? std::optional(sum / count) : std::nullopt;
}

std::vector<MaterialMeans> means_of(const ResponseJob& job, const ResponseSummary& summary) {
    std::vector<MaterialMeans> means(job.scene.materials.size());
    const auto mid = [&](const audio::Spectrum& spectrum) {
        return std::optional(audio::mid_frequency_mean(job.simulation.bands, spectrum));
    };
    for (std::size_t i = 0; i < means.size(); ++i) {
        const auto mean = [&](auto number_of) {
            return mean_over(summary.sensitivity, i, number_of);
        };
        means[i] = {
            .absorbed_before =
                mean([&](const auto& m) { return mid(m.energy.absorbed_before); }).value_or(0.0),
            .absorbed_after =
                mean([&](const auto& m) { return mid(m.energy.absorbed_after); }).value_or(0.0),
            .t30 = mean([](const auto& m) { return m.derivatives.mid.reverberation_time_t30; }),
            .c80 = mean([](const auto& m) { return m.derivatives.mid.clarity_c80_db; }),
            .sti = mean([](const auto& m) { return m.derivatives.speech_transmission_index; })};
    }
    return means;
}

std::string padded(std::string text, std::size_t width) {
    text.resize(std::max(width, text.size() + 1), ' ');
    return text;
}

std::string fixed(const std::optional<double>& value, const char* format, std::size_t width) {
    return padded(value ? formatted(format, *value) : "-", width);
}

std::optional<double> changed(const std::optional<double>& derivative) {
    return derivative ? std::optional(kChange * *derivative) : std::nullopt;
}

Json to_json(const std::optional<double>& value) {
    return value ? Json(*value) : Json(nullptr);
}

}  // namespace

std::string sensitivity_text(const ResponseJob& job, const ResponseSummary& summary) {
    if (summary.sensitivity.empty()) {
        return "";
    }
    const std::vector<MaterialMeans> means = means_of(job, summary);
    std::vector<std::size_t> order(means.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        return std::abs(means[a].t30.value_or(0.0)) > std::abs(means[b].t30.value_or(0.0));
    });
    std::string text =
        "surfaces   mean over pairs, 500 Hz and 1 kHz: energy absorbed before and after 80 ms, "
        "and\n"
        "           what the absorption coefficient + 0.1 changes, to first order (STI: all "
        "bands)\n" +
        std::string(kNameWidth, ' ') + "area m2   before %  after %   T30 s     C80 dB    STI\n";
    for (std::size_t i = 0; i < std::min(order.size(), kMaxRows); ++i) {
        const std::size_t material = order[i];
        const MaterialMeans& row = means[material];
        std::string name = "  " + on_one_line(job.scene.materials[material].name);
        std::string line = name.size() < kNameWidth
                               ? padded(std::move(name), kNameWidth)
                               : std::move(name) + "\n" + std::string(kNameWidth, ' ');
        line += fixed(summary.material_areas[material], "%.1f", 10);
        line += fixed(100.0 * row.absorbed_before, "%.1f", 10);
        line += fixed(100.0 * row.absorbed_after, "%.1f", 10);
        line += fixed(changed(row.t30), "%+.3f", 10);
        line += fixed(changed(row.c80), "%+.2f", 10);
        line += fixed(changed(row.sti), "%+.4f", 10);
        line.erase(line.find_last_not_of(' ') + 1);
        text += line + "\n";
    }
    if (order.size() > kMaxRows) {
        text += "  ... " + std::to_string(order.size() - kMaxRows) + " more in sensitivity.json\n";
    }
    return text;
}

Json sensitivity_json(const ResponseJob& job, const ResponseSummary& summary) {
    Json json = Json::object();
    if (summary.sensitivity.empty()) {
        return json;
    }
    json["sensitivity"] = Json::array();
    const std::vector<MaterialMeans> means = means_of(job, summary);
    for (std::size_t i = 0; i < means.size(); ++i) {
        json["sensitivity"].push_back({{"material", job.scene.materials[i].name},
                                       {"area", summary.material_areas[i]},
                                       {"absorbed_before_80ms", means[i].absorbed_before},
                                       {"absorbed_after_80ms", means[i].absorbed_after},
                                       {"t30_mid", to_json(means[i].t30)},
                                       {"c80_mid", to_json(means[i].c80)},
                                       {"sti", to_json(means[i].sti)}});
    }
    return json;
}

}  // namespace earshot::cli
