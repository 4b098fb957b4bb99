// SPDX-License-Identifier: MIT
#include "earshot/propagation/internal/material_rows.h"

namespace earshot::propagation::internal {

namespace {

// Scattering: the suggestions for brickwork, filled and open joints, in Christensen & Koutsouris
// 2013, Odeon Room Acoustics Software user's manual, section 6 (0.05-0.1 and 0.1-0.2).

// Walls of stone, brick, concrete, plaster, tile.
constexpr MaterialRow kRows[] = {
    {"brick-painted",
     "unglazed brickwork, painted",
     kEgan,
     to_4k({0.01, 0.01, 0.02, 0.02, 0.02, 0.03}),
     {}},
    {"brick-unglazed",
     "unglazed brickwork, filled joints",
     kEgan,
     to_4k({0.03, 0.03, 0.03, 0.04, 0.05, 0.07}),
     everywhere(0.08)},
    {"brick-deep-joints",
     "smooth brickwork, 10 mm deep pointing, pit sand mortar",
     kVorlaender,
     {0.08, 0.09, 0.12, 0.16, 0.22, 0.24, 0.24},
     everywhere(0.15)},
    {"brick-open-joints",
     "facing brickwork with open butt joints",
     kVorlaender,
     to_4k({0.04, 0.14, 0.49, 0.35, 0.31, 0.36}),
     everywhere(0.15)},
    {"brick-rendered",
     "rendered brickwork",
     kVorlaender,
     {0.01, 0.02, 0.02, 0.03, 0.03, 0.04, 0.04},
     {}},
    {"brick-stucco-rough",
     "brick wall, stuccoed with a rough finish",
     kVorlaender,
     {0.03, 0.03, 0.03, 0.04, 0.05, 0.07, 0.07},
     {}},
    {"concrete-block-coarse",
     "coarse concrete blocks, unpainted",
     kEgan,
     to_4k({0.36, 0.44, 0.31, 0.29, 0.39, 0.25}),
     {}},
    {"concrete-block-painted",
     "concrete blocks, painted",
     kEgan,
     to_4k({0.1, 0.05, 0.06, 0.07, 0.09, 0.08}),
     {}},
    {"concrete-rough",
     "rough concrete",
     kVorlaender,
     {0.02, 0.03, 0.03, 0.03, 0.04, 0.07, 0.07},
     {}},
    {"concrete-smooth",
     "smooth unpainted concrete",
     kVorlaender,
     {0.01, 0.01, 0.02, 0.02, 0.02, 0.05, 0.05},
     {}},
    {"hard-walls-average",
     "average of hard walls and floors: brick, plaster, stone",
     kKuttruff,
     to_4k({0.02, 0.02, 0.03, 0.03, 0.04, 0.05}),
     {}},
    {"limestone", "limestone walls", kVorlaender, {0.02, 0.02, 0.03, 0.04, 0.05, 0.05, 0.05}, {}},
    {"marble", "marble or glazed tile", kEgan, to_4k({0.01, 0.01, 0.01, 0.01, 0.02, 0.02}), {}},
    {"plaster-on-brick",
     "plaster, gypsum or lime, smooth finish on brick or tile",
     kHarris,
     to_4k({0.013, 0.015, 0.02, 0.03, 0.04, 0.05}),
     {}},
    {"plaster-on-concrete-block",
     "plaster, gypsum or lime, on concrete block",
     kEgan,
     to_4k({0.12, 0.09, 0.07, 0.05, 0.05, 0.04}),
     {}},
    {"tile-ceramic",
     "ceramic tiles with a smooth surface",
     kVorlaender,
     {0.01, 0.01, 0.01, 0.02, 0.02, 0.02, 0.02},
     {}},
};

}  // namespace

std::span<const MaterialRow> masonry_rows() {
    return kRows;
}

}  // namespace earshot::propagation::internal
