// SPDX-License-Identifier: MIT
#include "earshot/propagation/internal/material_rows.h"

namespace earshot::propagation::internal {

namespace {

// Floors and carpets.
constexpr MaterialRow kRows[] = {
    {"carpet-6mm-on-foam",
     "6 mm pile carpet bonded to open-cell foam underlay",
     kVorlaender,
     {0.03, 0.09, 0.2, 0.54, 0.7, 0.72, 0.72},
     kFlat},
    {"carpet-heavy-on-concrete",
     "heavy carpet on concrete",
     kEgan,
     to_4k({0.02, 0.06, 0.14, 0.37, 0.6, 0.65}),
     kFlat},
    {"carpet-heavy-on-foam",
     "heavy carpet on foam rubber or 1.35 kg/m2 hair felt",
     kEgan,
     to_4k({0.08, 0.24, 0.57, 0.69, 0.71, 0.73}),
     kFlat},
    {"carpet-needle-felt",
     "needle felt, 5 mm, stuck to concrete",
     kVorlaender,
     {0.02, 0.02, 0.05, 0.15, 0.3, 0.4, 0.4},
     kFlat},
    {"carpet-on-felt",
     "9 mm tufted pile carpet on felt underlay",
     kVorlaender,
     {0.08, 0.08, 0.3, 0.6, 0.75, 0.8, 0.8},
     kFlat},
    {"carpet-thin",
     "thin carpet, cemented to concrete",
     kVorlaender,
     to_4k({0.02, 0.04, 0.08, 0.2, 0.35, 0.4}),
     kFlat},
    {"concrete-floor",
     "concrete or terrazzo floor",
     kEgan,
     to_4k({0.01, 0.01, 0.02, 0.02, 0.02, 0.02}),
     kFlat},
    {"linoleum-on-concrete",
     "linoleum, asphalt, rubber or cork tile on concrete",
     kVorlaender,
     to_4k({0.02, 0.03, 0.03, 0.03, 0.03, 0.02}),
     kFlat},
    {"parquet-on-concrete",
     "wood parquet in asphalt on concrete",
     kEgan,
     to_4k({0.04, 0.04, 0.07, 0.06, 0.06, 0.07}),
     kFlat},
    {"wood-audience-floor",
     "audience floor, two layers, 33 mm on sleepers over concrete",
     kVorlaender,
     to_4k({0.09, 0.06, 0.05, 0.05, 0.05, 0.04}),
     kFlat},
    {"wood-floor-on-joists",
     "wood floor on joists",
     kEgan,
     to_4k({0.15, 0.11, 0.1, 0.07, 0.06, 0.07}),
     kFlat},
    {"wood-stage-floor",
     "stage floor of wood, two layers, 27 mm over air space",
     kVorlaender,
     to_4k({0.1, 0.07, 0.06, 0.06, 0.06, 0.06}),
     kFlat},
};

}  // namespace

std::span<const MaterialRow> floor_rows() {
    return kRows;
}

}  // namespace earshot::propagation::internal
