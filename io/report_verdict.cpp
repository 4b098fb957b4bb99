// SPDX-License-Identifier: MIT
#include "earshot/audio/room_metrics.h"
#include "earshot/audio/speech.h"
#include "earshot/io/internal/report_blocks.h"
#include "earshot/io/internal/text.h"
#include "earshot/propagation/plausibility.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <span>
#include <string_view>
#include <utility>

namespace earshot::io {
namespace {

using Json = nlohmann::ordered_json;

std::string text_of(double value, int digits) {
    std::array<char, 64> text{};
    std::snprintf(text.data(), text.size(), "%.*f", digits, value);
    return text.data();
}

/// A metric of which one number is told per pair.
struct SingleMetric {
    std::string_view key;
    std::string_view name;
    std::string_view unit;
    bool at_most = false;  ///< what a limit means
    int digits = 2;
};

constexpr std::array<SingleMetric, 9> kSingleMetrics = {{{"sti", "STI", "", false, 2},
                                                         {"edt", "EDT", " s", true, 2},
                                                         {"t20", "T20", " s", true, 2},
                                                         {"t30", "T30", " s", true, 2},
                                                         {"c50", "C50", " dB", false, 1},
                                                         {"c80", "C80", " dB", false, 1},
                                                         {"d50", "D50", "", false, 2},
                                                         {"ts", "Ts", " s", true, 3},
                                                         {"g", "G", " dB", false, 1}}};

const SingleMetric* find_metric(std::string_view key) {
    constexpr std::string_view kMid = "_mid";
    if (key.ends_with(kMid)) {
        key.remove_suffix(kMid.size());
    }
    const auto* found = std::find_if(kSingleMetrics.begin(),
                                     kSingleMetrics.end(),
                                     [&](const SingleMetric& metric) { return metric.key == key; });
    return found == kSingleMetrics.end() ? nullptr : found;
}

/// The number of a pair; nothing where it is withheld.
std::optional<double> value_of(const Json& metrics, const SingleMetric& metric) {
    const Json* value = nullptr;
    if (metric.key == "sti") {
        value = metrics.is_object() && metrics.contains("sti") ? &metrics["sti"] : nullptr;
    } else if (metrics.is_object() && metrics.contains("single")) {
        const Json& single = metrics["single"];
        const std::string key = std::string(metric.key) + "_mid";
        value = single.is_object() && single.contains(key) ? &single[key] : nullptr;
    }
    return value != nullptr && value->is_number() ? std::optional(value->get<double>())
                                                  : std::nullopt;
}

/// The pairs' numbers of a metric.
struct Values {
    std::size_t count = 0;    ///< of pairs that have one
    std::size_t lacking = 0;  ///< of pairs that have none
    double lowest = 0.0, highest = 0.0;
    std::size_t lowest_pair = 0, highest_pair = 0;
};

Values values_of(std::span<const ResultPair> pairs, const SingleMetric& metric) {
    Values values;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        const auto value = value_of(pairs[i].metrics, metric);
        if (!value) {
            ++values.lacking;
            continue;
        }
        if (values.count == 0 || *value < values.lowest) {
            values.lowest = *value;
            values.lowest_pair = i;
        }
        if (values.count == 0 || *value > values.highest) {
            values.highest = *value;
            values.highest_pair = i;
        }
        ++values.count;
    }
    return values;
}

/// The listener's name, the source's too where there are several.
std::string place_of(std::span<const ResultPair> pairs, std::size_t pair) {
    const bool one_source = std::all_of(pairs.begin(), pairs.end(), [&](const ResultPair& other) {
        return other.source == pairs.front().source;
    });
    return pairs[pair].listener + (one_source ? "" : " from " + pairs[pair].source);
}

std::string of_pairs(std::size_t count) {
    return count == 1 ? "the one seat" : "the worst of " + std::to_string(count) + " seats";
}

Json line(const std::string& question, const std::string& answer, std::string_view state) {
    return {{"question", question}, {"answer", answer}, {"state", state}};
}

Json limit_line(const ReportLimit& limit, std::span<const ResultPair> pairs) {
    const SingleMetric& metric = *find_metric(limit.metric);
    const Values values = values_of(pairs, metric);
    const double worst = metric.at_most ? values.highest : values.lowest;
    const std::size_t pair = metric.at_most ? values.highest_pair : values.lowest_pair;
    const std::string question =
        "Is " + std::string(metric.name) + (metric.at_most ? " at most " : " at least ") +
        text_of(limit.value, metric.digits) + std::string(metric.unit) + " everywhere?";
    if (values.count == 0) {
        return line(question, "not known at any seat", "told");
    }
    std::string answer = text_of(worst, metric.digits) + std::string(metric.unit) + " at " +
                         of_pairs(values.count) + " (" + place_of(pairs, pair) + ")";
    if (values.lacking > 0) {
        answer += ", not known at " + std::to_string(values.lacking) + " more";
    }
    const bool misses = metric.at_most ? worst > limit.value : worst < limit.value;
    Json result = line(question, answer, misses ? "missed" : values.lacking > 0 ? "told" : "met");
    result["pair"] = pair;
    return result;
}

/// "0.71 s" for a single value, else "0.68 to 0.74 s".
std::string range_text(const Values& values, const SingleMetric& metric) {
    const std::string low = text_of(values.lowest, metric.digits);
    const std::string high = text_of(values.highest, metric.digits);
    return (low == high ? low : low + " to " + high) + std::string(metric.unit);
}

/// Mid-frequency mean of a list of metrics.json's room; nothing without one.
std::optional<double> room_mid(const ResultFiles& results, const char* key) {
    if (!results.room.is_object() || !results.room.contains(key)) {
        return std::nullopt;
    }
    const Json& list = results.room[key];
    std::vector<double> values;
    for (const Json& value : list) {
        if (!value.is_number()) {
            return std::nullopt;
        }
        values.push_back(value.get<double>());
    }
    if (values.size() < results.bands.count()) {
        return std::nullopt;
    }
    return audio::mid_frequency_mean(results.bands, values);
}

std::optional<Json> size_line(const RoomReport& report, const ResultFiles& results) {
    std::string answer;
    if (report.scene != nullptr) {
        answer =
            propagation::size_text(propagation::scene_extent(*report.scene, report.time).size());
    }
    const auto add = [&](const char* key, const char* unit) {
        if (results.room.is_object() && results.room.contains(key) &&
            results.room[key].is_number()) {
            answer += (answer.empty() ? "" : ", ") +
                      propagation::short_text(results.room[key].get<double>()) + unit;
        }
    };
    add("volume", " m3 of air");
    add("surface", " m2 of surface");
    return answer.empty() ? std::nullopt
                          : std::optional(line("How large is the room?", answer, "told"));
}

Json reverberation_line(const ResultFiles& results) {
    const SingleMetric& t30 = *find_metric("t30");
    const Values values = values_of(results.pairs, t30);
    std::string answer = values.count == 0
                             ? "T30 is not known: the notes of the metrics say why"
                             : "T30 " + range_text(values, t30) + " at mid frequencies";
    for (const auto& [key, name] : {std::pair{"sabine", "Sabine"}, {"eyring", "Eyring"}}) {
        if (const auto time = room_mid(results, key)) {
            answer += std::string("; ") + name + " " + text_of(*time, t30.digits) + " s";
        }
    }
    return line("How long does the room reverberate?", answer, "told");
}

Json speech_line(std::span<const ResultPair> pairs) {
    const SingleMetric& sti = *find_metric("sti");
    const Values values = values_of(pairs, sti);
    constexpr const char* kQuestion = "How well is speech understood?";
    if (values.count == 0) {
        return line(kQuestion, "STI is not known: the notes of the metrics say why", "told");
    }
    std::string answer = "STI " + text_of(values.lowest, sti.digits) + " (" +
                         std::string(audio::sti_letter(values.lowest)) + ") at " +
                         of_pairs(values.count) + " (" + place_of(pairs, values.lowest_pair) + ")";
    if (values.count > 1) {
        answer += ", " + text_of(values.highest, sti.digits) + " (" +
                  std::string(audio::sti_letter(values.highest)) + ") at the best (" +
                  place_of(pairs, values.highest_pair) + ")";
    }
    Json result = line(kQuestion, answer, "told");
    result["pair"] = values.lowest_pair;
    return result;
}

}  // namespace

ReportLimit parse_report_limit(std::string_view text) {
    const std::size_t sign = text.find('=');
    const std::string_view key = text.substr(0, sign);
    const auto value =
        sign == std::string_view::npos ? std::nullopt : to_number(text.substr(sign + 1));
    if (find_metric(key) == nullptr || !value || !std::isfinite(*value)) {
        throw Error(std::string(text),
                    "is no limit of a metric",
                    "give sti, edt, t20, t30, c50, c80, d50, ts or g, as in sti=0.6");
    }
    return {.metric = std::string(key), .value = *value};
}

Json verdict_block(const RoomReport& report, const ResultFiles& results) {
    Json verdict = Json::array();
    if (const auto size = size_line(report, results)) {
        verdict.push_back(*size);
    }
    const bool has_metrics =
        std::any_of(results.pairs.begin(), results.pairs.end(), [](const ResultPair& pair) {
            return !pair.metrics.is_null();
        });
    if (has_metrics) {
        verdict.push_back(reverberation_line(results));
        verdict.push_back(speech_line(results.pairs));
        const std::size_t worst = values_of(results.pairs, *find_metric("sti")).lowest_pair;
        if (const auto treatment = treatment_line(
                results, worst, "the worst seat (" + place_of(results.pairs, worst) + ")")) {
            verdict.push_back(*treatment);
        }
        for (const ReportLimit& limit : report.limits) {
            verdict.push_back(limit_line(limit, results.pairs));
        }
    }
    return verdict;
}

}  // namespace earshot::io
