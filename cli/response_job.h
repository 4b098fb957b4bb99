// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/progress.h"
#include "earshot/propagation/response.h"
#include "earshot/propagation/room_statistics.h"
#include "earshot/propagation/sensitivity.h"
#include "earshot/propagation/simulator.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace earshot::cli {

/// What `earshot ir` computes and where it goes.
struct ResponseJob {
    const propagation::Scene& scene;
    propagation::Options simulation;
    propagation::ResponseFormat format;
    bool write_sofa = false;        ///< responses.sofa besides
    bool write_histograms = false;  ///< histograms.json besides
    /// Plans of the scene with labels besides, one per time, of a sequence with the number of the
    /// time before the suffix; empty: none.
    std::filesystem::path plan{};
    /// sensitivity.json besides; needs simulation.report_materials.
    bool write_sensitivity = false;
    bool keep_texts = false;  ///< ResponseSummary::texts, for a page
    /// Also count the paths that simulation.visible_sets cost; takes a complete search.
    bool check_visibility = false;
    std::vector<double> times{0.0};  ///< seconds
    bool is_sequence = false;        ///< file names carry the number of the time
    std::filesystem::path directory;
};

/// The texts of files, whether written or not.
struct ResponseTexts {
    std::string paths{}, metrics{}, histograms{};
    std::string sensitivity{};  ///< with Options::report_materials
};

/// What came of a job, for the summary.
struct ResponseSummary {
    std::vector<std::filesystem::path> files;  ///< in the order they were written
    std::vector<std::size_t> paths_of_order;   ///< over all pairs and times
    std::size_t paths_lost = 0;                ///< to visible sets, if that was checked
    Warnings notes;                            ///< pairs without a path, and the like
    propagation::GeometrySummary geometry;     ///< at the last time
    propagation::HierarchyStatistics hierarchies;
    geometry::Vec3 size{0.0};  ///< of the scene at the first time, metres
    /// Of the air that a source sees, cubic metres: the largest of all sources; 0 without rays.
    double visible_volume = 0.0;
    frustum::TraceStatistics statistics;  ///< over all times
    /// Per pair and time, as files; empty unless ResponseFormat::report_metrics.
    std::vector<propagation::PairMetrics> metrics;
    std::optional<propagation::RoomStatistics> room;  ///< at the first time, with metrics
    /// Per pair and time; empty unless Options::report_materials.
    std::vector<propagation::PairSensitivity> sensitivity;
    std::vector<double> material_areas;  ///< likewise, at the first time, square metres
    ResponseTexts texts;                 ///< if ResponseJob::keep_texts
    double prepare_seconds = 0.0;        ///< clean-up, facets and hierarchy
    double trace_seconds = 0.0;
    std::vector<double> update_seconds;  ///< preparing and tracing, per time
    double response_seconds = 0.0;       ///< synthesis, metrics and writing
};

/// Simulates, writes SOURCE__LISTENER.wav per pair (and time), paths.json and metrics.json,
/// if ResponseFormat::report_metrics, and responses.sofa and plans if asked. Throws Error; every
/// file that exists afterwards is whole.
ResponseSummary run_response_job(const ResponseJob& job, Executor& executor, Progress& progress);

}  // namespace earshot::cli
