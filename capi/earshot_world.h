// SPDX-License-Identifier: MIT
//
// Worlds: contacts and distances of meshes that move.
// Part of earshot.h, which says what holds for all.
#ifndef EARSHOT_WORLD_H
#define EARSHOT_WORLD_H

#include "earshot_base.h"

/// A world without meshes.
ES_API es_status es_world_create(es_world* world);
/// Adds a mesh at rest, vertices (vertex_count, 3) and triangles (triangle_count, 3); `mesh` gets
/// its number. `name` may be null. Changes `world`.
ES_API es_status es_world_add_mesh(es_world world,
                                   const char* name,
                                   const double* vertices,
                                   size_t vertex_count,
                                   const uint32_t* triangles,
                                   size_t triangle_count,
                                   uint32_t* mesh);
/// Adds all meshes of a scene, which es_world_set_time_step() moves; `first` gets the number of the
/// first, the others follow. `weld` 1: vertices of a mesh that are at one position at all times
/// are one, the one of the lowest index. Changes `world`, reads `scene`.
ES_API es_status es_world_add_scene(es_world world, es_scene scene, int32_t weld, uint32_t* first);
/// Takes a mesh out; others keep their numbers. Changes `world`.
ES_API es_status es_world_remove_mesh(es_world world, uint32_t mesh);
/// The number of meshes, those counted that were taken out. Reads `world`.
ES_API es_status es_world_mesh_count(es_world world, size_t* count);
/// Valid until `world` is changed or released. Reads `world`.
ES_API es_status es_world_mesh_name(es_world world, uint32_t mesh, const char** name);

/// In the next step the mesh's vertices move on straight lines from `begin` to `end`,
/// (vertex_count, 3) each; `end` null: it rests. A mesh that is not told again keeps its step: say
/// where it rests after it has moved. Changes `world`.
ES_API es_status es_world_step_mesh(
    es_world world, uint32_t mesh, const double* begin, const double* end, size_t vertex_count);
/// The same on a screw: from `begin` it turns by `angle` (radians, right-handed) about the axis
/// through `point` along `axis` (of any length but 0), and slides along it by `slide` metres, both
/// evenly. Changes `world`.
ES_API es_status es_world_step_screw(es_world world,
                                     uint32_t mesh,
                                     const double* begin,
                                     size_t vertex_count,
                                     const double point[3],
                                     const double axis[3],
                                     double angle,
                                     double slide);
/// The meshes of the scene move from where they are at `t0` to where they are at `t1`, seconds.
/// `rigid` 1: those that follow a node turn with it, instead of every vertex on a straight line.
/// Changes `world`.
ES_API es_status es_world_set_time_step(es_world world, double t0, double t1, int32_t rigid);

typedef struct es_contact_options {
    size_t struct_size;
    int32_t between_meshes;  ///< 1: contacts of two meshes (1)
    int32_t within_meshes;   ///< 1: contacts of a mesh with itself (0)
    int32_t moving_only;     ///< 1: of pairs of which one moves in the step (0)
    int32_t threads;         ///< 0: one per core; changes no result (1)
    double min_separation;   ///< elements this close along every axis touch, metres (0: exact)
    double tolerance;        ///< metres, with min_separation, > 0 (1e-6)
    const uint32_t* pairs;   ///< (pair_count, 2) meshes that are tested; null: all (null)
    size_t pair_count;
} es_contact_options;

/// Sets all members to their defaults, `struct_size` to `size`.
ES_API es_status es_contact_options_init(es_contact_options* options, size_t size);

typedef enum es_contact_kind {
    ES_CONTACT_VERTEX_FACE = 0,
    ES_CONTACT_EDGE_EDGE = 1,
    ES_CONTACT_TRIANGLE_TRIANGLE = 2
} es_contact_kind;

/// A vertex, an edge or a face of a mesh, by its 1, 2 or 3 vertices, ascending.
typedef struct es_element {
    uint32_t mesh;
    uint32_t vertex_count;
    uint32_t vertices[3];
} es_element;

/// Two elements in contact.
typedef struct es_contact {
    int32_t kind;  ///< es_contact_kind
    uint32_t reserved;
    es_element a;
    es_element b;
    double toi;        ///< within the step, 0 ... 1, never later than the true time of impact
    double point[3];   ///< of contact on a at that time, metres
    double normal[3];  ///< unit, of b's face or of both edges, on the side that a comes from; 0 if
                       ///< there is none
} es_contact;

/// All contacts of the step, sorted by time, kind and elements. None is ever missed. `options`
/// null: the defaults. Changes `world`.
ES_API es_status es_world_contacts(es_world world,
                                   const es_contact_options* options,
                                   es_contacts* contacts);
/// The first of these, in less time; `found` 0: there is none. Changes `world`.
ES_API es_status es_world_first_contact(es_world world,
                                        const es_contact_options* options,
                                        es_contact* contact,
                                        int32_t* found);
/// All pairs of triangles that intersect at the beginning of the step, with time 0;
/// `min_separation` is not used. Changes `world`.
ES_API es_status es_world_intersections(es_world world,
                                        const es_contact_options* options,
                                        es_contacts* contacts);
/// The contacts as an array (count), valid until `contacts` is released. Reads `contacts`.
ES_API es_status es_contacts_get(es_contacts contacts, const es_contact** array, size_t* count);

/// How far apart the surfaces of two meshes are.
typedef struct es_distance {
    double distance;      ///< metres; 0: they intersect; infinite: one has no triangle
    uint32_t triangle_a;  ///< the closest triangles, within their meshes; ES_NONE unless the
    uint32_t triangle_b;  ///< distance is positive and finite
    double on_a[3];       ///< the closest points, metres
    double on_b[3];
} es_distance;

/// Of two meshes at the beginning of the step. Changes `world`.
ES_API es_status
es_world_distance(es_world world, uint32_t a, uint32_t b, int32_t threads, es_distance* distance);

/// How deep two meshes of convex solids are in each other.
typedef struct es_depth {
    int32_t overlap;  ///< 0: none overlap, or a mesh does not consist of convex solids
    int32_t reserved;
    double depth;     ///< metres
    double move[3];   ///< the translation of a, of that length, after which the solids only touch
    uint32_t part_a;  ///< which solid of each mesh
    uint32_t part_b;
} es_depth;

/// Of two meshes, or of the solids of one, at the beginning of the step. Changes `world`.
ES_API es_status es_world_depth(es_world world, uint32_t a, uint32_t b, es_depth* depth);

#endif
