// SPDX-License-Identifier: MIT
// Report pages of results.
#include "earshot/capi/internal/checks.h"
#include "earshot/capi/internal/result_object.h"
#include "earshot/capi/internal/scene_object.h"
#include "earshot/io/report.h"
#include "earshot/io/report_page.h"
#include "earshot/io/whole_file.h"

#include <filesystem>
#include <optional>
#include <string>
#include <utility>

namespace earshot::capi {
namespace {

constexpr es_report_options kReportDefaults = {.struct_size = sizeof(es_report_options),
                                               .scene = 0,
                                               .title = nullptr,
                                               .command = nullptr,
                                               .reference_file = nullptr,
                                               .limits = nullptr,
                                               .limit_count = 0};

/// What the options say, beside the scene.
void apply(const es_report_options& options, io::RoomReport& report) {
    report.title = text_or(options.title, report.title, "title");
    report.provenance.command = text_or(options.command, "", "command");
    const std::filesystem::path reference(text_or(options.reference_file, "", "reference_file"));
    if (!reference.empty()) {
        report.reference = {reference.string(), io::read_whole_file(reference)};
        report.reference_name = reference.filename().string();
    }
    constexpr std::size_t kMaxLimits = 1000;
    require_count(options.limit_count, 0, kMaxLimits, "limit_count");
    for (const char* const limit : require_array(options.limits, options.limit_count, "limits")) {
        report.limits.push_back(io::parse_report_limit(require_text(limit, "limits")));
    }
}

/// The texts of the files of `earshot ir` that the result holds.
io::RoomReport report_of(const ResultObject& result) {
    io::RoomReport report{.title = std::filesystem::path(result.names.name).stem().string(),
                          .provenance = {.version = es_version_text()},
                          .time = result.info.time,
                          .warnings = result.notes};
    if (result.has_paths) {
        report.paths = {"paths.json", document_text(result, ES_PATHS_JSON)};
    }
    if (result.has_histograms) {
        report.histograms = {"histograms.json", document_text(result, ES_HISTOGRAMS_JSON)};
    }
    if (!result.metrics.empty()) {
        report.metrics = {"metrics.json", document_text(result, ES_METRICS_JSON)};
    }
    if (!result.sensitivity.empty()) {
        report.sensitivity = {"sensitivity.json", document_text(result, ES_SENSITIVITY_JSON)};
    }
    return report;
}

}  // namespace
}  // namespace earshot::capi

using namespace earshot;
using namespace earshot::capi;

es_status es_report_options_init(es_report_options* options, size_t size) {
    return call(__func__,
                [&] { init_struct(kReportDefaults, options, size, sizeof(es_report_options)); });
}

int32_t es_has_report_page(void) {
    return io::has_report_page() ? 1 : 0;
}

es_status es_result_write_report(es_result result,
                                 const es_report_options* options,
                                 const char* file) {
    return call(__func__, [&] {
        const std::filesystem::path path(require_text(file, "file"));
        const Reading<ResultObject> object(result, "result");
        const es_report_options given =
            options == nullptr
                ? kReportDefaults
                : require_struct(*options, kReportDefaults, sizeof(es_report_options), "options");
        const bool data_only = path.extension() == ".json";
        if (!data_only) {
            io::require_report_page();
        }
        io::RoomReport report = report_of(*object);
        apply(given, report);
        std::optional<Reading<SceneObject>> scene;
        if (given.scene != 0) {
            scene.emplace(given.scene, "options->scene");
            require_triangles_of((*scene)->loaded.scene);
            report.scene = &(*scene)->loaded.scene;
            report.default_materials = (*scene)->loaded.default_materials;
        }
        const std::string data = io::encode_room_report(report);
        io::write_whole_file(path, data_only ? data : io::report_page(data));
    });
}
