// SPDX-License-Identifier: MIT
// Metrics of all pairs as tables, and the notes on them.
#include "earshot/audio/room_metrics.h"
#include "earshot/capi/internal/metric_kinds.h"
#include "earshot/capi/internal/result_object.h"

#include <cmath>
#include <limits>
#include <string_view>

namespace earshot::capi {
namespace {

using audio::kBandMetricKinds;
using audio::MetricNote;
using audio::RoomMetrics;
using propagation::PairMetrics;

constexpr double kNoValue = std::numeric_limits<double>::quiet_NaN();
static_assert(kBandMetricKinds.size() == ES_METRIC_G + 1, "es_metric begins with these");

void append(const std::optional<double>& value,
            const std::optional<double>& error,
            MetricTable& table) {
    table.values.push_back(value.value_or(kNoValue));
    table.errors.push_back(error.value_or(kNoValue));
}

/// The metrics of a band and their means, the index.
void append(const RoomMetrics& metrics, std::size_t set, ResultObject& result) {
    const audio::MetricValues& errors = metrics.standard_error;
    for (std::size_t kind = 0; kind < kBandMetricKinds.size(); ++kind) {
        const auto value = kBandMetricKinds[kind].value;
        auto& forms = result.metric_tables[kind][set];
        for (std::size_t band = 0; band < metrics.bands.size(); ++band) {
            const bool has_error = band < errors.bands.size();
            append(metrics.bands[band].*value,
                   has_error ? errors.bands[band].*value : std::nullopt,
                   forms[ES_PER_BAND]);
        }
        append(metrics.mid.*value, errors.mid.*value, forms[ES_SINGLE_NUMBER]);
    }
    append(metrics.speech_transmission_index,
           errors.speech_transmission_index,
           result.metric_tables[ES_METRIC_STI][set][ES_SINGLE_NUMBER]);
}

void append_spatial(const PairMetrics& pair, ResultObject& result) {
    const auto append_bands = [&](std::size_t metric,
                                  const std::vector<std::optional<double>>& values) {
        for (const std::optional<double>& value : values) {
            append(value, std::nullopt, result.metric_tables[metric][ES_RESPONSE][ES_PER_BAND]);
        }
    };
    if (pair.lateral) {
        append_bands(ES_METRIC_LF, pair.lateral->lateral_fraction);
    }
    if (pair.binaural) {
        append_bands(ES_METRIC_IACC_EARLY, pair.binaural->iacc_early);
        append_bands(ES_METRIC_IACC_LATE, pair.binaural->iacc_late);
        append_bands(ES_METRIC_IACC, pair.binaural->iacc);
    }
}

bool is_about(const MetricNote& note, std::string_view key) {
    return note.metric == key || note.metric == "all" ||
           (note.metric == "iacc" && key.starts_with("iacc"));
}

/// The note that is most about a metric: of the band itself, else of no band.
const std::string* find_note(const std::vector<MetricNote>& notes,
                             std::string_view key,
                             std::optional<double> band_hz) {
    const std::string* general = nullptr;
    for (const MetricNote& note : notes) {
        if (!is_about(note, key)) {
            continue;
        }
        if (note.band_hz == band_hz) {
            return &note.text;
        }
        if (!note.band_hz && general == nullptr) {
            general = &note.text;
        }
    }
    return general;
}

}  // namespace

const MetricKind* metric_kind(std::int32_t metric) {
    static const std::array<MetricKind, kMetricCount> kinds = [] {
        std::array<MetricKind, kMetricCount> all{};
        for (std::size_t i = 0; i < kBandMetricKinds.size(); ++i) {
            const audio::BandMetricKind& kind = kBandMetricKinds[i];
            all[i] = {kind.key.data(),
                      kind.unit.data() == nullptr ? "" : kind.unit.data(),
                      kind.just_noticeable_difference,
                      kind.relative};
        }
        all[ES_METRIC_STI] = {"sti", "", audio::kSpeechJustNoticeableDifference, false};
        all[ES_METRIC_SCHROEDER] = {"schroeder_hz", "Hz", kNoValue, false};
        all[ES_METRIC_LF] = {"lf", "", kNoValue, false};
        all[ES_METRIC_IACC_EARLY] = {"iacc_early", "", kNoValue, false};
        all[ES_METRIC_IACC_LATE] = {"iacc_late", "", kNoValue, false};
        all[ES_METRIC_IACC] = {"iacc", "", kNoValue, false};
        return all;
    }();
    const bool exists = metric >= 0 && static_cast<std::size_t>(metric) < kinds.size();
    return exists ? &kinds[static_cast<std::size_t>(metric)] : nullptr;
}

void flatten_metrics(ResultObject& result) {
    for (const PairMetrics& pair : result.metrics) {
        append(pair.expected, ES_EXPECTED, result);
        append(pair.response, ES_RESPONSE, result);
        append_spatial(pair, result);
        append(pair.schroeder_hz,
               std::nullopt,
               result.metric_tables[ES_METRIC_SCHROEDER][ES_EXPECTED][ES_SINGLE_NUMBER]);
    }
}

const std::string* note_of(const ResultObject& result,
                           std::int32_t metric,
                           std::int32_t set,
                           std::size_t pair,
                           std::uint32_t band) {
    const PairMetrics& metrics = result.metrics[pair];
    const std::string_view key = metric_kind(metric)->key;
    const std::vector<MetricNote>* notes =
        set == ES_EXPECTED ? &metrics.expected.notes : &metrics.response.notes;
    if (metric == ES_METRIC_LF && metrics.lateral) {
        notes = &metrics.lateral->notes;
    } else if (metric >= ES_METRIC_IACC_EARLY && metrics.binaural) {
        notes = &metrics.binaural->notes;
    }
    if (band != ES_NONE) {
        return find_note(*notes, key, result.bands.nominal_hz()[band]);
    }
    // A single number has no value for want of one in its bands.
    const std::string* note = find_note(*notes, key, std::nullopt);
    for (const double mid_hz : {500.0, 1000.0, 400.0, 630.0, 800.0, 1250.0}) {
        if (note == nullptr) {
            note = find_note(*notes, key, mid_hz);
        }
    }
    return note;
}

}  // namespace earshot::capi
