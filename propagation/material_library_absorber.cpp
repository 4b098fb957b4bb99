// SPDX-License-Identifier: MIT
#include "earshot/propagation/internal/material_rows.h"

namespace earshot::propagation::internal {

namespace {

// Absorbers and acoustic ceilings.
constexpr MaterialRow kRows[] = {
    {"acoustic-board-suspended",
     "acoustical board, 19 mm, in a suspension system",
     kEgan,
     to_4k({0.76, 0.93, 0.83, 0.99, 0.99, 0.94}),
     kFlat},
    {"acoustic-plaster-10mm",
     "acoustic plaster, 10 mm, sprayed on a solid wall",
     kKuttruff,
     to_4k({0.08, 0.15, 0.3, 0.5, 0.6, 0.7}),
     kFlat},
    {"acoustic-plaster-25mm",
     "acoustical plaster, about 25 mm thick",
     kVorlaender,
     to_4k({0.17, 0.36, 0.66, 0.65, 0.62, 0.68}),
     kFlat},
    {"acoustic-tile-suspended",
     "fissured ceiling tile, suspended",
     kVorlaender,
     to_4k({0.49, 0.53, 0.53, 0.75, 0.92, 0.99}),
     kDepth10mm},
    {"fabric-panel-rockwool",
     "fabric-covered panel, rockwool core of 128 kg/m3",
     kVorlaender,
     {0.21, 0.66, 1.0, 1.0, 0.97, 0.98, 0.98},
     kFlat},
    {"foam-melamine-wedges",
     "wedge-shaped melamine foam ceiling tile",
     kVorlaender,
     to_4k({0.12, 0.33, 0.83, 0.97, 0.98, 0.95}),
     kDepth50mm},
    {"foam-polyurethane-15mm",
     "polyurethane foam, 27 kg/m3, 15 mm",
     kKuttruff,
     to_4k({0.08, 0.22, 0.55, 0.7, 0.85, 0.75}),
     kFlat},
    {"glass-fibre-50mm",
     "glass fibre board, 48 kg/m3, 50 mm, on a hard wall",
     kCox,
     to_4k({0.22, 0.82, 0.99, 0.99, 0.99, 0.99}),
     kFlat},
    {"gypsum-board-perforated",
     "perforated gypsum board, 19.6 % open, 100 mm cavity with mineral fibre mat",
     kVorlaender,
     to_4k({0.3, 0.69, 1.0, 0.81, 0.66, 0.62}),
     kFlat},
    {"metal-panel-ceiling",
     "metal panel ceiling, 20 mm tiles behind, 350 mm cavity",
     kVorlaender,
     to_4k({0.59, 0.8, 0.82, 0.65, 0.27, 0.23}),
     kFlat},
    {"microperforated-foil",
     "microperforated foil",
     kVorlaender,
     to_4k({0.06, 0.28, 0.7, 0.68, 0.74, 0.53}),
     kFlat},
    {"mineral-wool-50mm",
     "mineral wool, 50 mm, 40 kg/m3, glued to the wall, untreated",
     kVorlaender,
     {0.15, 0.7, 0.6, 0.6, 0.85, 0.9, 0.9},
     kFlat},
    {"rockwool-50mm",
     "rockwool, 50 mm, 80 kg/m3",
     kVorlaender,
     {0.22, 0.6, 0.92, 0.9, 0.88, 0.88, 0.88},
     kFlat},
    {"wood-perforated-chipboard",
     "perforated veneered chipboard, 150 mm cavity with 30 mm mineral wool",
     kVorlaender,
     to_4k({0.41, 0.67, 0.58, 0.59, 0.68, 0.35}),
     kFlat},
    {"wood-wool-50mm",
     "shredded-wood fibreboard, 50 mm, on concrete",
     kEgan,
     to_4k({0.15, 0.26, 0.62, 0.94, 0.64, 0.92}),
     kDepth50mm},
};

}  // namespace

std::span<const MaterialRow> absorber_rows() {
    return kRows;
}

}  // namespace earshot::propagation::internal
