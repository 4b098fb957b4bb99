// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/floating_point.h"

#include <string>
#include <string_view>

namespace earshot::io {

/// Whether the library carries the page of reports, which `report/bundle` makes before the build.
bool has_report_page() noexcept;

/// Throws Error unless has_report_page(): for work that takes long, before it begins.
void require_report_page();

/// The HTML page that shows the data of a report (report.h), complete in itself: script, style,
/// licences and a content security policy that lets it load nothing. Throws Error unless
/// has_report_page().
std::string report_page(std::string_view data);

}  // namespace earshot::io
