// SPDX-License-Identifier: MIT
//
// Report pages.
// Part of earshot.h, which says what holds for all.
#ifndef EARSHOT_REPORT_H
#define EARSHOT_REPORT_H

#include "earshot_simulation.h"

/// What a report page shows beside a result; docs/report.md describes the page. Defaults in
/// brackets.
typedef struct es_report_options {
    size_t struct_size;
    es_scene scene;              ///< whose walls are shown at the result's time; 0: none (0)
    const char* title;           ///< null: the name of the result's scene (null)
    const char* command;         ///< how the result was made, as the page tells it; null: "" (null)
    const char* reference_file;  ///< a metrics.json to compare with; null: none (null)
    const char* const* limits;   ///< (limit_count): what metrics are to be, "sti=0.6" (null)
    size_t limit_count;          ///< 0 ... 1000 (0)
} es_report_options;

/// Sets all members to their defaults, `struct_size` to `size`.
ES_API es_status es_report_options_init(es_report_options* options, size_t size);

/// Whether the library carries the page, which it does if `report/dist/page.html` was there when it
/// was built: 1 or 0.
ES_API int32_t es_has_report_page(void);

/// Writes the page that shows a result, whole or not at all, or the data alone if the name of
/// `file` ends in ".json". It holds what the result does: paths, metrics and, with
/// es_simulation_options::histograms, decay curves, with ::sensitivity, which surfaces matter.
/// `options` null: the defaults. Fails with ES_ERROR_FAILED without the page. Reads `result` and
/// the options' scene.
ES_API es_status es_result_write_report(es_result result,
                                        const es_report_options* options,
                                        const char* file);

#endif
