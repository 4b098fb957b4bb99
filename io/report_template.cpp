// SPDX-License-Identifier: MIT
#include "earshot/io/internal/report_template.h"

#include "earshot/base/error.h"

#include <algorithm>

#ifdef EARSHOT_REPORT_PAGE

// The file that report/bundle writes, byte for byte.
asm(R"(
    .section .rodata
    .type earshot_report_page, @object
    .global earshot_report_page
    .hidden earshot_report_page
earshot_report_page:
    .incbin ")" EARSHOT_REPORT_PAGE R"("
    .size earshot_report_page, . - earshot_report_page
    .global earshot_report_page_end
    .hidden earshot_report_page_end
earshot_report_page_end:
    .byte 0
    .previous
)");
extern "C" const char earshot_report_page[];
extern "C" const char earshot_report_page_end[];

#endif

namespace earshot::io {

std::optional<std::string_view> report_template() noexcept {
#ifdef EARSHOT_REPORT_PAGE
    return std::string_view(
        earshot_report_page,
        static_cast<std::size_t>(earshot_report_page_end - earshot_report_page));
#else
    return std::nullopt;
#endif
}

std::string escape_for_script(std::string_view json) {
    constexpr std::string_view kLineSeparators = "\xe2\x80";  // U+2028 and U+2029 begin so
    std::string text;
    text.reserve(json.size());
    for (std::size_t i = 0; i < json.size(); ++i) {
        const char c = json[i];
        if (c == '<') {
            text += "\\u003c";
        } else if (c == '>') {
            text += "\\u003e";
        } else if (c == '&') {
            text += "\\u0026";
        } else if (json.substr(i, 2) == kLineSeparators && i + 2 < json.size() &&
                   (json[i + 2] == '\xa8' || json[i + 2] == '\xa9')) {
            text += json[i + 2] == '\xa8' ? "\\u2028" : "\\u2029";
            i += 2;
        } else {
            text += c;
        }
    }
    return text;
}

std::string assemble_report(std::string_view page, std::string_view data) {
    const std::size_t at = page.find(kReportDataMarker);
    if (at == std::string_view::npos ||
        page.find(kReportDataMarker, at + 1) != std::string_view::npos) {
        throw Error("report page",
                    "has not one place for data",
                    "make it again with report/bundle, and build again");
    }
    const std::string escaped = escape_for_script(data);
    std::string text;
    text.reserve(page.size() + escaped.size());
    text += page.substr(0, at);
    text += escaped;
    text += page.substr(at + kReportDataMarker.size());
    return text;
}

}  // namespace earshot::io
