// SPDX-License-Identifier: MIT
#include "earshot/audio/decay_lines.h"
#include "earshot/base/math.h"
#include "earshot/io/internal/json_lines.h"
#include "earshot/io/internal/report_blocks.h"

#include <algorithm>
#include <cmath>
#include <string_view>

namespace earshot::io {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kStep = 5e-3;  // of curves, at least, seconds

double rounded(double value, double unit) {
    return std::round(value * unit) / unit;
}
double hundredths(double value) {
    return rounded(value, 100.0);
}

Json line_json(const std::optional<audio::DecayLine>& line,
               const Json& metrics,
               const char* metric,
               std::size_t band) {
    // A metric that is withheld has no line either.
    const bool is_told = metrics.is_object() && metrics.contains(metric) &&
                         metrics.at(metric).is_array() && metrics.at(metric).size() > band &&
                         metrics.at(metric).at(band).is_number();
    if (!line || !is_told) {
        return nullptr;
    }
    constexpr double kMicro = 1e6;
    return {{"from", rounded(line->from, kMicro)},
            {"to", rounded(line->to, kMicro)},
            {"level_from", hundredths(line->level_from_db)},
            {"level_to", hundredths(line->level_to_db)}};
}

/// How many of so many values make one of at most `max_points`.
std::size_t stride_of(std::size_t count, std::size_t max_points) {
    return std::max<std::size_t>(1, (count + max_points - 1) / max_points);
}

Json decay_json(const ResultPair& pair, const audio::Bands& bands, const PairDetail& detail) {
    const std::vector<audio::BandDecayLines> lines =
        audio::decay_lines(bands, pair.arrivals, pair.late, {.step = kStep});
    std::size_t longest = 0;
    for (const audio::BandDecayLines& band : lines) {
        longest = std::max(longest, band.level_db.size());
    }
    const std::size_t stride = stride_of(longest, detail.max_points);
    Json levels = Json::array();
    Json fits = Json::array();
    for (std::size_t band = 0; band < lines.size(); ++band) {
        Json level = lines[band].level_db.empty() ? Json(nullptr) : Json::array();
        for (std::size_t k = 0; k < lines[band].level_db.size(); k += stride) {
            level.push_back(hundredths(lines[band].level_db[k]));
        }
        levels.push_back(std::move(level));
        fits.push_back({{"edt", line_json(lines[band].edt, pair.metrics, "edt", band)},
                        {"t20", line_json(lines[band].t20, pair.metrics, "t20", band)},
                        {"t30", line_json(lines[band].t30, pair.metrics, "t30", band)}});
    }
    return {{"step", kStep * static_cast<double>(stride)},
            {"level_db", std::move(levels)},
            {"fits", std::move(fits)}};
}

/// Bins are joined; the errors of bins are taken as independent.
Json histogram_json(const ResultPair& pair, const audio::Bands& bands, const PairDetail& detail) {
    const audio::EnergyHistogram& late = pair.late;
    const auto per_step = static_cast<std::size_t>(std::max(1.0, std::round(kStep / late.bin)));
    const std::size_t steps = (late.energy.size() + per_step - 1) / per_step;
    const std::size_t joined = per_step * stride_of(steps, detail.max_points);
    Json energies = Json::array();
    Json errors = Json::array();
    for (std::size_t band = 0; band < bands.count(); ++band) {
        Json energy_db = Json::array();
        Json relative_error = Json::array();
        for (std::size_t begin = 0; begin < late.energy.size(); begin += joined) {
            double energy = 0.0;
            double variance = 0.0;
            const std::size_t end = std::min(begin + joined, late.energy.size());
            for (std::size_t n = begin; n < end; ++n) {
                energy += late.energy[n][band];
                variance += late.error[n][band] * late.error[n][band];
            }
            const bool is_silent = !(energy > 0.0);
            energy_db.push_back(is_silent ? Json(nullptr)
                                          : Json(hundredths(10.0 * math::log10(energy))));
            constexpr double kThousand = 1e3;
            relative_error.push_back(
                is_silent ? Json(nullptr) : Json(rounded(std::sqrt(variance) / energy, kThousand)));
        }
        energies.push_back(std::move(energy_db));
        errors.push_back(std::move(relative_error));
    }
    return {{"step", late.bin * static_cast<double>(joined)},
            {"energy_db", std::move(energies)},
            {"relative_error", std::move(errors)}};
}

}  // namespace

std::string pair_block(const ResultPair& pair,
                       const audio::Bands& bands,
                       std::size_t source,
                       std::size_t listener,
                       const PairDetail& detail,
                       const std::optional<ReportAudio>& audio) {
    std::string text = "{\"source\":" + std::to_string(source) +
                       ",\"listener\":" + std::to_string(listener) +
                       ",\"time\":" + json_number(pair.time);
    const auto add = [&](std::string_view key, const std::string& value) {
        text += ",\"" + std::string(key) + "\":" + value;
    };
    if (!pair.metrics.is_null()) {
        add("metrics", json_text(pair.metrics));
    }
    if (!pair.reference.is_null()) {
        add("reference", json_text(pair.reference));
    }
    if (!pair.arrivals.empty()) {
        std::string paths;
        for (const std::string& path : pair.strongest_paths) {
            paths += (paths.empty() ? "\n" : ",\n") + path;
        }
        add("paths", "[" + paths + "]");
        add("paths_left_out", std::to_string(pair.arrivals.size() - pair.strongest_paths.size()));
    }
    if (detail.decays && (!pair.arrivals.empty() || !pair.late.energy.empty())) {
        add("decay", json_text(decay_json(pair, bands, detail)));
    }
    if (!pair.late.energy.empty()) {
        add("histogram", json_text(histogram_json(pair, bands, detail)));
    }
    if (audio) {
        add("audio", json_text({{"dry", audio->dry}, {"wet", audio->wet}}));
    }
    return text + "}";
}

}  // namespace earshot::io
