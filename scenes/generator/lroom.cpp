// SPDX-License-Identifier: MIT
#include "earshot/scenes/carving.h"
#include "earshot/scenes/models.h"

namespace earshot::scenes {

// The L room of the image-source oracle in the tests; its z is up, so its (x, y, z) is (x, z, -y)
// here. `los` see each other, `nlos` do not, and in `symedge`, symmetric about the plane x = -z,
// paths meet edges exactly: the one scene that is degenerate on purpose.
SceneDraft make_lroom(const LRoomOptions& options) {
    SceneDraft draft;
    draft.name = "lroom";
    Carving room(draft.plain_material("wall", options.absorption));
    room.carve({{0.0, 0.0, -3.0}, {6.0, 3.0, 0.0}});
    room.carve({{0.0, 0.0, -6.0}, {3.0, 3.0, -3.0}});
    draft.add_geometry("room", room.surface());

    draft.add_source("los_source", {1.0, 1.5, -4.6});
    draft.add_listener("los_listener", {4.4, 1.2, -0.9});
    draft.add_source("nlos_source", {1.5, 1.5, -5.0});
    draft.add_listener("nlos_listener", {5.0, 1.2, -1.8});
    draft.add_source("symedge_source", {1.0, 1.5, -4.5});
    draft.add_listener("symedge_listener", {4.5, 1.2, -1.0});
    return draft;
}

}  // namespace earshot::scenes
