// SPDX-License-Identifier: MIT
//
// Visible sets.
// Part of earshot.h, which says what holds for all.
#ifndef EARSHOT_VISIBLE_SETS_H
#define EARSHOT_VISIBLE_SETS_H

#include "earshot_base.h"

/// The options of `earshot pvs build`, with its defaults (in brackets); the same options give the
/// same sets.
typedef struct es_visible_sets_options {
    size_t struct_size;
    double time;           ///< instant of the scene's animation, seconds (0)
    const double* region;  ///< (2, 3) lower and upper corner of all viewpoints, metres; null: the
                           ///< box around the scene (null)
    size_t cells;  ///< at most, into which the region is divided where visibility changes, up to
                   ///< 2^20; 0: as `grid` says (0)
    const uint32_t* grid;  ///< (3) boxes along the axes into which it is divided instead, up to
                           ///< 2^20 together; null: it is one cell (null)
    size_t triangles_per_object;  ///< sets consist of groups of so many triangles at most (1)
    uint64_t rays;                ///< at most; 0: 10 or, with cells, 20 million (0)
    int64_t until;  ///< enough when a million rays found fewer triangles or, with cells, when no
                    ///< set grew by more in 5 million; -1: 50 or, with cells, 5 (-1)
    int64_t validation_rays;  ///< fresh rays that measure what the sets miss; -1: a tenth of the
                              ///< rays, at least 65,536 (-1)
    size_t segments;          ///< random segments that divide the region, for `cells` (200000)
    double seconds;           ///< enough after this time, too, whereupon the sets depend on the
                              ///< machine; infinite: no limit (infinite)
    uint64_t seed;            ///< 0 ... 2^63 - 1 (1)
    int32_t skip_solids;      ///< 1: segments within closed solids do not count, for `cells` (0)
    int32_t threads;          ///< 0: one per core; changes no result (0)
    es_progress_callback progress;  ///< null: nobody wants to know (null)
    void* progress_data;            ///< its first argument
} es_visible_sets_options;

/// Sets all members to their defaults, `struct_size` to `size`.
ES_API es_status es_visible_sets_options_init(es_visible_sets_options* options, size_t size);
/// Finds what can be seen from the cells of a region by rays: sets that lack what no ray has found.
/// `options` null: the defaults. Reads `scene`.
ES_API es_status es_visible_sets_build(es_scene scene,
                                       const es_visible_sets_options* options,
                                       es_visible_sets* sets);
/// Reads a file of `earshot pvs build`.
ES_API es_status es_visible_sets_read(const char* file, es_visible_sets* sets);
/// Writes such a file, the same bytes as the program, whole or not at all. Reads `sets`.
ES_API es_status es_visible_sets_write(es_visible_sets sets, const char* file);

typedef struct es_visible_sets_info {
    size_t struct_size;
    size_t cells;
    size_t objects;    ///< groups of triangles that sets consist of
    size_t triangles;  ///< of the mesh
    uint64_t entries;  ///< of all sets together
    double lower[3];   ///< the region of the cells, metres
    double upper[3];
    const char* scene;     ///< the name of the scene that they are of
    double time;           ///< and the instant of its animation, seconds
    uint64_t mesh_digest;  ///< of the mesh at that instant
    uint64_t rays;         ///< that were traced to find them
    uint64_t seed;
    uint64_t validation_rays;   ///< that measured what the sets miss; 0: none
    double missed_share;        ///< of all directions, in which they lack what is closest; NaN
                                ///< without validation rays
    double missed_share_upper;  ///< which it exceeds in 5 % of all cases only; NaN likewise
} es_visible_sets_info;

/// `info->struct_size` must be set; its text is valid until `sets` is released. Reads `sets`.
ES_API es_status es_visible_sets_get_info(es_visible_sets sets, es_visible_sets_info* info);
/// The cell that each of `points`, (count, 3), is in, into `cells` (count); ES_NONE outside of the
/// region. Reads `sets`.
ES_API es_status es_visible_sets_locate(es_visible_sets sets,
                                        const double* points,
                                        size_t count,
                                        uint32_t* cells);
/// The volumes of all cells, (count) cubic metres. Valid until `sets` is released. Reads `sets`.
ES_API es_status es_visible_sets_volumes(es_visible_sets sets,
                                         const double** volumes,
                                         size_t* count);
/// The objects that are visible from a cell, ascending, (count). Valid as long. Reads `sets`.
ES_API es_status es_visible_sets_objects(es_visible_sets sets,
                                         uint32_t cell,
                                         const uint32_t** objects,
                                         size_t* count);
/// The triangles that are visible from a cell, ascending: `count` gets how many there are, and
/// `triangles` the first of them, at most `capacity`; null with capacity 0. Reads `sets`.
ES_API es_status es_visible_sets_triangles(
    es_visible_sets sets, uint32_t cell, uint32_t* triangles, size_t capacity, size_t* count);
/// The object of each triangle, (count). Valid until `sets` is released. Reads `sets`.
ES_API es_status es_visible_sets_object_of_triangle(es_visible_sets sets,
                                                    const uint32_t** objects,
                                                    size_t* count);

#endif
