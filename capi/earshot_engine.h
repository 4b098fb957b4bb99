// SPDX-License-Identifier: MIT
//
// The sound of a scene in real time.
// Part of earshot.h, which says what holds for all.
#ifndef EARSHOT_ENGINE_H
#define EARSHOT_ENGINE_H

#include "earshot_base.h"
#include "earshot_simulation.h"

/// Defaults in brackets.
typedef struct es_engine_options {
    size_t struct_size;
    int32_t order;            ///< max reflections and transmissions of a path, 0 ... 64 (3)
    uint32_t rays;            ///< of late sound, per source and renewal; 0: none (2000)
    uint32_t block;           ///< frames rendered at once, a power of two, 32 ... 4096 (256)
    int32_t any_frame_count;  ///< 1: calls may have any number of frames, a block later; 0: a
                              ///< multiple of `block` (0)
    double motion_delay;      ///< seconds by which motion is heard later than it is published, at
                              ///< least the time between updates, 0 ... 10 (0.1)
    double max_delay;         ///< seconds; longer paths are left out, up to 10 (1)
    uint32_t max_paths;       ///< per listener, 1 ... 65536 (512)
    uint32_t max_filters;     ///< that stand for the spectra of all paths, 1 ... 64 (24)
    double late_length;       ///< seconds, 0 ... 20; 0: as the sound decays, at most 3 (0)
    double update_interval;   ///< seconds between updates of the engine's thread, 0 ... 60 (0.05)
    double budget_milliseconds;  ///< of an update; 0: no limit (0)
    uint64_t budget_work;        ///< of an update, in units of work; 0: no limit (0)
} es_engine_options;

/// Sets all members to their defaults, `struct_size` to `size`.
ES_API es_status es_engine_options_init(es_engine_options* options, size_t size);

/// Prepares a scene to be heard while it moves, and finds its first paths (docs/engine.md). Of
/// `simulation` count the time of the animation at which it begins, the air, materials'
/// transmission, limits of paths, bands, format (ambisonic order and HRIR set included), sample
/// rate, seed and threads; null: the defaults, binaural. `options` null: the defaults. Reads
/// `scene`, which is not needed after this.
ES_API es_status es_engine_create(es_scene scene,
                                  const es_simulation_options* simulation,
                                  const es_engine_options* options,
                                  es_engine* engine);

typedef struct es_engine_info {
    size_t struct_size;
    size_t sources, listeners;
    size_t channels;  ///< of each listener
    double sample_rate;
    size_t block;
    size_t latency;  ///< frames by which all is heard late, besides the delays of paths
} es_engine_info;

/// Reads `engine`, as all functions below do: any of them may run at the same time.
ES_API es_status es_engine_get_info(es_engine engine, es_engine_info* info);

/// Where a source is, and where it looks; `front` null: along -Z. Heard after es_engine_publish().
ES_API es_status es_engine_place_source(es_engine engine,
                                        size_t source,
                                        const double position[3],
                                        const double front[3]);
ES_API es_status es_engine_place_listener(es_engine engine,
                                          size_t listener,
                                          const double position[3]);
/// The time of the scene's animation, seconds.
ES_API es_status es_engine_set_time(es_engine engine, double time);
/// Makes what was set valid for the frame that is rendered next. Of what is published the newest
/// counts.
ES_API es_status es_engine_publish(es_engine engine);

/// How a listener is turned, from the next block on. `front` and `up` of any length, not parallel.
ES_API es_status es_engine_turn_listener(es_engine engine,
                                         size_t listener,
                                         const double front[3],
                                         const double up[3]);

/// Finds paths for the newest state. Fails with ES_ERROR_BUSY while another call does, and after
/// es_engine_start().
ES_API es_status es_engine_update(es_engine engine);
/// Starts and ends the engine's own thread of updates.
ES_API es_status es_engine_start(es_engine engine);
ES_API es_status es_engine_stop(es_engine engine);

/// Renders `frames` frames of every source, `inputs` (sources, frames), into `outputs` (listeners,
/// channels, frames): for files and tests. Takes a lock to find the engine: an audio thread calls
/// es_renderer_render(). Fails with ES_ERROR_BUSY while another call renders.
ES_API es_status es_engine_render(es_engine engine,
                                  const float* inputs,
                                  size_t frames,
                                  float* outputs);

/// The engine as its audio thread sees it: a view of `engine`, valid until it is released.
typedef struct es_renderer es_renderer;
ES_API es_status es_engine_renderer(es_engine engine, es_renderer** renderer);
/// Renders `frames` frames: `inputs` has a pointer per source, `outputs` one per listener and
/// channel; null is silence, or not wanted. Takes no lock, allocates no memory and makes no system
/// call; checks nothing. For one thread at a time, while nobody calls es_engine_render(). Outputs
/// are silent if `frames` is no multiple of the block and any_frame_count is 0.
ES_API void es_renderer_render(es_renderer* renderer,
                               const float* const* inputs,
                               float* const* outputs,
                               size_t frames);
/// es_engine_turn_listener() for the audio thread: unit vectors at right angles, checked by nobody.
ES_API void es_renderer_turn(es_renderer* renderer,
                             size_t listener,
                             const double front[3],
                             const double up[3]);

typedef struct es_engine_statistics {
    size_t struct_size;
    uint64_t updates;
    double median_update_milliseconds;  ///< of the last 1,024 updates
    double max_update_milliseconds;     ///< of all but the first
    uint64_t work;                      ///< of the last update
    uint64_t paths;                     ///< after the last update
    uint64_t dropped_paths, deferred_sources, deferred_late, reduced_late;  ///< of all updates
    uint64_t failed_updates;
    double max_filter_error;  ///< share of a path's pressure that the filters missed
    uint64_t blocks;          ///< rendered
    uint64_t late_snapshots;  ///< blocks at which paths came late
    uint64_t refused_calls;   ///< of es_renderer_render(), answered with silence
    uint64_t load[21];  ///< blocks by the share of their duration that rendering took, in steps of
                        ///< 5 per cent; the last: longer
} es_engine_statistics;

ES_API es_status es_engine_get_statistics(es_engine engine, es_engine_statistics* statistics);

#endif
