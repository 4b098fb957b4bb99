// SPDX-License-Identifier: MIT
//
// Checks: what a model needs before its results are trusted, and mended copies.
// Part of earshot.h, which says what holds for all.
#ifndef EARSHOT_CHECK_H
#define EARSHOT_CHECK_H

#include "earshot_base.h"
#include "earshot_scene.h"

/// Whether this library can check models, which it can if it was built with OpenMesh: 1 or 0.
ES_API int32_t es_has_check(void);

/// Options of `earshot check`, with their defaults (in brackets).
typedef struct es_check_options {
    size_t struct_size;
    double time;    ///< seconds, of the scene's animation (0)
    uint64_t seed;  ///< (1)
    uint64_t rays;  ///< at most so many look for the air, >= 1000 (20000000)
    double crack;   ///< share of a room's surface below which an opening into a solid counts
                    ///< as a crack, 0 ... 1 (0.01)
    double forecast_seconds;        ///< to spend on the forecast of time; 0: none (0)
    int32_t threads;                ///< 0: all cores (0)
    es_progress_callback progress;  ///< may be null (null)
    void* progress_data;            ///< (null)
} es_check_options;

/// Sets all members to their defaults, `struct_size` to `size`.
ES_API es_status es_check_options_init(es_check_options* options, size_t size);

/// Examines a scene as `earshot check` does. `options` null: the defaults. The check keeps a copy
/// of the scene. All but the forecast depends on the scene and the options alone. Reads `scene`.
ES_API es_status es_check_create(es_scene scene,
                                 const es_check_options* options,
                                 es_model_check* check);

// Checks never change: every function below reads `check`, and views are valid until it is
// released.

typedef enum es_severity {
    ES_NOTE = 0,          ///< worth knowing, nothing to mend
    ES_QUESTIONABLE = 1,  ///< results may not be those of the room that is meant
    ES_UNUSABLE = 2       ///< no result can come of it
} es_severity;

typedef struct es_check_info {
    size_t struct_size;
    int32_t verdict;   ///< es_severity of the gravest finding
    int32_t outdoors;  ///< 1: the size is judged as that of a place outdoors
    int32_t open;      ///< 1: the air goes on beyond the scene
    size_t findings;
    size_t airs;      ///< that sources and listeners lie in
    uint64_t rays;    ///< that looked for the air
    double lower[3];  ///< corners of the scene's box, metres
    double upper[3];
    double volume;     ///< of the largest air, cubic metres; 0: unknown, as outdoors
    double surface;    ///< square metres
    const char* unit;  ///< that makes the model a plausible one: "mm", "cm", "in", "m"; "": none is
                       ///< proposed
    const char* up;    ///< the axis that goes with it, "y" or "z"; "": as it is
} es_check_info;

/// `info->struct_size` must be set.
ES_API es_status es_check_get_info(es_model_check check, es_check_info* info);

/// A finding by its index, the gravest first: its es_severity, and a sentence.
ES_API es_status es_check_finding(es_model_check check,
                                  size_t index,
                                  int32_t* severity,
                                  const char** text);

/// A box around something, metres and square metres.
typedef struct es_place {
    double centre[3];
    double size[3];
    double area;
} es_place;

/// An opening between the air of the sources and what is no part of it.
typedef struct es_leak {
    es_place place;   ///< `area`: what leaks
    int32_t escapes;  ///< 1: out of the scene; 0: into a solid or another air
    uint32_t hole;    ///< index among the holes; ES_NONE: a gap between borders
} es_leak;
ES_API es_status es_check_leaks(es_model_check check, const es_leak** leaks, size_t* count);

/// A loop of edges that belong to one triangle.
typedef struct es_hole {
    es_place place;
    double rim_length;  ///< metres
    uint32_t edges;
    int32_t is_outline;  ///< 1: the border of a sheet
} es_hole;
ES_API es_status es_check_holes(es_model_check check, const es_hole** holes, size_t* count);

typedef enum es_emitter_fault {
    ES_IN_SOLID = 0,
    ES_OUTSIDE = 1,
    ES_SEALED = 2  ///< in an air of its own
} es_emitter_fault;

/// A source or a listener at a place where it is of no use.
typedef struct es_misplaced {
    int32_t item;    ///< ES_SOURCES or ES_LISTENERS
    uint32_t index;  ///< among them
    double position[3];
    int32_t fault;   ///< es_emitter_fault
    int32_t proven;  ///< 1: by a closed surface; 0: by rays
} es_misplaced;
ES_API es_status es_check_misplaced(es_model_check check,
                                    const es_misplaced** misplaced,
                                    size_t* count);

typedef enum es_face_fault {
    ES_REVERSED = 0,  ///< only their backs face the air
    ES_DOUBLED = 1
} es_face_fault;

/// Connected triangles with the same fault.
typedef struct es_face_group {
    es_place place;
    size_t triangles;
    uint32_t first_triangle;
    int32_t is_reversed;  ///< 1: doubled by what faces the other way
} es_face_group;
/// `fault`: es_face_fault.
ES_API es_status es_check_faces(es_model_check check,
                                int32_t fault,
                                const es_face_group** groups,
                                size_t* count);

typedef enum es_triangle_list {
    ES_UNREACHED = 0,         ///< rays reached neither side
    ES_PROVEN_UNREACHED = 1,  ///< of these, those that a closed surface keeps all from
    ES_REVERSED_TRIANGLES = 2
} es_triangle_list;
/// Ascending numbers of triangles. `list`: es_triangle_list.
ES_API es_status es_check_triangles(es_model_check check,
                                    int32_t list,
                                    const uint32_t** triangles,
                                    size_t* count);

/// The air that sources and listeners share, cubic and square metres; 0: unknown, as outdoors.
typedef struct es_air {
    double volume;
    double surface;
} es_air;
/// One per air; without sources and listeners that in which most of the volume lies.
ES_API es_status es_check_airs(es_model_check check, const es_air** airs, size_t* count);
/// The index of the air of each source or listener. `item`: ES_SOURCES or ES_LISTENERS.
ES_API es_status es_check_air_of(es_model_check check,
                                 int32_t item,
                                 const uint32_t** airs,
                                 size_t* count);

typedef enum es_material_origin {
    ES_DATA_NONE = 0,     ///< the default
    ES_DATA_BY_NAME = 1,  ///< guessed: of the library's material of that name
    ES_DATA_LIBRARY = 2,  ///< stated, and equal to the library's
    ES_DATA_STATED = 3
} es_material_origin;

/// The part of a material in the surface of the air.
typedef struct es_material_use {
    int32_t origin;           ///< es_material_origin
    double area;              ///< square metres
    double absorption_share;  ///< of the absorbed energy, mean of 500 Hz and 1 kHz
    const char* doubts;       ///< "absorbs the same, scatters nothing"; "": none
} es_material_use;
/// One per material of the scene.
ES_API es_status es_check_materials(es_model_check check,
                                    const es_material_use** materials,
                                    size_t* count);

/// Facets whose largest extent is below half a wavelength, per octave from 125 Hz to 8 kHz.
typedef struct es_small_facets {
    double frequency;        ///< hertz
    double half_wavelength;  ///< metres
    size_t facets;
    double area;        ///< square metres
    double area_share;  ///< of all facets
} es_small_facets;
ES_API es_status es_check_small_facets(es_model_check check,
                                       const es_small_facets** octaves,
                                       size_t* count);

/// The time of all pairs without late rays.
typedef struct es_order_cost {
    int32_t order;
    int32_t is_measured;  ///< 0: estimated
    double seconds;
} es_order_cost;
/// Empty without a forecast, a source or a listener.
ES_API es_status es_check_costs(es_model_check check, const es_order_cost** costs, size_t* count);

/// Writes the report as a .json file, the same bytes as `earshot check --json`, whole or not at
/// all.
ES_API es_status es_check_write(es_model_check check, const char* file);

// ------------------------------------------------------------------------------------------------
// Mended copies
// ------------------------------------------------------------------------------------------------

/// Options of `earshot check --fix`, with their defaults (in brackets).
typedef struct es_mend_options {
    size_t struct_size;
    double max_hole_area;  ///< square metres; larger holes stay (0.05)
    int32_t freeze;        ///< 1: of a scene that moves a copy at rest, as it is at the time of the
                           ///< check; 0: such a scene is refused (0)
} es_mend_options;

/// Sets all members to their defaults, `struct_size` to `size`.
ES_API es_status es_mend_options_init(es_mend_options* options, size_t size);

/// Mends a copy of the scene that was checked: equal vertices become one, fronts turn to the air,
/// small holes are filled, triangles without area, doubled ones and those proved to be out of reach
/// go. `options` null: the defaults. Reads `check`.
ES_API es_status es_mending_create(es_model_check check,
                                   const es_mend_options* options,
                                   es_mending* mending);

// What follows reads `mending`; views are valid until it is released.

typedef struct es_mending_info {
    size_t struct_size;
    size_t welded_vertices;
    size_t filled_holes;
    size_t added_triangles;  ///< that fill them
    double max_rounding;     ///< metres, of coordinates in a .glb file
} es_mending_info;

/// `info->struct_size` must be set.
ES_API es_status es_mending_get_info(es_mending mending, es_mending_info* info);

typedef enum es_mended_list {
    ES_REMOVED_DEGENERATE = 0,
    ES_REMOVED_DOUBLED = 1,
    ES_REMOVED_UNREACHED = 2,  ///< proved to be out of reach
    ES_KEPT_UNREACHED = 3,     ///< kept: rays did not reach them, but nothing proves it
    ES_TURNED = 4
} es_mended_list;
/// Ascending numbers of triangles of the scene that was checked. `list`: es_mended_list.
ES_API es_status es_mending_triangles(es_mending mending,
                                      int32_t list,
                                      const uint32_t** triangles,
                                      size_t* count);

/// The mended copy as a new scene.
ES_API es_status es_mending_scene(es_mending mending, es_scene* scene);
/// Writes the mended copy as a .glb file, the same bytes as `earshot check --fix`, whole or not at
/// all. Directivities are not written.
ES_API es_status es_mending_write(es_mending mending, const char* file);

#endif
