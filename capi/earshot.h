// SPDX-License-Identifier: MIT
//
// earshot.h: the C interface of libearshot.so, for engines and other languages. It is C99 and C++.
// docs/capi.md has a tour and an example; docs/conventions.md says what the numbers mean.
//
// Units and axes: metres, seconds, hertz, right-handed axes with +Y up. Arrays are row-major, an
// array of points is (count, 3) doubles, an array of triangles is (count, 3) vertex indices,
// counter-clockwise seen from the front.
//
// Every function that can fail returns an es_status and checks all that it is given: handles,
// pointers, sizes, indices, numbers that are not finite. It then changes nothing, and what it
// writes to is left as it was; es_error_problem() and its neighbours tell this thread what was
// wrong. A pointer that is not null must point to as many elements as the sizes beside it say: that
// alone cannot be checked. Texts are UTF-8 and end with a zero.
//
// Objects are told by handles. A handle is 64 bits that hold the object's kind, its place in a
// table and how often the place was used before, so that a handle of another kind, of an object
// that was released, or of no object at all is an error and not a crash. es_release() ends any of
// them. Pointers that functions hand out (views) belong to the object and stay valid until it is
// released or, where the function's description says so, changed.
//
// Threads: every function may be called from any thread, also while others run. What a function
// does to each handle is said in its description: several calls that read an object may run at the
// same time; a call that changes one needs it alone and fails with ES_ERROR_BUSY, changing nothing,
// while another call uses it. Results depend neither on `threads` nor on the processor.
//
// Growth: structs that may get more members begin with their size, `struct_size`; set it to
// sizeof(the struct), or let the struct's _init function set all members. Members that a newer
// header adds are at their defaults where a program was compiled with an older one.
#ifndef EARSHOT_H
#define EARSHOT_H

#include <stddef.h>
#include <stdint.h>

#define ES_VERSION_MAJOR 0
#define ES_VERSION_MINOR 1
#define ES_VERSION_PATCH 0
/// As es_version() gives it.
#define ES_VERSION ((ES_VERSION_MAJOR << 16) | (ES_VERSION_MINOR << 8) | ES_VERSION_PATCH)

/// An index of nothing: no triangle was hit, a point is in no cell.
#define ES_NONE 0xFFFFFFFFu
/// An index that stands for all sources or listeners of a scene.
#define ES_ALL 0xFFFFFFFFu

#ifdef __cplusplus
#define ES_API extern "C" __attribute__((visibility("default")))
#else
#define ES_API extern __attribute__((visibility("default")))
#endif

// ------------------------------------------------------------------------------------------------
// Version, status, errors
// ------------------------------------------------------------------------------------------------

/// What became of a call.
typedef enum es_status {
    ES_OK = 0,
    ES_ERROR_HANDLE = 1,         ///< no handle, one of another kind, or of an object released
    ES_ERROR_NULL = 2,           ///< a pointer is null that may not be
    ES_ERROR_ARGUMENT = 3,       ///< a number or size is out of range or not finite
    ES_ERROR_INDEX = 4,          ///< an index is beyond what there is
    ES_ERROR_FAILED = 5,         ///< a file, scene or option that the user can mend
    ES_ERROR_CANCELLED = 6,      ///< a progress callback asked to stop
    ES_ERROR_BUSY = 7,           ///< another call is using an object that this one would change
    ES_ERROR_OUT_OF_MEMORY = 8,  ///< or more than 2^24 objects
    ES_ERROR_INTERNAL = 9        ///< a fault of the library; please report it
} es_status;

/// The library's version, as ES_VERSION is the header's: major << 16 | minor << 8 | patch. Before
/// version 1 a program runs with libraries of its own major and minor version.
ES_API uint32_t es_version(void);
/// "0.1.0". Valid for ever.
ES_API const char* es_version_text(void);
/// The name of a status, "ES_ERROR_NULL"; "unknown" for other numbers. Valid for ever.
ES_API const char* es_status_name(int32_t status);

/// What was wrong in the last call of this thread that failed: whose fault (a file, an argument, a
/// function), what the matter is, and what would mend it. Empty, never null, where there is nothing
/// to tell. Valid until the next call of this thread that fails.
ES_API const char* es_error_subject(void);
ES_API const char* es_error_problem(void);
ES_API const char* es_error_remedy(void);
/// The three in one line: "SUBJECT: PROBLEM; REMEDY". Valid as long.
ES_API const char* es_error_message(void);
/// The status of that call; ES_OK if none has failed.
ES_API es_status es_error_status(void);

// ------------------------------------------------------------------------------------------------
// Handles
// ------------------------------------------------------------------------------------------------

/// Handles; 0 is never one.
typedef uint64_t es_scene;         ///< geometry, materials, sources and listeners
typedef uint64_t es_simulator;     ///< a scene prepared for many simulations
typedef uint64_t es_result;        ///< responses, paths and metrics
typedef uint64_t es_bvh;           ///< a mesh and the hierarchy over it, for rays and sight lines
typedef uint64_t es_world;         ///< meshes that move, for contacts and distances
typedef uint64_t es_contacts;      ///< what a world's search found
typedef uint64_t es_visible_sets;  ///< potentially visible sets of view cells
typedef uint64_t es_sound;         ///< samples of a sound
typedef uint64_t es_messages;      ///< warnings and notes

typedef enum es_kind {
    ES_KIND_NONE = 0,
    ES_KIND_SCENE = 1,
    ES_KIND_SIMULATOR = 2,
    ES_KIND_RESULT = 3,
    ES_KIND_BVH = 4,
    ES_KIND_WORLD = 5,
    ES_KIND_CONTACTS = 6,
    ES_KIND_VISIBLE_SETS = 7,
    ES_KIND_SOUND = 8,
    ES_KIND_MESSAGES = 9
} es_kind;

/// Ends an object of any kind; its views end with it. 0 is allowed and does nothing. A call of
/// another thread that is using the object ends first, on its own; this one does not wait.
ES_API es_status es_release(uint64_t handle);
/// The es_kind of a handle, ES_KIND_NONE if it is of no object.
ES_API int32_t es_kind_of(uint64_t handle);
/// How many objects there are that were not released.
ES_API size_t es_object_count(void);

/// Told about long work: its stage ("tracing", "late rays", "responses"), and how many of how many
/// steps are done. Called from one thread at a time, which need not be the one that called the
/// function, at least once per stage. Returns 0 to go on; anything else stops the work, which
/// fails with ES_ERROR_CANCELLED. May call any function, with ES_ERROR_BUSY for objects that the
/// work changes. `stage` is valid during the call.
typedef int32_t (*es_progress_callback)(void* user_data,
                                        const char* stage,
                                        uint64_t done,
                                        uint64_t total);

/// The number of messages. Reads `messages`.
ES_API es_status es_messages_count(es_messages messages, size_t* count);
/// A message: whom it is about, and what it says. Valid until `messages` is released. Reads
/// `messages`.
ES_API es_status es_messages_get(es_messages messages,
                                 size_t index,
                                 const char** subject,
                                 const char** text);

// ------------------------------------------------------------------------------------------------
// Scenes
// ------------------------------------------------------------------------------------------------

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
/// listeners outside or in solids, materials without data. Reads `scene`.
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

// ------------------------------------------------------------------------------------------------
// Simulation
// ------------------------------------------------------------------------------------------------

typedef enum es_mode {
    ES_MODE_COMPLETE = 0,  ///< finds every path
    ES_MODE_SAMPLED = 1    ///< faster, may miss paths at edges
} es_mode;

typedef enum es_format {
    ES_FORMAT_MONO = 0,
    ES_FORMAT_BINAURAL = 1,  ///< left, right
    ES_FORMAT_AMBISONIC = 2  ///< (order + 1)^2 channels, ACN, SN3D
} es_format;

/// The options of `earshot ir`, with its defaults (in brackets); the same options give the same
/// numbers.
typedef struct es_simulation_options {
    size_t struct_size;
    double time;              ///< instant of the scene's animation, seconds (0); of es_simulate()
    int32_t order;            ///< max reflections and transmissions of an exact path, 0 ... 64 (4)
    int32_t mode;             ///< es_mode (complete)
    int32_t resolution;       ///< sub-frusta along a cube face, 0 ... 1024; 0: the default (0)
    int32_t transmission;     ///< 1: sound also goes through materials that transmit (0)
    double max_length;        ///< of a path, metres; 0: no limit (0)
    double min_level_db;      ///< of a path, re the source at 1 m; -inf: no limit (-inf)
    uint64_t rays;            ///< of late sound, at most, up to 1e9; 0: none (1000000)
    double rays_error;        ///< standard error of T30 at which rays suffice, a share of it,
                              ///< 0.001 ... 1; 0: all rays are traced (0.02)
    uint64_t seed;            ///< of rays and noise, 0 ... 2^63 - 1 (1)
    double temperature_c;     ///< of the air, degrees Celsius (20)
    double humidity_percent;  ///< relative (50)
    double pressure_kpa;      ///< (101.325)
    int32_t air_absorption;   ///< 1: the air absorbs (1)
    int32_t bands;            ///< es_bands (octave)
    int32_t format;           ///< es_format (mono)
    int32_t ambisonic_order;  ///< 0 ... 5 (1)
    const char* hrtf_file;    ///< SOFA file of a binaural format; null: a KEMAR manikin (null)
    double sample_rate;       ///< hertz, 1000 ... 768000 (48000)
    double length;            ///< of a response, seconds, 0 ... 3600; 0: until it has decayed (0)
    int32_t hrtf_raw;         ///< 1: the HRIR set as measured: not equalised, delays kept (0)
    int32_t responses;        ///< 1: impulse responses (1)
    int32_t metrics;          ///< 1: metrics, for which responses are made, too (1)
    int32_t histograms;       ///< 1: keep the energy histograms of late sound (0)
    int32_t keep_traces;      ///< 1: an es_simulator keeps beam trees from run to run: for points
                              ///< that move in geometry that does not. Changes no result (0)
    int32_t speech;          ///< 1: STI of speech of the level below in the noise below; 0: of loud
                             ///< speech in a quiet room (0)
    double speech_level_db;  ///< A-weighted, 1 m in front of the talker, -200 ... 200 (60)
    const double* noise_db;  ///< (7) octave levels at the listener, 125 Hz ... 8 kHz; null: none
    es_visible_sets visible_sets;   ///< paths are left out whose first reflection is not in the set
                                    ///< of their source's cell; 0: none are (0)
    es_progress_callback progress;  ///< null: nobody wants to know (null)
    void* progress_data;            ///< its first argument
    int32_t threads;                ///< 0: one per core; changes no result (0)
    int32_t reserved;               ///< 0
} es_simulation_options;

/// Sets all members to their defaults, `struct_size` to `size`.
ES_API es_status es_simulation_options_init(es_simulation_options* options, size_t size);

/// Octave levels of the noise criterion curve NC-`number` (15 ... 70), 125 Hz ... 8 kHz, decibels.
ES_API es_status es_noise_criterion(double number, double levels_db[7]);

/// Simulates all pairs of a source and a listener at one instant. `options` null: the defaults.
/// Reads `scene`.
ES_API es_status es_simulate(es_scene scene,
                             const es_simulation_options* options,
                             es_result* result);

/// Prepares a copy of a scene for es_simulator_run(). Reads `scene`, which may be changed or
/// released afterwards.
ES_API es_status es_simulator_create(es_scene scene,
                                     const es_simulation_options* options,
                                     es_simulator* simulator);
/// The result at `time` (seconds, of the animation): that of es_simulate(), in less time. Changes
/// `simulator`.
ES_API es_status es_simulator_run(es_simulator simulator, double time, es_result* result);
/// As es_scene_set_position() and es_scene_set_look_at(), for the next run. Change `simulator`.
ES_API es_status es_simulator_set_position(es_simulator simulator,
                                           int32_t item,
                                           uint32_t index,
                                           const double position[3]);
ES_API es_status es_simulator_set_look_at(es_simulator simulator,
                                          int32_t item,
                                          uint32_t index,
                                          const double* point);

// --- Results. They never change: every function below reads `result`, and views are valid until
// it is released. `source` and `listener` are indices of the scene.

typedef struct es_result_info {
    size_t struct_size;
    size_t sources;
    size_t listeners;
    size_t channels;        ///< of a response
    size_t samples;         ///< of the longest response; 0 without responses
    size_t bands;           ///< frequency bands
    size_t paths;           ///< of all pairs
    double sample_rate;     ///< hertz
    double time;            ///< seconds, of the animation
    double speed_of_sound;  ///< metres per second
    size_t triangles;       ///< that take part, after clean-up
    size_t facets;          ///< into which they were joined
    uint64_t frusta;        ///< that were traced
} es_result_info;

/// `info->struct_size` must be set.
ES_API es_status es_result_get_info(es_result result, es_result_info* info);
/// The nominal centres of its bands, hertz.
ES_API es_status es_result_bands(es_result result, const double** nominal_hz, size_t* count);

/// All impulse responses in one block, (sources, listeners, channels, samples): pressure re the
/// source's free field at 1 m, sample 0 is the instant of emission. Shorter ones end in zeros. The
/// numbers are those of the WAV files of `earshot ir`.
ES_API es_status es_result_responses(es_result result, const float** samples, size_t shape[4]);
/// How long each response is, (sources, listeners) samples.
ES_API es_status es_result_lengths(es_result result, const uint64_t** lengths, size_t shape[2]);
/// One response as a sound of its own length.
ES_API es_status es_result_sound(es_result result, size_t source, size_t listener, es_sound* sound);

typedef enum es_path_kind {
    ES_PATH_DIRECT = 0,
    ES_PATH_SPECULAR = 1,
    ES_PATH_TRANSMITTED = 2
} es_path_kind;

/// One way of sound from a source to a listener.
typedef struct es_path {
    uint32_t source;
    uint32_t listener;
    int32_t kind;                ///< es_path_kind
    uint32_t order;              ///< reflections and transmissions; it has order + 2 points
    double length;               ///< metres
    double delay;                ///< seconds since emission
    double departure[3];         ///< unit direction of travel at the source
    double arrival[3];           ///< unit direction of travel at the listener
    uint64_t first_point;        ///< row of es_path_arrays::points where the path begins
    uint64_t first_interaction;  ///< index into es_path_arrays::triangles and materials
} es_path;

typedef struct es_path_arrays {
    size_t struct_size;
    const es_path* paths;  ///< (path_count), by source, listener, delay, order, triangles
    size_t path_count;
    const uint64_t* first_path;  ///< (sources * listeners + 1): where the paths of each pair begin
    const double* points;        ///< (point_count, 3): source, interactions, listener
    size_t point_count;
    const uint32_t* triangles;  ///< (interaction_count), of the scene
    const uint32_t* materials;  ///< (interaction_count), of the scene
    size_t interaction_count;
    /// (path_count, band_count): linear amplitude, spreading, air and directivity included;
    /// negative where the source radiates with the other sign.
    const double* pressure;
    size_t band_count;
} es_path_arrays;

/// All paths as flat arrays. `arrays->struct_size` must be set.
ES_API es_status es_result_paths(es_result result, es_path_arrays* arrays);

typedef enum es_metric {
    ES_METRIC_EDT = 0,          ///< early decay time, seconds
    ES_METRIC_T20 = 1,          ///< reverberation time from -5 to -25 dB, seconds
    ES_METRIC_T30 = 2,          ///< reverberation time from -5 to -35 dB, seconds
    ES_METRIC_C50 = 3,          ///< clarity, decibels
    ES_METRIC_C80 = 4,          ///< clarity, decibels
    ES_METRIC_D50 = 5,          ///< definition, 0 ... 1
    ES_METRIC_TS = 6,           ///< centre time, seconds
    ES_METRIC_G = 7,            ///< strength, decibels
    ES_METRIC_STI = 8,          ///< speech transmission index, 0 ... 1; one per pair
    ES_METRIC_SCHROEDER = 9,    ///< Schroeder frequency, hertz; one per pair
    ES_METRIC_LF = 10,          ///< early lateral energy fraction, of an ambisonic response
    ES_METRIC_IACC_EARLY = 11,  ///< interaural cross-correlation, of a binaural response
    ES_METRIC_IACC_LATE = 12,
    ES_METRIC_IACC = 13
} es_metric;

/// What a metric is of.
typedef enum es_metric_set {
    ES_EXPECTED = 0,  ///< of the energies that arrive: their mean over realisations
    ES_RESPONSE = 1   ///< of the response, one realisation
} es_metric_set;

typedef enum es_metric_form {
    ES_PER_BAND = 0,
    ES_SINGLE_NUMBER = 1  ///< mean over 500 Hz and 1 kHz (ISO 3382-1), or the one value of a pair
} es_metric_form;

/// A metric of all pairs, (sources, listeners, bands), bands 1 for single numbers; NaN where it has
/// no value, for which es_result_metric_note() gives the reason. `standard_errors`, of the same
/// shape, may be null: they are NaN where there are none, and may be numbers where the value is
/// withheld for being uncertain. ES_METRIC_STI and ES_METRIC_SCHROEDER have single numbers only;
/// LF and IACC have values per band, of the response, only; SCHROEDER is of ES_EXPECTED.
ES_API es_status es_result_metric(es_result result,
                                  int32_t metric,
                                  int32_t set,
                                  int32_t form,
                                  const double** values,
                                  const double** standard_errors,
                                  size_t shape[3]);
/// Why a metric of a pair has no value in a band, or what else is to be known of it; "" if nothing
/// is. `band`: its index; ES_NONE for a single number.
ES_API es_status es_result_metric_note(es_result result,
                                       int32_t metric,
                                       int32_t set,
                                       size_t source,
                                       size_t listener,
                                       uint32_t band,
                                       const char** text);
/// The key of a metric in metrics.json ("t30"), its unit ("s", "dB", "Hz" or ""), and its
/// just-noticeable difference, a share of the value if `relative` is 1 (NaN: not known). Each
/// pointer may be null. Valid for ever.
ES_API es_status es_metric_get(int32_t metric,
                               const char** key,
                               const char** unit,
                               double* just_noticeable_difference,
                               int32_t* relative);

/// The air that sound of the sources reaches, and the reverberation times of diffuse sound in it.
typedef struct es_room {
    size_t struct_size;
    int32_t is_enclosed;  ///< 0: outdoors, or no metrics were made; all else is then 0 and null
    int32_t reserved;
    double volume;             ///< cubic metres
    double surface;            ///< square metres that sound reaches, no openings
    double opening;            ///< square metres through which sound leaves
    const double* absorption;  ///< (band_count), mean over surface and opening
    const double* sabine;      ///< (band_count), seconds; infinite where nothing absorbs
    const double* eyring;      ///< likewise
    size_t band_count;
} es_room;

/// `room->struct_size` must be set.
ES_API es_status es_result_room(es_result result, es_room* room);

/// Late sound of a pair: energy over time, in units of a free field's at 1 m.
typedef struct es_histogram {
    size_t struct_size;
    double bin;            ///< seconds; entry k is of the interval that begins at k * bin
    const double* energy;  ///< (bin_count, band_count); null if histograms were not kept
    const double* error;   ///< likewise: standard errors
    size_t bin_count;
    size_t band_count;
    uint64_t rays;          ///< behind it
    double t30_error;       ///< relative standard error of T30
    double level_error_db;  ///< standard error of the level of all late sound
    int32_t error_reached;  ///< 0: es_simulation_options::rays_error was not reached
    int32_t is_full_decay;  ///< 1: it extends until the energy has decayed by about 60 dB
} es_histogram;

/// `histogram->struct_size` must be set.
ES_API es_status es_result_histogram(es_result result,
                                     size_t source,
                                     size_t listener,
                                     es_histogram* histogram);

/// What is to be told of the result: pairs without a path, errors not reached, decays that are
/// longer than the room explains.
ES_API es_status es_result_notes(es_result result, es_messages* messages);

/// Files of `earshot ir`.
typedef enum es_document {
    ES_PATHS_JSON = 0,
    ES_METRICS_JSON = 1,
    ES_HISTOGRAMS_JSON = 2
} es_document;

/// Writes such a file, the same bytes as the program, whole or not at all. Fails with
/// ES_ERROR_FAILED if the result does not hold what it needs.
ES_API es_status es_result_write(es_result result, int32_t document, const char* file);

// ------------------------------------------------------------------------------------------------
// Sounds
// ------------------------------------------------------------------------------------------------

/// A sound from samples, (frame_count, channel_count), full scale is 1.
ES_API es_status es_sound_create(const double* samples,
                                 size_t frame_count,
                                 size_t channel_count,
                                 double sample_rate,
                                 es_sound* sound);
/// Reads WAV, FLAC, OGG or AIFF.
ES_API es_status es_sound_read(const char* file, es_sound* sound);
/// Writes 32-bit float .wav, 24-bit .flac or Vorbis .ogg, whole or not at all. `clipped`, which may
/// be null: how many samples were beyond full scale and lost. Reads `sound`.
ES_API es_status es_sound_write(es_sound sound, const char* file, size_t* clipped);
/// Its samples, (frame_count, channel_count), as a view. Reads `sound`.
ES_API es_status es_sound_samples(es_sound sound,
                                  const double** samples,
                                  size_t* frame_count,
                                  size_t* channel_count,
                                  double* sample_rate);
/// Convolves a dry recording with the responses of one receiver, in order of time: they are applied
/// to equal parts of the recording in turn and cross-faded, as `earshot auralize` does. The
/// recording is resampled to the rate of the responses. Reads `dry` and `responses`.
ES_API es_status es_auralize(
    es_sound dry, const es_sound* responses, size_t response_count, int32_t threads, es_sound* wet);
/// Several sounds of as many channels added, each times the factor of its `gain_db` (null: 0 dB),
/// at `sample_rate` (0: that of the first). Reads `sounds`.
ES_API es_status es_sound_mix(const es_sound* sounds,
                              const double* gains_db,
                              size_t count,
                              double sample_rate,
                              es_sound* mix);

// ------------------------------------------------------------------------------------------------
// One hierarchy: rays, sight, closest points
// ------------------------------------------------------------------------------------------------

typedef enum es_builder {
    ES_BUILDER_BINNED_SAH = 0,
    ES_BUILDER_SWEEP_SAH = 1,       ///< the reference, slow to build
    ES_BUILDER_SPATIAL_MEDIAN = 2,  ///< slow to query
    ES_BUILDER_QUALITY = 3,         ///< 1.5 times the build time, the fastest queries
    ES_BUILDER_LBVH = 4,            ///< the fastest to build
    ES_BUILDER_HYBRID = 5,
    ES_BUILDER_FAST = 6
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

// ------------------------------------------------------------------------------------------------
// Worlds: contacts and distances of meshes that move
// ------------------------------------------------------------------------------------------------

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

// ------------------------------------------------------------------------------------------------
// Visible sets
// ------------------------------------------------------------------------------------------------

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
