// SPDX-License-Identifier: MIT
#include "earshot/io/report_page.h"

#include "earshot/base/error.h"
#include "earshot/io/internal/report_template.h"

namespace earshot::io {

bool has_report_page() noexcept {
    return report_template().has_value();
}

void require_report_page() {
    if (!has_report_page()) {
        throw Error("report",
                    "earshot was built without the page of reports, report/dist/page.html",
                    "make it with report/bundle or scripts/test (both need npm), and build again");
    }
}

std::string report_page(std::string_view data) {
    require_report_page();
    return assemble_report(*report_template(), data);
}

}  // namespace earshot::io
