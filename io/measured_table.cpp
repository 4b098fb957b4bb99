// SPDX-License-Identifier: MIT
#include "earshot/io/measured_table.h"

#include "earshot/io/internal/text.h"
#include "earshot/io/whole_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>

namespace earshot::io {

namespace {

using propagation::Emitter;
using propagation::MeasuredMetric;
using Cells = std::vector<std::string_view>;

// No time, level or error of a room comes near it.
constexpr double kMaxNumber = 1e6;

std::optional<std::size_t> metric_kind(std::string_view key) {
    for (std::size_t kind = 0; kind < audio::kBandMetricKinds.size(); ++kind) {
        if (audio::kBandMetricKinds[kind].key == key) {
            return kind;
        }
    }
    return std::nullopt;
}

std::string metric_keys() {
    std::string text;
    for (const audio::BandMetricKind& kind : audio::kBandMetricKinds) {
        text += (text.empty() ? "" : ", ") + std::string(kind.key);
    }
    return text;
}

std::optional<std::size_t> index_of(const std::vector<Emitter>& emitters, std::string_view name) {
    const auto found = std::find_if(emitters.begin(), emitters.end(), [&](const Emitter& emitter) {
        return emitter.name == name;
    });
    return found == emitters.end() ? std::nullopt
                                   : std::optional(std::size_t(found - emitters.begin()));
}

class TableReader {
public:
    TableReader(const std::filesystem::path& file,
                const propagation::Scene& scene,
                const audio::Bands& bands,
                std::span<const std::size_t> kinds)
        : file_(file.string()), scene_(scene), bands_(bands), kinds_(kinds) {}

    MeasuredMetrics read(std::string_view text) {
        Lines lines(decoded_text(text, file_));
        while (const auto line = lines.next()) {
            if (trimmed(*line).empty()) {
                continue;
            }
            const Cells cells = cells_of(*line);
            const bool is_header =
                lines.number() == 1 && std::none_of(cells.begin(), cells.end(), [](auto cell) {
                    return to_number(cell).has_value();
                });
            if (!is_header) {
                line_ = lines.name();
                read_row(cells);
            }
        }
        for (const auto& [pair, count] : unknown_) {
            result_.warnings.push_back({file_,
                                        "the scene has no pair " + shortened(pair.first) + ", " +
                                            shortened(pair.second) + "; " + std::to_string(count) +
                                            (count == 1 ? " value" : " values") + " left out"});
        }
        if (result_.values.empty()) {
            throw Error(file_, "holds no measured value of a pair of the scene", kRemedy);
        }
        return std::move(result_);
    }

private:
    static constexpr const char* kRemedy =
        "give SOURCE,LISTENER,METRIC,BAND,VALUE or that and a standard error on each line";

    [[noreturn]] void refuse(const std::string& what, const std::string& remedy = kRemedy) const {
        throw Error(file_, line_ + " " + what, remedy);
    }

    double number(std::string_view cell, const char* what, double min) const {
        const auto value = to_number(cell);
        if (!value || !(*value >= min && *value <= kMaxNumber)) {
            refuse("has the " + std::string(what) + " '" + shortened(cell) + "'",
                   min > 0.0 ? "give a positive number" : "give a number");
        }
        return *value;
    }

    std::size_t band(std::string_view cell) const {
        const auto hz = to_number(cell);
        const auto nominal = bands_.nominal_hz();
        const auto found = hz ? std::find(nominal.begin(), nominal.end(), *hz) : nominal.end();
        if (found == nominal.end()) {
            refuse("has the band '" + shortened(cell) + "'",
                   bands_.count() == audio::Bands::octaves().count()
                       ? "give the nominal frequency of an octave, or --bands third"
                       : "give the nominal frequency of a third");
        }
        return std::size_t(found - nominal.begin());
    }

    void read_row(const Cells& cells) {
        constexpr std::size_t kWithoutError = 5, kWithError = 6;
        if (cells.size() != kWithoutError && cells.size() != kWithError) {
            refuse("has " + std::to_string(cells.size()) + " columns");
        }
        const auto kind = metric_kind(cells[2]);
        if (!kind) {
            refuse("has the metric '" + shortened(cells[2]) + "'", "give one of " + metric_keys());
        }
        MeasuredMetric row = {.kind = *kind, .band = band(cells[3])};
        if (cells[4].empty()) {
            return;  // not supported by its response
        }
        // Smaller times and errors are zeros that were rounded.
        constexpr double kMinPositive = 1e-9;
        const bool is_time = audio::kBandMetricKinds[*kind].unit == "s";
        row.value = number(cells[4], "value", is_time ? kMinPositive : -kMaxNumber);
        if (cells.size() == kWithError && !cells[5].empty()) {
            row.error = number(cells[5], "standard error", kMinPositive);
        }
        if (!kinds_.empty() && std::find(kinds_.begin(), kinds_.end(), *kind) == kinds_.end()) {
            return;
        }
        const auto source = index_of(scene_.sources, cells[0]);
        const auto listener = index_of(scene_.listeners, cells[1]);
        if (!source || !listener) {
            ++unknown_[{std::string(cells[0]), std::string(cells[1])}];
            return;
        }
        row.source = *source;
        row.listener = *listener;
        if (!keys_.insert({row.source, row.listener, row.kind, row.band}).second) {
            refuse("gives the same pair, metric and band a second time", "keep one of them");
        }
        result_.values.push_back(row);
    }

    std::string file_;
    const propagation::Scene& scene_;
    const audio::Bands& bands_;
    std::span<const std::size_t> kinds_;
    std::string line_;
    std::set<std::array<std::size_t, 4>> keys_;
    std::map<std::pair<std::string, std::string>, std::size_t> unknown_;  // rows of each pair
    MeasuredMetrics result_;
};

}  // namespace

std::vector<std::size_t> parse_metric_keys(std::string_view text) {
    std::vector<std::size_t> kinds;
    for (const std::string_view key : cells_of(text)) {
        const auto kind = metric_kind(key);
        if (!kind) {
            throw Error("metric '" + shortened(key) + "'", "is not known", "give " + metric_keys());
        }
        if (std::find(kinds.begin(), kinds.end(), *kind) != kinds.end()) {
            throw Error("metric '" + std::string(key) + "'", "is given twice", "give it once");
        }
        kinds.push_back(*kind);
    }
    return kinds;
}

MeasuredMetrics read_measured_table(const std::filesystem::path& file,
                                    const propagation::Scene& scene,
                                    const audio::Bands& bands,
                                    std::span<const std::size_t> kinds) {
    const std::string text = read_whole_file(file);
    return TableReader(file, scene, bands, kinds).read(text);
}

}  // namespace earshot::io
