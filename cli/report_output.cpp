// SPDX-License-Identifier: MIT
#include "earshot/cli/report_output.h"

#include "earshot/io/report_page.h"
#include "earshot/io/whole_file.h"

namespace earshot::cli {

CLI::Option* LimitOption::add_to(CLI::App& app) {
    return add_repeatable(app,
                          "--limit",
                          texts_,
                          "what a metric is to be at every listener: sti, c50, c80, d50 or g at "
                          "least, t30, t20, edt or ts at most, as in sti=0.6")
        ->type_name("METRIC=VALUE");
}

std::vector<io::ReportLimit> LimitOption::limits(const CLI::App& app) const {
    std::vector<io::ReportLimit> limits;
    for (const std::string& text : texts_) {
        try {
            limits.push_back(io::parse_report_limit(text));
        } catch (const Error& error) {
            throw wrong_usage(app, "--limit", "'" + text + "' " + error.what());
        }
    }
    return limits;
}

bool is_report_data(const std::filesystem::path& file) {
    return file.extension() == ".json";
}

void require_report(const std::filesystem::path& file) {
    if (!is_report_data(file)) {
        io::require_report_page();
    }
}

void write_report(const std::filesystem::path& file, const std::string& data) {
    io::write_whole_file(file, is_report_data(file) ? data : io::report_page(data));
}

std::string program_version() {
    return EARSHOT_VERSION;
}

}  // namespace earshot::cli
