// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/error.h"
#include "earshot/io/report_audio.h"
#include "earshot/propagation/scene.h"

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace earshot::io {

// The data of report pages (docs/report.md): JSON text, the same bytes from run to run.
// report_page() makes a page of it.

/// Where a report comes from. Names are without folders.
struct ReportProvenance {
    std::string version{};                ///< of the program
    std::string command{};                ///< its command line
    std::optional<std::uint64_t> seed{};  ///< of everything random
    std::vector<std::string> files{};     ///< that it was made from
};

/// A file of results, as written or read.
struct ReportFile {
    std::string name{};  ///< for errors
    std::string text{};  ///< empty: there is none
};

/// What a metric is to be at every listener: at least the value, of times at most.
struct ReportLimit {
    std::string metric{};  ///< sti, or a key of audio::kBandMetricKinds for its mid-frequency mean
    double value = 0.0;
};

/// Reads `sti=0.6`. Throws Error naming the text if it is not of that form.
ReportLimit parse_report_limit(std::string_view text);

/// Results of `earshot ir`. Files that are missing leave out what they hold.
struct RoomReport {
    std::string title{};
    ReportProvenance provenance{};
    ReportFile metrics{};          ///< metrics.json
    ReportFile paths{};            ///< paths.json
    ReportFile histograms{};       ///< histograms.json
    ReportFile sensitivity{};      ///< sensitivity.json
    ReportFile reference{};        ///< metrics.json of another run, to compare with
    std::string reference_name{};  ///< that the page gives to it
    /// For the view of the walls at a time in seconds; must outlive the call.
    const propagation::Scene* scene = nullptr;
    double time = 0.0;
    /// Indices of materials without acoustic data.
    std::vector<std::uint32_t> default_materials{};
    std::vector<ReportLimit> limits{};
    /// What the page plays of a source and a listener at a time, asked for of the first
    /// kMaxReportSounds pairs; empty: nothing.
    std::function<std::optional<ReportAudio>(
        const std::string& source, const std::string& listener, double time)>
        audio_of{};
    Warnings warnings{};
};

/// Bounds of what a page holds; what is left out is told in its warnings.
inline constexpr std::size_t kMaxReportTriangles = 200000;  ///< the largest
inline constexpr std::size_t kMaxReportPairs = 1000;        ///< the first
inline constexpr std::size_t kMaxReportPathsOfPair = 500;   ///< the strongest
inline constexpr std::size_t kMaxReportPaths = 12000;       ///< of all pairs, 20 of each at least

inline constexpr std::size_t kMaxReportSensitivities = 20000;  ///< materials, of all pairs

/// Throws Error naming the file if one is not of the form that it should have.
std::string encode_room_report(const RoomReport& report);

}  // namespace earshot::io
