// SPDX-License-Identifier: MIT
// Compiled as strict C99: the header needs nothing else.
#include "earshot.h"

// Layouts that foreign programs have written down: arrays of these are handed out, and members that
// a struct has keep their places.
#define HOLDS(condition, name) typedef char name[(condition) ? 1 : -1]
HOLDS(sizeof(es_path) == 96, path_size);
HOLDS(sizeof(es_contact) == 104, contact_size);
HOLDS(sizeof(es_element) == 20, element_size);
HOLDS(sizeof(es_pose) == 96, pose_size);
HOLDS(sizeof(es_distance) == 64, distance_size);
HOLDS(sizeof(es_depth) == 48, depth_size);
HOLDS(sizeof(es_load_options) == 40, load_options_size);
HOLDS(sizeof(es_scene_arrays) == 96, scene_arrays_size);
HOLDS(sizeof(es_material) == 56, material_size);
HOLDS(sizeof(es_simulation_options) == 232, simulation_options_size);
HOLDS(offsetof(es_simulation_options, threads) == 200, simulation_options_threads);
HOLDS(sizeof(es_contact_options) == 56, contact_options_size);
HOLDS(sizeof(es_result_info) == 104, result_info_size);
HOLDS(sizeof(es_path_arrays) == 112, path_arrays_size);
HOLDS(sizeof(es_room) == 72, room_size);
HOLDS(sizeof(es_histogram) == 80, histogram_size);
HOLDS(sizeof(es_sensitivity) == 80, sensitivity_size);
HOLDS(sizeof(es_motion_options) == 64, motion_options_size);
HOLDS(sizeof(es_visible_sets_info) == 152, visible_sets_info_size);
HOLDS(sizeof(es_visible_sets_options) == 120, visible_sets_options_size);
