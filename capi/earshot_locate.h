// SPDX-License-Identifier: MIT
//
// Positions of sources and listeners from measured arrival times.
// Part of earshot.h, which says what holds for all.
#ifndef EARSHOT_LOCATE_H
#define EARSHOT_LOCATE_H

#include "earshot_base.h"

/// Options of `earshot calibrate --locate`, with their defaults (in brackets). Errors are standard
/// deviations of what is stated: 0 holds it, INFINITY says that nothing is known.
typedef struct es_locate_options {
    size_t struct_size;
    double source_error;            ///< of each coordinate of a source, metres (0.01)
    double listener_error;          ///< and of a listener (0.01)
    double temperature_error;       ///< of the air, kelvin: the speed of sound (2)
    double latency_error;           ///< seconds that a source starts late; stated as 0 (0)
    double wall_error;              ///< of the planes of reflecting surfaces, metres (0)
    double timing_error;            ///< of the times but for outliers, seconds, > 0 (4e-5)
    double match_window;            ///< how far a path may be from an arrival without surfaces,
                                    ///< seconds, > 0 (1e-3)
    int32_t order;                  ///< max reflections; -1: what the arrivals need (-1)
    uint32_t folds;                 ///< parts of a cross-validation, 2 or more; 0: none (0)
    uint64_t seed;                  ///< of the cross-validation (1)
    double time;                    ///< instant of the scene's animation, seconds (0)
    double temperature_c;           ///< of the air, degrees Celsius (20)
    double humidity_percent;        ///< relative (50)
    double pressure_kpa;            ///< (101.325)
    es_progress_callback progress;  ///< null: nobody wants to know (null)
    void* progress_data;            ///< its first argument
    int32_t threads;                ///< 0: one per core; changes no result (0)
} es_locate_options;

/// Sets all members to their defaults, `struct_size` to `size`.
ES_API es_status es_locate_options_init(es_locate_options* options, size_t size);

/// Locates the sources and listeners of a scene by `count` measured arrivals. `pairs`, (count, 2):
/// the index of the source and of the listener. `times`, (count): seconds since the emission.
/// `surfaces`, (count): names of the materials or meshes that reflected it, in order, with '>'
/// between them; "direct": none did; null or empty: not known, then the path closest in time is
/// taken. `surfaces` may be null if none is known. Stages: "locating", "cross-validation". Reads
/// `scene`, which stays as it is.
ES_API es_status es_locate(es_scene scene,
                           const uint32_t* pairs,
                           const double* times,
                           const char* const* surfaces,
                           size_t count,
                           const es_locate_options* options,
                           es_location* location);

// Locations never change: every function below reads `location`, and views are valid until it is
// released.

typedef struct es_location_info {
    size_t struct_size;
    size_t arrivals;         ///< that were given
    size_t matched;          ///< of them fit a path and were fitted
    size_t walls;            ///< that reflect them
    size_t motions;          ///< see es_location_motion()
    double median_before;    ///< of absolute errors of the stated scene, seconds
    double median_after;     ///< of the located one
    double median_held_out;  ///< of arrivals predicted from others; NaN without folds
    double rms_move;         ///< of coordinates, in stated errors; far above 1 these are too small
    double speed_of_sound;   ///< metres per second
    double speed_error;      ///< its standard error
    double temperature_c;    ///< of air in which sound is so fast
    int32_t order;           ///< of the paths that were looked for
    int32_t converged;       ///< 0: the rounds ended first
} es_location_info;

/// `info->struct_size` must be set.
ES_API es_status es_location_get_info(es_location location, es_location_info* info);

/// Positions of the sources or listeners (es_item), (count, 3), metres; their standard errors
/// (infinite where nothing tells it), and the part of what is known that the arrivals have told, 0
/// ... 1. The last two may be null.
ES_API es_status es_location_positions(es_location location,
                                       int32_t item,
                                       const double** positions,
                                       const double** standard_errors,
                                       const double** data_shares,
                                       size_t* count);
/// How late the sources start, (count), seconds, and the standard errors, which may be null.
ES_API es_status es_location_latencies(es_location location,
                                       const double** latencies,
                                       const double** standard_errors,
                                       size_t* count);
/// The planes that reflect arrivals, (count, 5): normal, stated and located offset along it,
/// metres; the standard errors of the offsets, and the index of the material. The last two may be
/// null.
ES_API es_status es_location_walls(es_location location,
                                   const double** planes,
                                   const double** standard_errors,
                                   const uint32_t** materials,
                                   size_t* count);
/// Of each arrival, (count, 4): model - measured before, after and held out, seconds, NaN where
/// there is none; its weight, 0 ... 1.
ES_API es_status es_location_arrivals(es_location location, const double** errors, size_t* count);
/// A motion of all sources and listeners together, "translation x", "rotation y", "scale", and the
/// part of what is known of it that the arrivals tell: near 0 it is as stated. There are none if
/// sources or listeners are held. Each pointer may be null; the name is valid until `location` is
/// released.
ES_API es_status es_location_motion(es_location location,
                                    size_t motion,
                                    const char** name,
                                    double* data_share);

/// Writes the JSON file of the program, whole or not at all.
ES_API es_status es_location_write(es_location location, const char* file);

#endif
