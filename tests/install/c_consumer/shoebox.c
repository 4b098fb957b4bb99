// SPDX-License-Identifier: MIT
#include <earshot.h>
#include <stdio.h>

// The direct sound and six first reflections of a shoe-box, from the installed library.
int main(void) {
    const double size[3] = {5.0, 3.0, 4.0}, from[3] = {1.0, 1.0, 1.0}, to[3] = {4.0, 2.0, 2.0};
    es_scene room = 0;
    es_result result = 0;
    es_simulation_options options;
    es_result_info info;
    info.struct_size = sizeof info;
    es_simulation_options_init(&options, sizeof options);
    options.order = 1;
    options.rays = 0;
    if (es_version() != ES_VERSION || es_scene_create_shoebox(size, &room) != ES_OK ||
        es_scene_add(room, ES_SOURCES, from, NULL, 1, NULL) != ES_OK ||
        es_scene_add(room, ES_LISTENERS, to, NULL, 1, NULL) != ES_OK ||
        es_simulate(room, &options, &result) != ES_OK ||
        es_result_get_info(result, &info) != ES_OK) {
        fprintf(stderr, "%s\n", es_error_message());
        return 1;
    }
    es_release(result);
    es_release(room);
    return info.paths == 7 && es_object_count() == 0 ? 0 : 1;
}
