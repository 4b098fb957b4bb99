// SPDX-License-Identifier: MIT
#include "earshot/base/math.h"
#include "earshot/scenes/colours.h"
#include "earshot/scenes/concert_hall_plan.h"
#include "earshot/scenes/shapes.h"

#include <utility>

namespace earshot::scenes {

using namespace plan;

HallMaterials::HallMaterials(SceneDraft& draft)
    : wall(draft.library_material("plaster-on-brick", kPlaster)),
      panelling(draft.library_material("wood-panelling-25mm", kWood)),
      rear_wall(draft.library_material("wood-perforated-chipboard", kDarkWood)),
      ceiling(draft.library_material("gypsum-board-double", kPlaster)),
      coffer(draft.library_material("panel-heavy", kGold)),
      floor(draft.library_material("parquet-on-concrete", kWood)),
      stage(draft.library_material("wood-stage-floor", kGold)),
      balcony(draft.library_material("plaster-on-lath", kPlaster)),
      organ(draft.library_material("wood-lining-12mm", kGrey)),
      door(draft.library_material("door-solid-wood", kDarkWood)),
      seat(draft.library_material("seats-unoccupied-upholstered", kRed)),
      bench(draft.library_material("seats-light-unoccupied", kRed)),
      canopy(draft.library_material("plywood-10mm", kGlass)) {
    // An occupied hall, lined with wood. An audience is measured per area of floor (Beranek and
    // Hidaka 1998): 285 m2 of the stalls, where the modelled seats have 843 m2. The benches have
    // about the area of their floor.
    constexpr double kSeatCoverage = 285.0 / 843.0;
    constexpr double kOrchestra = 100.0 / 217.0;  // of the area of the stage
    draft.spread_row(seat, "audience-upholstered-seats", kSeatCoverage);
    draft.spread_row(bench, "audience-light-seats", 1.0);
    draft.spread_row(stage, "orchestra-on-podium", kOrchestra);
    draft.spread_row(floor, "wood-audience-floor", 1.0);
    draft.spread_row(wall, "wood-panelling-16mm", 1.0);
    for (const std::size_t material : {ceiling, coffer, balcony}) {
        draft.spread_row(material, "wood-lining-12mm", 1.0);
    }
    // Ornament that is not modelled, metres deep.
    constexpr double kOrnament = 0.1;
    for (const std::size_t material : {wall, coffer, balcony, organ}) {
        draft.set_structure(material, kOrnament);
    }
}

// A cushion and a back that leans, seen from the side; people look towards -z.
Faces hall_seats(const HallMaterials& materials) {
    const std::vector<Vec2> profile = {
        {0.00, 0.18}, {0.60, 0.18}, {0.70, 0.92}, {0.58, 0.92}, {0.50, 0.44}, {0.00, 0.44}};
    constexpr double kBetweenSeats = 0.04;
    Faces faces;
    for (int row = 0; row < kRows; ++row) {
        for (const Section& section : kSections) {
            for (int seat = 0; seat < section.seats; ++seat) {
                const double right = section.left + kSeatWidth * (seat + 1) - kBetweenSeats / 2.0;
                const Frame frame{
                    .origin = {right, floor_of_row(row), kFirstRow + kRowPitch * row + 0.35},
                    .u = {0.0, 0.0, 1.0},
                    .v = {0.0, 1.0, 0.0},
                    .w = {-1.0, 0.0, 0.0}};
                append(faces, prism(profile, kSeatWidth - kBetweenSeats, frame, materials.seat));
            }
        }
    }
    return faces;
}

Faces hall_canopy(const HallMaterials& materials) {
    Faces faces;
    for (int row = 0; row < 2; ++row) {
        for (int column = -1; column <= 1; ++column) {
            // Tilted about x towards the stalls, and about z towards the middle.
            const double pitch = 0.21 + 0.08 * row;
            const double roll = -0.12 * column;
            const Vec3 u(math::cos(roll), math::sin(roll), 0.0);
            const Vec3 w(math::sin(roll) * math::sin(pitch),
                         -math::cos(roll) * math::sin(pitch),
                         math::cos(pitch));
            const Vec3 v(w.y * u.z - w.z * u.y, w.z * u.x - w.x * u.z, w.x * u.y - w.y * u.x);
            const Vec3 centre(4.1 * column, 9.8 + 0.6 * row, 6.3 + 3.1 * row);
            const Frame frame{.origin = centre - u * 1.7 - w * 1.2, .u = u, .v = v, .w = w};
            append(faces,
                   prism({{0.0, 0.0}, {3.4, 0.0}, {3.4, 0.04}, {0.0, 0.04}},
                         2.4,
                         frame,
                         materials.canopy));
        }
    }
    return faces;
}

SceneDraft make_concert_hall(const ConcertHallOptions& options) {
    SceneDraft draft;
    draft.name = "concert_hall";
    const HallMaterials materials(draft);
    draft.materials[materials.coffer].in_picture = false;
    draft.add_geometry("hall", hall_shell(materials, options.seats));
    draft.add_geometry("canopy", hall_canopy(materials));
    if (options.seats == Seats::individual) {
        draft.add_geometry("seats", hall_seats(materials));
    }

    // Ears 1.2 m above the floor of their seat.
    constexpr double kEar = 1.2;
    draft.add_source("soloist", {0.37, kStage + 1.53, 9.62});
    draft.add_source("winds", {-2.83, kStage + 0.35 + 1.17, 4.71});
    draft.add_listener("stalls_front",
                       {-1.43, floor_of_row(5) + kEar, kFirstRow + 5.0 * kRowPitch + 0.61});
    draft.add_listener("stalls_rear",
                       {5.17, floor_of_row(18) + kEar, kFirstRow + 18.0 * kRowPitch + 0.63});
    draft.add_listener("side_balcony", {-8.57, kBalconyFloor + kEar, 21.37});
    draft.add_listener("rear_balcony",
                       {2.91, kBalconyFloor + 0.8 + kEar, kRearStart + 2.4 + 1.5 + 0.97});
    return draft;
}

}  // namespace earshot::scenes
