// SPDX-License-Identifier: MIT
#include "earshot/propagation/internal/material_rows.h"

namespace earshot::propagation::internal {

namespace {

// Audience, musicians and seats, per area of floor.
constexpr MaterialRow kRows[] = {
    {"audience-heavy-seats",
     "occupied, heavily upholstered seats",
     kBeranek,
     to_4k({0.72, 0.8, 0.86, 0.89, 0.9, 0.9}),
     kAudience},
    {"audience-light-seats",
     "occupied, lightly upholstered seats",
     kBeranek,
     to_4k({0.51, 0.64, 0.75, 0.8, 0.82, 0.83}),
     kAudience},
    {"audience-orchestra-choir",
     "audience, orchestra or choir with narrow aisles",
     kVorlaender,
     {0.6, 0.74, 0.88, 0.96, 0.93, 0.85, 0.85},
     kAudience},
    {"audience-upholstered-seats",
     "occupied, medium upholstered seats",
     kBeranek,
     to_4k({0.62, 0.72, 0.8, 0.83, 0.84, 0.85}),
     kAudience},
    {"audience-wooden-chairs",
     "audience on wooden chairs, two persons per m2",
     kVorlaender,
     {0.24, 0.4, 0.78, 0.98, 0.96, 0.87, 0.87},
     kAudience},
    {"audience-wooden-pews",
     "congregation seated in wooden pews",
     kEgan,
     to_4k({0.57, 0.61, 0.75, 0.86, 0.91, 0.86}),
     kAudience},
    {"orchestra-on-podium",
     "orchestra with instruments on a podium, 1.5 m2 per person",
     kVorlaender,
     {0.27, 0.53, 0.67, 0.93, 0.87, 0.8, 0.8},
     kLikeAudience},
    {"seats-heavy-unoccupied",
     "heavily upholstered seats, unoccupied",
     kBeranek,
     to_4k({0.7, 0.76, 0.81, 0.84, 0.84, 0.81}),
     kAudience},
    {"seats-leather-unoccupied",
     "seats upholstered with leather cover, unoccupied",
     kVorlaender,
     {0.4, 0.5, 0.58, 0.61, 0.58, 0.5, 0.5},
     kAudience},
    {"seats-light-unoccupied",
     "lightly upholstered seats, unoccupied",
     kBeranek,
     to_4k({0.36, 0.47, 0.57, 0.62, 0.62, 0.6}),
     kAudience},
    {"seats-plastic",
     "plastic chairs, unoccupied",
     kVorlaender,
     {0.06, 0.1, 0.1, 0.2, 0.3, 0.2, 0.2},
     kLikeAudience},
    {"seats-unoccupied-upholstered",
     "medium upholstered seats, unoccupied",
     kBeranek,
     to_4k({0.54, 0.62, 0.68, 0.7, 0.68, 0.66}),
     kAudience},
    {"seats-wooden",
     "wooden chairs without cushion, unoccupied",
     kVorlaender,
     to_4k({0.05, 0.08, 0.1, 0.12, 0.12, 0.12}),
     kLikeAudience},
    {"students-tablet-arm-chairs",
     "students, informally dressed, in tablet-arm chairs",
     kEgan,
     to_4k({0.3, 0.41, 0.49, 0.84, 0.87, 0.84}),
     kClassroomTables},
};

}  // namespace

std::span<const MaterialRow> seating_rows() {
    return kRows;
}

}  // namespace earshot::propagation::internal
