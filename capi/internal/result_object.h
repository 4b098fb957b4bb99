// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/bands.h"
#include "earshot/audio/speech.h"
#include "earshot/base/error.h"
#include "earshot/capi/internal/object_table.h"
#include "earshot/io/room_sofa.h"
#include "earshot/propagation/pair_metrics.h"
#include "earshot/propagation/pair_result.h"
#include "earshot/propagation/pose.h"
#include "earshot/propagation/response.h"
#include "earshot/propagation/room_statistics.h"
#include "earshot/propagation/scene.h"
#include "earshot/propagation/sensitivity.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace earshot::capi {

inline constexpr std::size_t kMetricCount = ES_METRIC_IACC + 1;

/// A metric of all pairs: (sources, listeners, bands or 1); NaN where there is no value.
struct MetricTable {
    std::vector<double> values{}, errors{};
};

/// A histogram of late sound, (bins, bands).
struct HistogramTable {
    std::vector<double> energy{}, error{};
};

/// What a simulation found, as flat arrays and as the library's objects. Never changes after
/// finish().
struct ResultObject : ObjectOf<ES_KIND_RESULT> {
    propagation::Scene names;  ///< of the scene and its materials, without geometry
    audio::Bands bands = audio::Bands::octaves();
    es_result_info info{};
    std::optional<audio::SpeechConditions> speech{};
    std::vector<propagation::PairResult> pairs;
    std::vector<propagation::Pose> listener_poses;  ///< per pair
    std::vector<propagation::PairMetrics> metrics;  ///< per pair, or none
    std::optional<propagation::RoomStatistics> room;
    std::vector<propagation::PairSensitivity> sensitivity;  ///< per pair, or none
    std::vector<double> material_areas;                     ///< with it, square metres
    Warnings notes;
    bool has_paths = true;
    bool has_histograms = false;
    propagation::Channels channels = propagation::Channels::mono;
    std::vector<io::RoomMeasurement> measurements;  ///< per pair, for a SOFA file, or none

    std::vector<float> responses;        ///< (sources, listeners, channels, samples)
    std::vector<std::uint64_t> lengths;  ///< (sources, listeners)

    // Made of the above by finish().
    std::vector<es_path> paths;
    std::vector<std::uint64_t> first_path;
    std::vector<double> points, pressure;
    std::vector<std::uint32_t> triangles, materials;
    std::vector<std::uint64_t> first_edge;
    std::vector<double> edges;
    /// Per metric, set and form; empty where a metric does not have that.
    std::array<std::array<std::array<MetricTable, 2>, 2>, kMetricCount> metric_tables;
    std::vector<HistogramTable> histograms;  ///< per pair, or none
    /// Of sensitivity: the energies of es_sensitivity in their order, and derivatives per metric
    /// and form.
    std::array<std::vector<double>, 6> material_energies;
    std::array<std::array<MetricTable, 2>, ES_METRIC_STI + 1> derivative_tables;

    std::size_t pair_index(std::size_t source, std::size_t listener) const noexcept {
        return source * info.listeners + listener;
    }
    void finish();

private:
    void flatten_paths();
    void flatten_histograms();
    void flatten_sensitivity();
};

/// Throws Error if the result does not tell its paths.
void require_paths(const ResultObject& result);

/// Throws Error if the result tells nothing of materials.
void require_sensitivity(const ResultObject& result);

/// Fills in metric_tables of metrics.
void flatten_metrics(ResultObject& result);

/// Why a metric of a pair has no value; null if nothing is to be told. `band`: its index, or
/// ES_NONE.
const std::string* note_of(const ResultObject& result,
                           std::int32_t metric,
                           std::int32_t set,
                           std::size_t pair,
                           std::uint32_t band);

/// The text of one of the files that `earshot ir` writes (es_document); throws if the result lacks
/// it.
std::string document_text(const ResultObject& result, std::int32_t document);

}  // namespace earshot::capi
