// SPDX-License-Identifier: MIT
//
// Scenes: geometry, materials, sources and listeners.
// Part of earshot.h, which says what holds for all.
#ifndef EARSHOT_SCENE_H
#define EARSHOT_SCENE_H

#include "earshot_base.h"

typedef enum es_up_axis { ES_UP_Y = 0, ES_UP_Z = 1 } es_up_axis;

/// How a scene file is read; as the options of the same names of `earshot ir`.
typedef struct es_load_options {
    size_t struct_size;
    const char* units;      ///< of a mesh file: "m", "cm", "mm", "in" or "ft"; null: m
    const char* animation;  ///< of a glTF file, name or number; null: the first
    int32_t up;             ///< es_up_axis, of a mesh file
    int32_t allow_outside;  ///< 1: a glTF file may name files outside of its folder
    /// 1: what SCENE.materials.json says beside the file is assigned, as the program does.
    int32_t read_materials;
    int32_t reserved;  ///< 0
} es_load_options;

/// Sets all members, `struct_size` to `size`, which is sizeof(es_load_options).
ES_API es_status es_load_options_init(es_load_options* options, size_t size);

/// Reads a .gltf, .glb, .obj, .ply, .stl or .off file with its materials, sources and listeners.
/// `options` null: the defaults.
ES_API es_status es_scene_load(const char* file, const es_load_options* options, es_scene* scene);

/// Geometry that a program made. Arrays are copied.
typedef struct es_scene_arrays {
    size_t struct_size;
    const char* name;        ///< null: "scene"
    const double* vertices;  ///< (vertex_count, 3), metres, +Y up
    size_t vertex_count;
    const uint32_t* triangles;  ///< (triangle_count, 3)
    size_t triangle_count;
    const uint32_t* material_of_triangle;  ///< (triangle_count); null: all 0
    const char* const* material_names;     ///< (material_count); null: "material 0", ...
    size_t material_count;                 ///< 0: one material
    /// Which mesh a triangle is of; no vertex may be of two. Null: all are one mesh.
    const uint32_t* mesh_of_triangle;  ///< (triangle_count)
    const char* const* mesh_names;     ///< (mesh_count); null: "mesh 0", ...
    size_t mesh_count;                 ///< 0: one mesh
} es_scene_arrays;

/// Sets all members to nothing, `struct_size` to `size`.
ES_API es_status es_scene_arrays_init(es_scene_arrays* arrays, size_t size);

/// A scene from arrays. A material whose name is one of the library has its data; others absorb 0.1
/// and scatter 0.1 until they are assigned. Without triangles it can hold points but is no scene to
/// simulate.
ES_API es_status es_scene_create(const es_scene_arrays* arrays, es_scene* scene);

/// A room that is a box from the origin to `size` (x, y, z, metres), +Y up. Its materials are
/// "floor", "ceiling", "north" (z = 0), "east" (x = size x), "south" and "west", in this order.
ES_API es_status es_scene_create_shoebox(const double size[3], es_scene* scene);

/// A room of vertical walls on a floor plan: `corners` are (corner_count, 2) x and z of its outline
/// in either sense of rotation, a polygon that does not touch or cross itself; the floor is at
/// y = 0. Its materials are "floor", "ceiling", "wall 0" (from corner 0 to corner 1), "wall 1", ...
ES_API es_status es_scene_create_extruded(const double* corners,
                                          size_t corner_count,
                                          double height,
                                          es_scene* scene);

/// An object of its own with the same contents. Reads `scene`.
ES_API es_status es_scene_copy(es_scene scene, es_scene* copy);

/// What a scene consists of.
typedef enum es_item {
    ES_SOURCES = 0,
    ES_LISTENERS = 1,
    ES_MATERIALS = 2,
    ES_MESHES = 3,
    ES_TRIANGLES = 4,
    ES_VERTICES = 5
} es_item;

/// How many there are. `item`: es_item. Reads `scene`.
ES_API es_status es_scene_count(es_scene scene, int32_t item, size_t* count);
/// The name of a source, listener, material or mesh; "" for the scene's meshes without a name.
/// Valid until `scene` is changed or released. Reads `scene`.
ES_API es_status es_scene_item_name(es_scene scene, int32_t item, size_t index, const char** name);
/// The first source, listener, material or mesh of that name. Fails with ES_ERROR_FAILED, and the
/// nearest names, if there is none. Reads `scene`.
ES_API es_status es_scene_find(es_scene scene, int32_t item, const char* name, uint32_t* index);
/// The name of the scene: that of its file without the folder. Valid as above. Reads `scene`.
ES_API es_status es_scene_name(es_scene scene, const char** name);

/// Seconds, of the animation; 0: nothing moves. Reads `scene`.
ES_API es_status es_scene_duration(es_scene scene, double* duration);
/// The corners of the box around all triangles at `time` (seconds, of the animation), metres. Fails
/// with ES_ERROR_FAILED if there is no triangle. Reads `scene`.
ES_API es_status es_scene_extent(es_scene scene, double time, double lower[3], double upper[3]);
/// Where all vertices are at `time`, into `positions`, (vertex_count, 3); `vertex_count` must be
/// the scene's. Reads `scene`.
ES_API es_status es_scene_positions(es_scene scene,
                                    double time,
                                    double* positions,
                                    size_t vertex_count);
/// Per triangle its vertices, (count, 3), its material and its mesh. Each pointer may be null: that
/// is not wanted. Valid until `scene` is changed or released. Reads `scene`.
ES_API es_status es_scene_triangles(es_scene scene,
                                    const uint32_t** triangles,
                                    const uint32_t** materials,
                                    const uint32_t** meshes,
                                    size_t* count);
/// Moves all vertices, (vertex_count, 3), of a scene without animation. Changes `scene`.
ES_API es_status es_scene_set_positions(es_scene scene,
                                        const double* positions,
                                        size_t vertex_count);

/// What its reader found odd, in the geometry as well as in acoustic data. Reads `scene`.
ES_API es_status es_scene_warnings(es_scene scene, es_messages* messages);
/// These, and what else makes results doubtful at `time`: a size that is not a room's, sources or
/// listeners outside or in solids, materials without data, places that two materials claim. Takes
/// time like the beginning of a simulation. Reads `scene`.
ES_API es_status es_scene_check(es_scene scene, double time, es_messages* messages);

// --- Materials

/// How a surface treats sound: energy coefficients, 0 ... 1. Of what arrives `absorption` is not
/// reflected, `transmission` of all goes through, as a part of `absorption`, and `scattering` of
/// what is reflected leaves the specular direction.
typedef struct es_material {
    size_t struct_size;
    size_t frequency_count;  ///< 0: one value each, of all frequencies
    const double*
        frequencies;  ///< (frequency_count), hertz; interpolated between, held at the ends
    /// (frequency_count), or one value. Null: 0.1.
    const double* absorption;
    const double* scattering;    ///< likewise; null: 0.1
    const double* transmission;  ///< likewise; null: 0
    int32_t one_sided;           ///< 1: reflects on the front side only
    int32_t reserved;            ///< 0
} es_material;

/// Sets all members to nothing, `struct_size` to `size`.
ES_API es_status es_material_init(es_material* material, size_t size);

/// Gives acoustic data to all materials whose name matches a shell pattern (* any text, ? any
/// character, [abc] one of a set). The names stay. `matches`, which may be null: how many did.
/// Changes `scene`.
ES_API es_status es_scene_assign(es_scene scene,
                                 const char* pattern,
                                 const es_material* material,
                                 size_t* matches);
/// The same with a material of the library. Changes `scene`.
ES_API es_status es_scene_assign_library(es_scene scene,
                                         const char* pattern,
                                         const char* library_name,
                                         size_t* matches);
/// All that a file as SCENE.materials.json says (docs/files.md). Changes `scene`.
ES_API es_status es_scene_assign_file(es_scene scene, const char* file);
/// The data of one material, by its index. Changes `scene`.
ES_API es_status es_scene_set_material(es_scene scene, size_t index, const es_material* material);

/// What of a material es_scene_coefficients() tells.
typedef enum es_coefficient {
    ES_ABSORPTION = 0,
    ES_SCATTERING = 1,
    ES_TRANSMISSION = 2
} es_coefficient;

typedef enum es_bands { ES_BANDS_OCTAVE = 0, ES_BANDS_THIRD = 1 } es_bands;

/// The nominal centres of the frequency bands: 10 octaves from 31.5 Hz or 31 thirds from 20 Hz.
/// Valid for ever.
ES_API es_status es_bands_nominal(int32_t bands, const double** nominal_hz, size_t* count);
/// A coefficient (es_coefficient) of a material per band (es_bands), into `values` (band_count),
/// which must be as many as there are bands. Reads `scene`.
ES_API es_status es_scene_coefficients(es_scene scene,
                                       size_t material,
                                       int32_t coefficient,
                                       int32_t bands,
                                       double* values,
                                       size_t band_count);

/// The number of the library's materials, which are ordered by name.
ES_API size_t es_library_count(void);
/// One of them: its name, what it is, and where its data is from; each pointer may be null. Valid
/// for ever.
ES_API es_status es_library_get(size_t index,
                                const char** name,
                                const char** description,
                                const char** source);
/// A coefficient of it, as es_scene_coefficients().
ES_API es_status es_library_coefficients(
    size_t index, int32_t coefficient, int32_t bands, double* values, size_t band_count);

// --- Sources and listeners

/// Adds `count` sources or listeners (`item`) at `positions`, (count, 3). `names` (count): null, or
/// a null or empty name among them, for "source1", "listener1", ... (by the number of the point in
/// the scene); a name that another has is an error. `first`, which may be null, gets the index of
/// the first. Changes `scene`.
ES_API es_status es_scene_add(es_scene scene,
                              int32_t item,
                              const double* positions,
                              const char* const* names,
                              size_t count,
                              uint32_t* first);
/// Takes a source or listener (ES_ALL: all) out; those behind it move up. Changes `scene`.
ES_API es_status es_scene_remove(es_scene scene, int32_t item, uint32_t index);
/// Moves a source or listener; one that rode on a node of the scene does not any more. Changes
/// `scene`.
ES_API es_status es_scene_set_position(es_scene scene,
                                       int32_t item,
                                       uint32_t index,
                                       const double position[3]);
/// The point that a source or listener (ES_ALL: every one) faces; null: along its node's -Z.
/// Changes `scene`.
ES_API es_status es_scene_set_look_at(es_scene scene,
                                      int32_t item,
                                      uint32_t index,
                                      const double* point);
/// How a source (ES_ALL: every one) radiates: "omni", "subcardioid", "cardioid", "supercardioid",
/// "hypercardioid", "figure-of-eight" or a .csv file of levels (docs/files.md). Changes `scene`.
ES_API es_status es_scene_set_directivity(es_scene scene, uint32_t source, const char* name);
/// The same by measured levels: `levels_db` is (frequency_count, elevation_count, azimuth_count),
/// decibels re in front; frequencies (hertz), azimuths (degrees from the front to the left,
/// 0 <= a < 360) and elevations (degrees above, -90 ... 90) ascend. Changes `scene`.
ES_API es_status es_scene_set_directivity_table(es_scene scene,
                                                uint32_t source,
                                                const double* frequencies,
                                                size_t frequency_count,
                                                const double* azimuths,
                                                size_t azimuth_count,
                                                const double* elevations,
                                                size_t elevation_count,
                                                const double* levels_db);

/// Where a point is and looks: unit vectors at right angles.
typedef struct es_pose {
    double position[3];
    double front[3];
    double left[3];
    double up[3];
} es_pose;

/// The pose of a source or listener at `time` (seconds, of the animation). Reads `scene`.
ES_API es_status
es_scene_pose(es_scene scene, int32_t item, size_t index, double time, es_pose* pose);

#endif
