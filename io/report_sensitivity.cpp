// SPDX-License-Identifier: MIT
#include "earshot/audio/room_metrics.h"
#include "earshot/io/internal/report_blocks.h"

#include <algorithm>
#include <array>
#include <cstdio>

namespace earshot::io {
namespace {

using Json = nlohmann::ordered_json;

/// The members that a page shows.
Json part_of(const Json& object, std::initializer_list<const char*> keys) {
    Json part = Json::object();
    for (const char* const key : keys) {
        if (object.is_object() && object.contains(key)) {
            part[key] = object[key];
        }
    }
    return part;
}

Json derivatives_of(const Json& derivatives) {
    Json part = part_of(derivatives, {"t30", "c80", "sti"});
    if (derivatives.is_object() && derivatives.contains("single")) {
        part["single"] = part_of(derivatives["single"], {"t30_mid", "c80_mid", "sti"});
    }
    return part;
}

/// The derivative of a single number by the absorption of a material; nothing where it has none.
std::optional<double> single_derivative(const Json& sensitivity,
                                        const char* metric,
                                        std::size_t material) {
    const Json& derivatives = sensitivity["derivatives"];
    if (!derivatives.is_object() || !derivatives.contains("single")) {
        return std::nullopt;
    }
    const Json list = part_of(derivatives["single"], {metric});
    const bool is_told = list.contains(metric) && list[metric].is_array() &&
                         list[metric].size() > material && list[metric][material].is_number();
    return is_told ? std::optional(list[metric][material].get<double>()) : std::nullopt;
}

/// Mean absorption of a material over all bands; 0 if it is not told.
double mean_absorption(const Json& material) {
    double sum = 0.0;
    std::size_t count = 0;
    if (material.contains("absorption")) {
        for (const Json& value : material["absorption"]) {
            sum += value.is_number() ? value.get<double>() : 0.0;
            ++count;
        }
    }
    return count > 0 ? sum / static_cast<double>(count) : 0.0;
}

std::string change_text(double change, int digits, const char* unit) {
    std::array<char, 64> text{};
    std::snprintf(text.data(), text.size(), "%+.*f%s", digits, change, unit);
    return text.data();
}

constexpr double kMore = 0.1;  // absorption that a treatment adds, for comparison

/// A material by what it changes when it absorbs more.
struct Treatment {
    std::size_t material = 0;
    double sti = 0.0;  // change of STI
};

/// By the change of STI, the largest first. A surface that absorbs nearly all cannot absorb more.
std::vector<Treatment> treatments_of(const ResultFiles& results, const Json& sensitivity) {
    constexpr double kMaxAbsorption = 0.9;
    std::vector<Treatment> treatments;
    for (std::size_t i = 0; i < results.materials.size(); ++i) {
        const auto derivative = single_derivative(sensitivity, "sti", i);
        if (derivative && mean_absorption(results.materials[i]) <= kMaxAbsorption) {
            treatments.push_back({.material = i, .sti = kMore * *derivative});
        }
    }
    std::stable_sort(treatments.begin(),
                     treatments.end(),
                     [](const Treatment& a, const Treatment& b) { return a.sti > b.sti; });
    return treatments;
}

}  // namespace

Json sensitivity_block(const ResultFiles& results,
                       std::span<const std::size_t> source_of,
                       std::span<const std::size_t> listener_of,
                       Warnings& warnings) {
    const std::size_t max_pairs =
        kMaxReportSensitivities / std::max<std::size_t>(results.materials.size(), 1);
    Json pairs = Json::array();
    std::size_t left_out = 0;
    for (std::size_t i = 0; i < results.pairs.size(); ++i) {
        const Json& told = results.pairs[i].sensitivity;
        if (told.is_null()) {
            continue;
        }
        if (pairs.size() == std::max<std::size_t>(max_pairs, 1)) {
            ++left_out;
            continue;
        }
        Json energy = Json::array();
        for (const Json& material : told["energy"]) {
            energy.push_back(part_of(material,
                                     {"name",
                                      "before_80ms",
                                      "after_80ms",
                                      "absorbed_before_80ms",
                                      "absorbed_after_80ms"}));
        }
        pairs.push_back({{"source", source_of[i]},
                         {"listener", listener_of[i]},
                         {"energy", std::move(energy)},
                         {"derivatives", derivatives_of(told["derivatives"])},
                         {"standard_error", derivatives_of(told["standard_error"])}});
    }
    if (left_out > 0) {
        warnings.push_back({"sensitivity.json",
                            "the page tells the surfaces that matter of the first " +
                                std::to_string(pairs.size()) + " pairs"});
    }
    return {{"pairs", std::move(pairs)}};
}

std::optional<Json> treatment_line(const ResultFiles& results,
                                   std::size_t pair,
                                   const std::string& place) {
    const Json& sensitivity = results.pairs[pair].sensitivity;
    if (sensitivity.is_null()) {
        return std::nullopt;
    }
    const std::vector<Treatment> treatments = treatments_of(results, sensitivity);
    if (treatments.empty()) {
        return std::nullopt;
    }
    const auto name_of = [&](const Treatment& treatment) {
        return results.materials[treatment.material]["name"].get<std::string>();
    };
    const Treatment& best = treatments.front();
    std::string answer = name_of(best) + ": 0.1 more absorption changes STI at " + place + " by " +
                         change_text(best.sti, 3, "");
    if (const auto time = single_derivative(sensitivity, "t30_mid", best.material)) {
        answer += " and T30 by " + change_text(kMore * *time, 2, " s");
    }
    if (treatments.size() > 1) {
        answer +=
            "; next " + name_of(treatments[1]) + ", STI " + change_text(treatments[1].sti, 3, "");
    }
    answer += " (just noticeable: 0.03)";
    return Json{{"question", "Which surface is worth treating?"},
                {"answer", answer},
                {"state", "told"},
                {"pair", pair}};
}

}  // namespace earshot::io
