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
// alone cannot be checked. Texts end with a zero; those that go in are UTF-8, and names come out as
// their file has them.
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

#include "earshot_base.h"
#include "earshot_bvh.h"
#include "earshot_calibrate.h"
#include "earshot_check.h"
#include "earshot_engine.h"
#include "earshot_locate.h"
#include "earshot_map.h"
#include "earshot_motion.h"
#include "earshot_report.h"
#include "earshot_scene.h"
#include "earshot_simplify.h"
#include "earshot_simulation.h"
#include "earshot_sound.h"
#include "earshot_visible_sets.h"
#include "earshot_world.h"

#endif
