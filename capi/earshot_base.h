// SPDX-License-Identifier: MIT
//
// Version, status, errors, handles and messages.
// Part of earshot.h, which says what holds for all.
#ifndef EARSHOT_BASE_H
#define EARSHOT_BASE_H

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
typedef uint64_t es_metric_map;    ///< metrics over an area
typedef uint64_t es_calibration;   ///< absorption fitted to measurements
typedef uint64_t es_location;      ///< positions from arrival times
typedef uint64_t es_model_check;   ///< what a model needs before it is trusted
typedef uint64_t es_mending;       ///< a mended copy of a model, and what was done
typedef uint64_t es_engine;        ///< a scene that is heard while it moves

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
    ES_KIND_MESSAGES = 9,
    ES_KIND_METRIC_MAP = 10,
    ES_KIND_CALIBRATION = 11,
    ES_KIND_LOCATION = 12,
    ES_KIND_MODEL_CHECK = 13,
    ES_KIND_MENDING = 14,
    ES_KIND_ENGINE = 15
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

#endif
