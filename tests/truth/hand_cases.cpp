// SPDX-License-Identifier: MIT
#include "truth/hand_cases.h"

#include <array>
#include <utility>

namespace earshot::support {

using geometry::Vec3;

namespace {

constexpr std::uint32_t kSheet = 6;  // the label after the six walls

// Every hall here spans (0, 0, 0) to (10, 4, 6).
Room hall() {
    return box_room(Vec3{0.0}, {10.0, 4.0, 6.0});
}

// A sheet in the plane x = 5 that faces the far end (+x).
void add_screen(Room& room, double y0, double y1, double z0, double z1, std::uint32_t label) {
    const std::array<Vec3, 4> ring = {
        Vec3{5.0, y0, z0}, Vec3{5.0, y1, z0}, Vec3{5.0, y1, z1}, Vec3{5.0, y0, z1}};
    add_polygon(room, ring, label, true);
}

Room hall_with_screen(double y0, double y1, double z0, double z1) {
    Room room = hall();
    add_screen(room, y0, y1, z0, z1, kSheet);
    return room;
}

Room hall_with_two_screens(double y0, double y1, double z0, double z1, double z2, double z3) {
    Room room = hall_with_screen(y0, y1, z0, z1);
    add_screen(room, y0, y1, z2, z3, kSheet + 1);
    return room;
}

Room hall_with_sealed_box() {
    Room room = hall();
    add_hexahedron(room, box_corners({6.0, 1.0, 2.0}, {8.0, 3.0, 4.0}), Facing::outward, kSheet);
    return room;
}

// The floor in two coplanar halves of different labels, divided at x = 5.
Room hall_with_divided_floor() {
    Room room;
    room.kind = "divided floor";
    const Room whole = hall();
    for (std::size_t i = 0; i < whole.labels.size(); ++i) {
        if (whole.labels[i] != 2) {
            const auto& t = whole.mesh.triangles[i];
            const auto& p = whole.mesh.positions;
            add_triangle(room, {p[t[0]], p[t[1]], p[t[2]]}, whole.labels[i]);
        }
    }
    const auto add_floor = [&](double x0, double x1, std::uint32_t label) {
        const std::array<Vec3, 4> ring = {
            Vec3{x0, 0.0, 0.0}, Vec3{x0, 0.0, 6.0}, Vec3{x1, 0.0, 6.0}, Vec3{x1, 0.0, 0.0}};
        add_polygon(room, ring, label);
    };
    add_floor(0.0, 5.0, 2);
    add_floor(5.0, 10.0, kSheet);
    return room;
}

}  // namespace

void PrintTo(const HandCase& one, std::ostream* stream) {  // NOLINT: gtest's spelling
    *stream << one.name;
}

std::vector<HandCase> clear_cases() {
    std::vector<HandCase> cases;
    const auto add = [&](std::string name,
                         Room room,
                         std::vector<std::uint8_t> one_sided,
                         const Vec3& source,
                         const Vec3& listener,
                         std::vector<std::size_t> paths_per_order) {
        cases.push_back({std::move(name),
                         std::move(room),
                         std::move(one_sided),
                         source,
                         listener,
                         std::move(paths_per_order)});
    };
    const Vec3 near{2.0, 2.0, 3.0};
    const Vec3 far{7.0, 2.0, 3.0};

    add("order_zero_is_the_direct_sound_alone", hall(), {}, near, far, {1});
    // The screen hides the direct sound and both end walls; floor, ceiling and side walls carry on
    // past it, meeting x = 5 at 0.8 m from the wall in front.
    add("screen_hides_what_runs_through_it",
        hall_with_screen(1.0, 3.0, 2.0, 4.0),
        {},
        near,
        far,
        {0, 4});
    // All that stays in the plane z = 3 passes the slit; side walls lead through the screens.
    add("slit_of_a_millimetre_lets_through",
        hall_with_two_screens(0.0, 4.0, 0.0, 2.9995, 3.0005, 6.0),
        {},
        near,
        far,
        {1, 4});
    add("whole_partition_seals_off",
        hall_with_screen(0.0, 4.0, 0.0, 6.0),
        {},
        near,
        {7.13, 2.24, 3.37},
        {0, 0, 0, 0});
    add("closed_box_seals_off", hall_with_sealed_box(), {}, near, {7.13, 2.24, 3.37}, {0, 0, 0, 0});
    add("source_outside_is_not_heard", hall(), {}, {-2.0, 2.0, 3.0}, far, {0, 0, 0});
    // Outside, the near end wall reflects with its back, unless it has none.
    add("back_of_a_wall_reflects", hall(), {}, {-2.0, 2.0, 2.0}, {-3.0, 2.2, 4.0}, {1, 1, 0});
    add("back_of_a_one_sided_wall_does_not",
        hall(),
        {1, 1, 1, 1, 1, 1},
        {-2.0, 2.0, 2.0},
        {-3.0, 2.2, 4.0},
        {1, 0, 0});
    // Both stand on the screen's front. It hides the near end wall and reflects itself.
    const Vec3 left{7.0, 2.0, 2.5};
    const Vec3 right{7.0, 2.1, 3.5};
    const Room screened = hall_with_screen(1.0, 3.0, 2.0, 4.0);
    add("screen_reflects", screened, {}, left, right, {1, 6});
    add("one_sided_screen_reflects_on_its_front",
        screened,
        {0, 0, 0, 0, 0, 0, 1},
        left,
        right,
        {1, 6});
    // Mirrored in x = 5, both stand on its back: it hides the far end wall and reflects nothing.
    add("one_sided_screen_blocks_on_its_back",
        screened,
        {0, 0, 0, 0, 0, 0, 1},
        {3.0, 2.0, 2.5},
        {3.0, 2.1, 3.5},
        {1, 5});
    return cases;
}

std::vector<HandCase> degenerate_cases() {
    std::vector<HandCase> cases;
    const auto add = [&](std::string name,
                         Room room,
                         const Vec3& source,
                         const Vec3& listener,
                         std::vector<std::size_t> paths_per_order) {
        cases.push_back(
            {std::move(name), std::move(room), {}, source, listener, std::move(paths_per_order)});
    };
    const Vec3 near{2.0, 2.0, 3.0};
    const Vec3 far{7.0, 2.0, 3.0};

    add("leg_through_the_seam_of_two_screens_is_blocked",
        hall_with_two_screens(0.0, 4.0, 0.0, 3.0, 3.0, 6.0),
        near,
        far,
        {0, 0});
    add("leg_that_grazes_an_edge_is_blocked", hall_with_screen(0.0, 2.0, 0.0, 6.0), near, far, {0});
    add("leg_that_grazes_a_corner_is_blocked",
        hall_with_screen(0.0, 2.0, 0.0, 3.0),
        near,
        far,
        {0});
    add("leg_inside_the_plane_of_a_screen_is_blocked",
        hall_with_screen(1.0, 3.0, 2.0, 4.0),
        {5.0, 2.0, 1.0},
        {5.0, 2.0, 5.0},
        {0});
    add("source_and_listener_in_one_place", hall(), near, near, {1, 6, 18, 38});
    // Seen in plan, the image in the edge x = y = 0, source and listener stand on one line: the
    // sequences "end wall, floor" and "floor, end wall" are the same path.
    add("path_through_an_edge_stands_once", hall(), {1.0, 1.0, 2.0}, {2.0, 2.0, 3.25}, {1, 6, 18});
    add("path_through_a_corner_stands_once",
        hall(),
        {1.0, 1.0, 1.0},
        {2.0, 2.0, 2.0},
        {1, 6, 18, 38});
    add("path_on_the_diagonals_of_walls_stands_once",
        hall(),
        {4.0, 2.0, 3.0},
        {6.0, 2.0, 3.0},
        {1, 6, 18});
    add("path_on_the_border_of_two_coplanar_facets_stands_once",
        hall_with_divided_floor(),
        {4.0, 2.0, 3.0},
        {6.0, 2.0, 3.0},
        {1, 6});
    // Two coplanar screens, one inside the other: what touches one touches both.
    Room doubled = hall_with_screen(1.0, 3.0, 2.0, 4.0);
    add_screen(doubled, 0.5, 3.5, 1.5, 4.5, kSheet + 1);
    add("path_on_two_overlapping_facets_stands_once",
        std::move(doubled),
        {7.0, 2.0, 2.5},
        {7.0, 2.0, 3.5},
        {1, 6});
    return cases;
}

}  // namespace earshot::support
