// SPDX-License-Identifier: MIT
//
// One hierarchy over a mesh: rays, sight, closest points.
// Part of earshot.h, which says what holds for all.
#ifndef EARSHOT_BVH_H
#define EARSHOT_BVH_H

#include "earshot_base.h"

typedef enum es_builder {
    ES_BUILDER_BINNED_SAH = 0,
    ES_BUILDER_SWEEP_SAH = 1,       ///< the reference, slow to build
    ES_BUILDER_SPATIAL_MEDIAN = 2,  ///< slow to query
    ES_BUILDER_QUALITY = 3,         ///< 1.5 times the build time, the fastest queries
    ES_BUILDER_LBVH = 4,            ///< quick to build, slower to query
    ES_BUILDER_HYBRID = 5,          ///< for rooms
    ES_BUILDER_FAST = 6             ///< the fastest to build
} es_builder;

/// A mesh and the hierarchy over it. Arrays are copied. `builder` (es_builder) changes times only.
ES_API es_status es_bvh_create(const double* vertices,
                               size_t vertex_count,
                               const uint32_t* triangles,
                               size_t triangle_count,
                               int32_t builder,
                               int32_t threads,
                               es_bvh* bvh);
/// Of all triangles of a scene at `time` (seconds, of the animation). Reads `scene`.
ES_API es_status es_bvh_create_from_scene(
    es_scene scene, double time, int32_t builder, int32_t threads, es_bvh* bvh);

typedef enum es_update_action {
    ES_UPDATE_REFIT = 0,
    ES_UPDATE_REPAIR = 1,
    ES_UPDATE_REBUILD = 2
} es_update_action;

/// Moves the vertices, (vertex_count, 3), as many as before. The hierarchy is refitted, repaired or
/// rebuilt (`action`, es_update_action, may be null) so that this and `expected_queries` until the
/// next update cost the least; 0: it is refitted. Changes `bvh`.
ES_API es_status es_bvh_update(es_bvh bvh,
                               const double* vertices,
                               size_t vertex_count,
                               double expected_queries,
                               int32_t threads,
                               int32_t* action);
/// Each pointer may be null. Reads `bvh`.
ES_API es_status es_bvh_counts(es_bvh bvh, size_t* vertex_count, size_t* triangle_count);

/// The closest hit of each ray, on either side of a triangle; of hits at one distance that of the
/// lowest triangle. `origins` and `directions` are (count, 3); directions have any length but 0,
/// in multiples of which distances count. `max_t` (count), null: unlimited. Into `t` (count),
/// infinity where nothing is hit; `triangles` (count), ES_NONE there; `uv` (count, 2), weights of
/// the second and third vertex. Each of the three may be null. Reads `bvh`.
ES_API es_status es_bvh_closest_hits(es_bvh bvh,
                                     const double* origins,
                                     const double* directions,
                                     const double* max_t,
                                     size_t count,
                                     int32_t threads,
                                     double* t,
                                     uint32_t* triangles,
                                     double* uv);
/// Whether any triangle shares a point with the closed segment from `from` to `to`, (count, 3)
/// each: 1 or 0 into `occluded` (count). Decided exactly. Reads `bvh`.
ES_API es_status es_bvh_occluded(es_bvh bvh,
                                 const double* from,
                                 const double* to,
                                 size_t count,
                                 int32_t threads,
                                 uint8_t* occluded);
/// The closest point of the mesh to each of `points`, (count, 3), within `max_distance` metres
/// (infinity: any), of triangles at one distance on the lowest. Into `distances` (count), infinity
/// where there is none; `triangles` (count), ES_NONE there; `closest` (count, 3), NaN there. Each
/// of the three may be null. Reads `bvh`.
ES_API es_status es_bvh_closest_points(es_bvh bvh,
                                       const double* points,
                                       size_t count,
                                       double max_distance,
                                       int32_t threads,
                                       double* distances,
                                       uint32_t* triangles,
                                       double* closest);

/// Sight lines from now on ignore these triangles (count): panes of glass, say. Replaces what was
/// excluded before; count 0: nothing is. Changes `bvh`.
ES_API es_status es_bvh_exclude(es_bvh bvh, const uint32_t* triangles, size_t count);
/// Whether the closed segments from `from` to `to`, (count, 3) each, touch no triangle that is not
/// excluded: 1 or 0 into `visible` (count). Decided exactly, the same in both directions. Reads
/// `bvh`.
ES_API es_status es_bvh_visible(es_bvh bvh,
                                const double* from,
                                const double* to,
                                size_t count,
                                int32_t threads,
                                uint8_t* visible);
/// The triangle that blocks each segment first from its beginning, into `triangles` (count),
/// ES_NONE where it is visible, and where, into `t` (count): 0 at `from`, 1 at `to`, infinity where
/// it is visible. `t` may be null. Reads `bvh`.
ES_API es_status es_bvh_first_blockers(es_bvh bvh,
                                       const double* from,
                                       const double* to,
                                       size_t count,
                                       int32_t threads,
                                       uint32_t* triangles,
                                       double* t);
/// es_bvh_visible() of every pair of a point of `from`, (from_count, 3), and one of `to`,
/// (to_count, 3), into `visible`, (from_count, to_count). Reads `bvh`.
ES_API es_status es_bvh_visible_matrix(es_bvh bvh,
                                       const double* from,
                                       size_t from_count,
                                       const double* to,
                                       size_t to_count,
                                       int32_t threads,
                                       uint8_t* visible);
/// How much of a ball of `radius` metres (> 0, at most 1e6) about each point of `to`, (to_count,
/// 3), each point of `from`, (from_count, 3), sees: the share of the ball's solid angle, 0 ... 1,
/// into `shares`, (from_count, to_count), and what it may be off by into `errors`, likewise, which
/// may be null. The error is 0 where nothing is between or one surface hides all of the ball;
/// elsewhere rays, at most `max_rays` (8 ... 1048576) for a share, leave one of 2.7 over the root
/// of their number or less. A point within a ball sees all of it. Takes time like finding the
/// facets of the mesh besides. Reads `bvh`.
ES_API es_status es_bvh_visible_shares(es_bvh bvh,
                                       const double* from,
                                       size_t from_count,
                                       const double* to,
                                       size_t to_count,
                                       double radius,
                                       size_t max_rays,
                                       int32_t threads,
                                       double* shares,
                                       double* errors);

#endif
