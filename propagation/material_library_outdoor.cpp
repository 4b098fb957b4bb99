// SPDX-License-Identifier: MIT
#include "earshot/propagation/internal/material_rows.h"

namespace earshot::propagation::internal {

namespace {

// Ground, water, openings.
constexpr MaterialRow kRows[] = {
    {"grass", "grass, 50 mm high", kEgan, to_4k({0.11, 0.26, 0.6, 0.69, 0.92, 0.99}), kDepth50mm},
    {"gravel",
     "gravel, loose and moist, 100 mm thick",
     kEgan,
     to_4k({0.25, 0.6, 0.65, 0.7, 0.75, 0.8}),
     kDepth50mm},
    {"opening",
     "an opening to the free field: nothing comes back",
     "Kuttruff 2009, Room Acoustics, section 2.1: an open window absorbs all",
     everywhere(1.0),
     kNoReflection},
    {"snow",
     "snow, freshly fallen, 100 mm thick",
     kEgan,
     to_4k({0.45, 0.75, 0.9, 0.95, 0.95, 0.95}),
     kFlat},
    {"soil-rough", "rough soil", kEgan, to_4k({0.15, 0.25, 0.4, 0.55, 0.6, 0.6}), kDepth50mm},
    {"water-surface",
     "water surface, as in a swimming pool",
     kHarris,
     to_4k({0.008, 0.008, 0.013, 0.015, 0.02, 0.025}),
     kPolished},
};

}  // namespace

std::span<const MaterialRow> outdoor_rows() {
    return kRows;
}

}  // namespace earshot::propagation::internal
