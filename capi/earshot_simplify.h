// SPDX-License-Identifier: MIT
//
// Simplification: fewer triangles for sound.
// Part of earshot.h, which says what holds for all.
#ifndef EARSHOT_SIMPLIFY_H
#define EARSHOT_SIMPLIFY_H

#include "earshot_base.h"
#include "earshot_simulation.h"

/// Options of `earshot simplify`, with their defaults (in brackets).
typedef struct es_simplify_options {
    size_t struct_size;
    double distance;       ///< metres between the surfaces before and after, at most (0.01)
    double max_frequency;  ///< hertz: in place of `distance` what sound up to it tells apart; 0:
                           ///< not used (0)
    double angle_deg;      ///< of the cone of normals that one triangle replaces, 0 ... 180 (180)
    /// Parts of up to this extent become boxes, metres; 0: none; NaN: half the wavelength of
    /// `max_frequency`, or those whose boxes keep the distance (NaN).
    double object_size;
    es_progress_callback progress;  ///< null: nobody wants to know (null)
    void* progress_data;            ///< its first argument
    int32_t threads;                ///< 0: one per core (0)
    int32_t reserved;               ///< 0
} es_simplify_options;

/// Sets all members to their defaults, `struct_size` to `size`.
ES_API es_status es_simplify_options_init(es_simplify_options* options, size_t size);

/// A scene with fewer triangles, whose meshes, materials, sources and listeners have the same
/// names, as `earshot simplify` makes it. With `simulation` both scenes are simulated and compared
/// in its report; null: not. `options` null: the defaults. Reads `scene`, which stays as it is.
/// Fails for scenes that move, and if this build is without OpenMesh.
ES_API es_status es_scene_simplify(es_scene scene,
                                   const es_simplify_options* options,
                                   const es_simulation_options* simulation,
                                   es_scene* simplified);

/// The JSON text of `earshot simplify --json` about a scene that es_scene_simplify() has made;
/// empty of others. Reads `scene`; valid until that is released.
ES_API es_status es_scene_simplification_json(es_scene scene, const char** text);

/// Writes a scene as a .glb file, whole or not at all, with the acoustic data of its materials.
/// Directivities other than omnidirectional are left out. Fails for scenes that move. Reads
/// `scene`.
ES_API es_status es_scene_write(es_scene scene, const char* file);

#endif
