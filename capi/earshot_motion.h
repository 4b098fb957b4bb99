// SPDX-License-Identifier: MIT
//
// Sound of sources, listeners and scenes that move.
// Part of earshot.h, which says what holds for all.
#ifndef EARSHOT_MOTION_H
#define EARSHOT_MOTION_H

#include "earshot_base.h"
#include "earshot_simulation.h"
#include "earshot_sound.h"

/// A pair that moves, and how often it is looked at; defaults in brackets.
typedef struct es_motion_options {
    size_t struct_size;
    uint32_t source;            ///< index of the scene (0)
    uint32_t listener;          ///< index of the scene (0)
    const double* source_path;  ///< (source_path_count, 4): time, x, y, z; null: where the scene
                                ///< has it (null)
    size_t source_path_count;
    const double* listener_path;  ///< likewise (null)
    size_t listener_path_count;
    double step;       ///< seconds between the instants at which paths are found (0.05)
    double late_step;  ///< seconds between the instants at which late sound is traced (0.5)
} es_motion_options;

/// Sets all members to their defaults, `struct_size` to `size`.
ES_API es_status es_motion_options_init(es_motion_options* options, size_t size);

/// What the listener hears of a dry recording of one channel while the source, the listener or the
/// scene moves, as `earshot auralize --scene` does: every path is a delay that follows its length.
/// The recording begins at `simulation->time`, and its sample rate is that of the result. Paths are
/// cubics with continuous velocity from time to time, which ascend. `simulation` null: order 3, at
/// most 200,000 rays until T30 has a standard error of 5 %; `motion` null: the defaults. Reads
/// `scene` and `dry`.
ES_API es_status es_auralize_moving(es_scene scene,
                                    es_sound dry,
                                    const es_simulation_options* simulation,
                                    const es_motion_options* motion,
                                    es_sound* wet);

/// What the listener hears of a dry recording of one channel over paths that have been found
/// already, as `earshot auralize --paths` does: without late sound, from the first instant on.
/// `paths`: a paths.json of `earshot ir --frames`. `source`, `listener`: names; null: the only one.
/// Of `simulation` count format (ambisonic order and HRIR set included), threads and progress;
/// null: mono. The sample rate is that of the recording. Reads `dry`.
ES_API es_status es_auralize_paths(const char* paths,
                                   const char* source,
                                   const char* listener,
                                   es_sound dry,
                                   const es_simulation_options* simulation,
                                   es_sound* wet);
/// The same over the paths of results, as of es_simulator_run(), whose times ascend: at least two,
/// of one scene with the same bands and air. `source`, `listener`: indices of the scene. Reads
/// `results` and `dry`.
ES_API es_status es_auralize_results(const es_result* results,
                                     size_t count,
                                     uint32_t source,
                                     uint32_t listener,
                                     es_sound dry,
                                     const es_simulation_options* simulation,
                                     es_sound* wet);

#endif
