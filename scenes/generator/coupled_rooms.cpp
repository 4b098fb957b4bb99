// SPDX-License-Identifier: MIT
#include "earshot/scenes/carving.h"
#include "earshot/scenes/colours.h"
#include "earshot/scenes/models.h"

namespace earshot::scenes {

// A live room (x < 0, concrete) and a dead one (x > 0.2, carpet and absorbing ceiling) either side
// of a wall 0.2 m thick. The decay in the dead room bends where the live one takes over.
SceneDraft make_coupled_rooms(const CoupledRoomsOptions& options) {
    SceneDraft draft;
    draft.name = "coupled_rooms";
    const std::size_t concrete = draft.library_material("concrete-smooth", kConcrete);
    const std::size_t plaster = draft.library_material("plaster-on-brick", kPlaster);
    const std::size_t carpet = draft.library_material("carpet-heavy-on-foam", kRed);
    const std::size_t tiles = draft.library_material("acoustic-tile-suspended", kGrey);
    const std::size_t wood = draft.library_material("wood-lining-12mm", kWood);

    const Box live{{-7.0, 0.0, -3.0}, {0.0, 4.0, 3.0}};
    const Box dead{{0.2, 0.0, -2.6}, {5.2, 2.8, 2.6}};
    const double left = -0.9;  // off the middle, so that nothing is symmetric
    const Box opening{{0.0, 0.0, left}, {0.2, 2.1, left + options.opening}};
    Carving rooms(plaster);
    rooms.carve(live);
    rooms.carve(dead);
    rooms.carve(opening);
    rooms.paint(live, concrete);
    rooms.paint(opening, wood);
    rooms.paint(opening, concrete, Facing::up);
    rooms.paint(dead, plaster);
    rooms.paint(dead, carpet, Facing::up);
    rooms.paint(dead, tiles, Facing::down);
    draft.add_geometry("rooms", rooms.surface());

    draft.add_source("live_source", {-4.35, 1.45, 1.17});
    draft.add_listener("live_listener", {-1.61, 1.23, -1.34});
    draft.add_listener("dead_listener", {3.42, 1.21, 0.83});
    return draft;
}

}  // namespace earshot::scenes
