// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/io/internal/result_files.h"
#include "earshot/io/report.h"

#include <nlohmann/json.hpp>

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace earshot::io {

// The blocks of a report's data, as docs/report.md describes them.

/// "SUBJECT: WHAT" of each.
nlohmann::ordered_json warnings_block(const Warnings& warnings);

/// `digest`: of the scene; empty: there is none.
nlohmann::ordered_json provenance_block(const ReportProvenance& provenance,
                                        const std::string& digest);

/// SHA-256, as hexadecimal digits, of what the scene is at a time: positions, triangles, materials
/// and where its sources and listeners are.
std::string scene_digest(const propagation::Scene& scene, double time);

/// Walls at a time, for the view: positions, triangles, materials, meshes. Appends a warning if
/// there are more triangles than kMaxReportTriangles.
nlohmann::ordered_json scene_block(const propagation::Scene& scene,
                                   double time,
                                   Warnings& warnings);

/// Each material with its area and coefficients.
nlohmann::ordered_json materials_block(const propagation::Scene& scene,
                                       double time,
                                       std::span<const std::uint32_t> default_materials,
                                       const audio::Bands& bands);

/// What is told of a pair.
struct PairDetail {
    /// All energies that arrive are known, the late ones too, so decays are those of the metrics.
    bool decays = true;
    std::size_t max_points = 400;  ///< of a decay curve or a histogram
};

/// A pair as JSON text. `source` and `listener` are indices into the page's lists.
std::string pair_block(const ResultPair& pair,
                       const audio::Bands& bands,
                       std::size_t source,
                       std::size_t listener,
                       const PairDetail& detail,
                       const std::optional<ReportAudio>& audio = {});

/// Which surfaces matter, of the first pairs. Appends a warning if pairs are left out.
/// `source_of`, `listener_of`: indices of each pair.
nlohmann::ordered_json sensitivity_block(const ResultFiles& results,
                                         std::span<const std::size_t> source_of,
                                         std::span<const std::size_t> listener_of,
                                         Warnings& warnings);

/// Which surface is worth treating for a pair; nothing if its sensitivity is not known. `place`:
/// how the pair is called.
std::optional<nlohmann::ordered_json> treatment_line(const ResultFiles& results,
                                                     std::size_t pair,
                                                     const std::string& place);

/// A line per question: size, reverberation, speech, limits that were asked for.
nlohmann::ordered_json verdict_block(const RoomReport& report, const ResultFiles& results);

}  // namespace earshot::io
