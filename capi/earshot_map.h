// SPDX-License-Identifier: MIT
//
// Maps: metrics over an area.
// Part of earshot.h, which says what holds for all.
#ifndef EARSHOT_MAP_H
#define EARSHOT_MAP_H

#include "earshot_base.h"
#include "earshot_simulation.h"

typedef enum es_map_area {
    ES_MAP_RECTANGLE = 0,  ///< at one height
    ES_MAP_SURFACE = 1,    ///< above the faces of a material that look upwards
    ES_MAP_POINTS = 2      ///< given points
} es_map_area;

/// Options of `earshot map`, with their defaults (in brackets).
typedef struct es_map_options {
    size_t struct_size;
    int32_t area;         ///< es_map_area (rectangle)
    uint32_t material;    ///< of a surface: index into the scene's materials (0)
    double rectangle[4];  ///< x0, z0, x1, z1, metres (all 0)
    double height;        ///< y of the rectangle, or above the faces, metres (1.2)
    double step;          ///< edge of the smallest cells, metres, > 0 (0.25)
    double coarse_step;  ///< edge of the first cells, which are halved where values change; 0: four
                         ///< times `step` (0)
    double clearance;    ///< least distance of points to surfaces, metres (0.1)
    const double* points;  ///< (point_count, 3), of given points; null otherwise (null)
    size_t point_count;    ///< (0)
    /// Between commas: "sti", the key of a metric (its mean over 500 Hz and 1 kHz), or of one band,
    /// "t30:125"; null: "sti,t30,c80" (null)
    const char* metrics;
} es_map_options;

/// Sets all members to their defaults, `struct_size` to `size`.
ES_API es_status es_map_options_init(es_map_options* options, size_t size);

/// Maps metrics of all sources of a scene, as `earshot map` does: what es_simulate() expects of
/// listeners at the points, within the standard errors. `simulation` null: the defaults of
/// es_simulate() with order 3, rays_error 0.04 and 200000 rays; its time, order, transmission,
/// rays, rays_error, seed, air, bands, speech, progress and threads count. Reads `scene`.
ES_API es_status es_map_create(es_scene scene,
                               const es_simulation_options* simulation,
                               const es_map_options* options,
                               es_metric_map* map);

// Maps never change: every function below reads `map`, and views are valid until it is released.

typedef struct es_map_info {
    size_t struct_size;
    size_t points;            ///< one per cell, or those that were given
    size_t sources;           ///< of the scene
    size_t metrics;           ///< as they were asked for
    size_t points_evaluated;  ///< those of cells that were halved included
    size_t points_uncertain;  ///< whose rays did not reach the error that was asked for
    size_t outside;           ///< left out: outside of the room
    size_t in_solid;          ///< left out: inside solids
    size_t near_surface;      ///< left out: nearer to a surface than the clearance
    double time;              ///< seconds, of the scene's animation
} es_map_info;

/// `info->struct_size` must be set.
ES_API es_status es_map_get_info(es_metric_map map, es_map_info* info);

/// Values and standard errors, (points, sources, metrics), in the metrics' units; NaN where there
/// is none. A value may be withheld for being uncertain while its error is a number.
/// `standard_errors` may be null.
ES_API es_status es_map_values(es_metric_map map,
                               const double** values,
                               const double** standard_errors,
                               size_t shape[3]);
/// Where they are, (points, 3).
ES_API es_status es_map_points(es_metric_map map, const double** points, size_t* count);
/// The cells that they stand for, (points, 4): x0, z0, x1, z1; NaN for given points.
ES_API es_status es_map_cells(es_metric_map map, const double** cells, size_t* count);
/// Name, unit and just-noticeable difference of a metric, by its index; a share of the value if
/// `relative` is 1. Each pointer may be null. Texts are valid until `map` is released.
ES_API es_status es_map_metric(es_metric_map map,
                               size_t metric,
                               const char** name,
                               const char** unit,
                               double* just_noticeable_difference,
                               int32_t* relative);

typedef struct es_map_limit {
    size_t struct_size;
    double share;  ///< of the area (of given points: of their number) that keeps it, 0 ... 1
    double uncertain_share;  ///< nearer to the limit than two standard errors
    double unknown_share;    ///< without a value; counts as not keeping it
    double worst;            ///< the worst value; NaN if there is none
    double worst_point[3];   ///< where it is
} es_map_limit;

/// How much of the map of a source keeps a limit: values of at least `value` if `is_minimum` is 1,
/// at most otherwise. `result->struct_size` must be set.
ES_API es_status es_map_evaluate_limit(es_metric_map map,
                                       size_t source,
                                       size_t metric,
                                       double value,
                                       int32_t is_minimum,
                                       es_map_limit* result);

/// Lines on the map of a source where the value is `level`. `count` gets the number of their
/// points; `points` (capacity, 3) and `lines` (capacity) get the first of them and the number of
/// the line that each belongs to, in the order of the lines. A closed line ends where it begins.
/// Both may be null with capacity 0.
ES_API es_status es_map_contour(es_metric_map map,
                                size_t source,
                                size_t metric,
                                double level,
                                double* points,
                                uint32_t* lines,
                                size_t capacity,
                                size_t* count);

/// Writes the map as a .csv or .json file, the same bytes as the program (without limits), whole or
/// not at all.
ES_API es_status es_map_write(es_metric_map map, const char* file);

/// Draws a metric of a source as a plan into an .svg or .png file, the same bytes as the program,
/// whole or not at all: walls are those of `scene` at the map's time and height (0: none are
/// drawn), colours step by just-noticeable differences, about `limit` with its contour if that is
/// not NaN. Reads `map` and `scene`.
ES_API es_status es_map_draw(es_metric_map map,
                             size_t source,
                             size_t metric,
                             es_scene scene,
                             double limit,
                             const char* file);

#endif
