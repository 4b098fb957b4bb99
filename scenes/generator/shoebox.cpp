// SPDX-License-Identifier: MIT
#include "earshot/scenes/carving.h"
#include "earshot/scenes/models.h"

namespace earshot::scenes {

// Source and listener are those of the image-source oracle in the tests; its z is up, so its
// (x, y, z) is (x, z, -y) here.
SceneDraft make_shoebox(const ShoeboxOptions& options) {
    SceneDraft draft;
    draft.name = "shoebox";
    Carving room(draft.plain_material("wall", options.absorption));
    room.carve({{0.0, 0.0, -options.size.z}, {options.size.x, options.size.y, 0.0}});
    draft.add_geometry("room", room.surface());

    // Where the oracle has them in a room of 8 x 3.5 x 6 m, and in proportion in any other.
    const Vec3 scale = options.size / Vec3(8.0, 3.5, 6.0);
    draft.add_source("source", scale * Vec3(2.0, 1.2, -1.5));
    draft.add_listener("listener", scale * Vec3(5.5, 1.6, -4.0));
    return draft;
}

}  // namespace earshot::scenes
