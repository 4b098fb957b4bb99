// SPDX-License-Identifier: MIT
//
// Visible sets.
// Part of earshot.h, which says what holds for all.
#ifndef EARSHOT_VISIBLE_SETS_H
#define EARSHOT_VISIBLE_SETS_H

#include "earshot_base.h"

/// Reads a file of `earshot pvs build`.
ES_API es_status es_visible_sets_read(const char* file, es_visible_sets* sets);

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
