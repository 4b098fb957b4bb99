// SPDX-License-Identifier: MIT
#include "earshot/propagation/internal/material_rows.h"

namespace earshot::propagation::internal {

namespace {

// Curtains and blinds.
constexpr MaterialRow kRows[] = {
    {"blinds-venetian-metal",
     "venetian blinds of metal",
     kEgan,
     to_4k({0.06, 0.05, 0.07, 0.15, 0.13, 0.17}),
     kDepth50mm},
    {"blinds-vertical-half-open",
     "vertical blinds, 150 mm from the wall, half opened",
     kVorlaender,
     to_4k({0.03, 0.09, 0.24, 0.46, 0.79, 0.76}),
     kDepth50mm},
    {"curtain-cotton",
     "cotton curtains, 0.5 kg/m2, draped to 3/4 area, 130 mm from the wall",
     kVorlaender,
     {0.3, 0.45, 0.65, 0.56, 0.59, 0.71, 0.71},
     kDepth50mm},
    {"curtain-heavy",
     "heavy velour, 0.61 kg/m2, draped to half area",
     kEgan,
     to_4k({0.14, 0.35, 0.55, 0.72, 0.7, 0.65}),
     kDepth50mm},
    {"curtain-light",
     "light velour, 0.34 kg/m2, hung straight against the wall",
     kEgan,
     to_4k({0.03, 0.04, 0.11, 0.17, 0.24, 0.35}),
     kFlat},
    {"curtain-medium",
     "medium velour, 0.48 kg/m2, draped to half area",
     kEgan,
     to_4k({0.07, 0.31, 0.49, 0.75, 0.7, 0.6}),
     kDepth50mm},
    {"curtain-plush-folded",
     "plush curtain, deeply folded, 50 mm from the wall",
     kKuttruff,
     to_4k({0.15, 0.45, 0.9, 0.92, 0.95, 0.95}),
     kDepth100mm},
    {"curtain-velvet-tight",
     "tight velvet curtains",
     kVorlaender,
     {0.05, 0.12, 0.35, 0.45, 0.38, 0.36, 0.36},
     kFlat},
    {"curtain-window-woven",
     "densely woven window curtains, 90 mm from the wall",
     kVorlaender,
     to_4k({0.06, 0.1, 0.38, 0.63, 0.7, 0.73}),
     kDepth50mm},
};

}  // namespace

std::span<const MaterialRow> textile_rows() {
    return kRows;
}

}  // namespace earshot::propagation::internal
