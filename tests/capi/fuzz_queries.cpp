// SPDX-License-Identifier: MIT
// Calls on hierarchies, worlds and contacts.
#include "capi/fuzz_caller.h"
#include <algorithm>

namespace earshot::capi_fuzz {
namespace {

/// A size that no array has, now and then.
std::size_t huge_or(Caller& c, std::size_t count) {
    if (count > 0 && c.chance(0.02)) {
        c.wrong = true;
        return static_cast<std::size_t>(-1) / (1 + c.count(40));
    }
    return count;
}

es_status create_bvh(Caller& c) {
    es_bvh bvh = 0;
    if (c.below(3) == 0) {
        const es_scene scene = c.handle(ES_KIND_SCENE);
        const double time = c.number(-1e12, 1e12);
        const std::int32_t builder = c.choice(7), threads = c.threads();
        return kept(c, es_bvh_create_from_scene(scene, time, builder, threads, c.out(bvh)), bvh);
    }
    const std::size_t vertices = c.count(30), triangles = vertices == 0 ? 0 : c.count(60);
    const double* points = c.points(vertices);
    const std::uint32_t* corners = c.indices(3 * triangles, vertices);
    const std::int32_t builder = c.choice(7), threads = c.threads();
    const std::size_t given = huge_or(c, triangles);
    return kept(
        c, es_bvh_create(points, vertices, corners, given, builder, threads, c.out(bvh)), bvh);
}

es_status update_bvh(Caller& c) {
    const es_bvh bvh = c.handle(ES_KIND_BVH);
    size_t vertices = 0, triangles = 0;
    if (c.below(4) == 0) {
        return es_bvh_counts(bvh, &vertices, &triangles);
    }
    es_bvh_counts(bvh, &vertices, &triangles);
    if (c.below(4) == 0) {
        const std::size_t count = c.count(3);
        const std::uint32_t* excluded = c.indices(count, triangles);
        return es_bvh_exclude(bvh, excluded, count);
    }
    const double* points = c.points(vertices);
    const double queries = c.number(0.0, 1e15);
    const std::size_t given = c.chance(0.97) ? vertices : vertices + 1 + c.count(5);
    c.wrong = c.wrong || given != vertices;
    const std::int32_t threads = c.threads();
    std::int32_t action = 0;
    return es_bvh_update(bvh, points, given, queries, threads, &action);
}

es_status rays(Caller& c) {
    const es_bvh bvh = c.handle(ES_KIND_BVH);
    const std::size_t count = c.count(20);
    const double *origins = c.points(count), *directions = c.vectors(count);
    // Rounding makes some of them have no length, which is wrong, too.
    for (std::size_t i = 0; directions != nullptr && i < count; ++i) {
        c.wrong = c.wrong || (directions[3 * i] == 0.0 && directions[3 * i + 1] == 0.0 &&
                              directions[3 * i + 2] == 0.0);
    }
    const double* max_t = c.chance(0.5) ? nullptr : c.distances(count);
    const std::int32_t threads = c.threads();
    double* t = c.room(count, true);
    std::uint32_t* triangles = c.numbers(count, true);
    double* uv = c.room(2 * count, true);
    const std::size_t given = huge_or(c, count);
    return es_bvh_closest_hits(bvh, origins, directions, max_t, given, threads, t, triangles, uv);
}

es_status segments(Caller& c) {
    const es_bvh bvh = c.handle(ES_KIND_BVH);
    const std::size_t count = c.count(20);
    const double *from = c.points(count), *to = c.points(count);
    const std::int32_t threads = c.threads();
    const std::size_t given = huge_or(c, count);
    if (c.below(3) == 0) {
        std::uint32_t* triangles = c.numbers(count, false);
        double* t = c.room(count, true);
        return es_bvh_first_blockers(bvh, from, to, given, threads, triangles, t);
    }
    std::uint8_t* answers = c.bytes(count);
    return c.below(2) == 0 ? es_bvh_visible(bvh, from, to, given, threads, answers)
                           : es_bvh_occluded(bvh, from, to, given, threads, answers);
}

es_status matrix(Caller& c) {
    const es_bvh bvh = c.handle(ES_KIND_BVH);
    const std::size_t rows = c.count(6), columns = c.count(6);
    const double *from = c.points(rows), *to = c.points(columns);
    const std::int32_t threads = c.threads();
    std::uint8_t* answers = c.bytes(rows * columns);
    const std::size_t given = huge_or(c, columns);
    return es_bvh_visible_matrix(bvh, from, rows, to, given, threads, answers);
}

es_status closest_points(Caller& c) {
    const es_bvh bvh = c.handle(ES_KIND_BVH);
    const std::size_t count = c.count(20);
    const double* points = c.points(count);
    const double max_distance = c.chance(0.95) ? 3.0 : -1.0;
    c.wrong = c.wrong || max_distance < 0.0;
    const std::int32_t threads = c.threads();
    double* distances = c.room(count, true);
    std::uint32_t* triangles = c.numbers(count, true);
    double* closest = c.room(3 * count, true);
    const std::size_t given = huge_or(c, count);
    return es_bvh_closest_points(
        bvh, points, given, max_distance, threads, distances, triangles, closest);
}

std::size_t mesh_count(es_world world) {
    size_t count = 0;
    return es_world_mesh_count(world, &count) == ES_OK ? count : 0;
}

es_status create_world(Caller& c) {
    es_world world = 0;
    return kept(c, es_world_create(c.out(world)), world);
}

/// All meshes that are not of scenes have so many vertices.
constexpr std::size_t kVertices = 5;

es_status add_mesh(Caller& c) {
    const es_world world = c.handle(ES_KIND_WORLD);
    std::uint32_t mesh = 0;
    if (mesh_count(world) > 8) {
        return es_release(0);
    }
    if (c.below(5) == 0) {
        const es_scene scene = c.handle(ES_KIND_SCENE);
        const std::int32_t weld = c.flag();
        return es_world_add_scene(world, scene, weld, c.out(mesh));
    }
    const std::size_t triangles = c.count(6);
    const double* points = c.points(kVertices);
    const std::uint32_t* corners = c.indices(3 * triangles, kVertices);
    const char* name = c.text({"mesh", ""}, true);
    const std::size_t given = huge_or(c, triangles);
    return es_world_add_mesh(world, name, points, kVertices, corners, given, c.out(mesh));
}

es_status step(Caller& c) {
    const es_world world = c.handle(ES_KIND_WORLD);
    if (c.below(5) == 0) {
        const double t0 = c.number(-1e12, 1e12), t1 = c.number(-1e12, 1e12);
        const std::int32_t rigid = c.flag();
        return es_world_set_time_step(world, t0, t1, rigid);
    }
    const auto mesh = static_cast<std::uint32_t>(c.index(mesh_count(world)));
    const char* name = nullptr;
    switch (c.below(3)) {
        case 0: {
            const double* begin = c.points(kVertices);
            const double* end = c.points(kVertices, 4.0, true);
            return es_world_step_mesh(world, mesh, begin, end, kVertices);
        }
        case 1: {
            const double *begin = c.points(kVertices), *point = c.points(1), *axis = c.points(1);
            const double angle = c.number(-1e3, 1e3, {-1.0, 1.0}),
                         slide = c.number(-1e12, 1e12, {-3.0, 3.0});
            return es_world_step_screw(world, mesh, begin, kVertices, point, axis, angle, slide);
        }
        default:
            return c.chance(0.8) ? es_world_mesh_name(world, mesh, c.out(name))
                                 : es_world_remove_mesh(world, mesh);
    }
}

es_status contacts(Caller& c) {
    const es_world world = c.handle(ES_KIND_WORLD);
    es_contact_options options;
    es_contact_options_init(&options, sizeof options);
    if (c.chance(0.02)) {
        options.struct_size = c.count(100);
        c.wrong = c.wrong || options.struct_size != sizeof options;
    }
    options.between_meshes = c.flag();
    options.within_meshes = c.flag();
    options.moving_only = c.flag();
    options.threads = c.threads();
    options.min_separation = c.chance(0.97) ? 0.0 : c.number(0.0, 1e6, {0.0, 0.1});
    options.tolerance = c.number(1e-12, 1.0, {1e-6, 1e-3});
    if (c.chance(0.2)) {
        options.pair_count = c.count(3);
        options.pairs = c.indices(2 * options.pair_count, mesh_count(world));
    }
    es_contacts found = 0;
    es_contact contact;
    std::int32_t has_contact = 0;
    switch (c.below(3)) {
        case 0:
            return kept(c, es_world_contacts(world, &options, c.out(found)), found);
        case 1:
            return kept(c, es_world_intersections(world, &options, c.out(found)), found);
        default:
            return es_world_first_contact(world, &options, c.out(contact), c.out(has_contact));
    }
}

es_status read_contacts(Caller& c) {
    const es_contacts contacts = c.handle(ES_KIND_CONTACTS);
    const es_contact* array = nullptr;
    size_t count = 0;
    const es_status status = es_contacts_get(contacts, c.out(array), c.out(count));
    for (std::size_t i = 0; status == ES_OK && i < count; ++i) {
        const es_contact& contact = array[i];
        c.wrong = c.wrong || !(contact.toi >= 0.0 && contact.toi <= 1.0) ||
                  contact.a.vertex_count > 3 || contact.b.vertex_count > 3;
    }
    return status;
}

es_status distances(Caller& c) {
    const es_world world = c.handle(ES_KIND_WORLD);
    const std::size_t meshes = mesh_count(world);
    const auto a = static_cast<std::uint32_t>(c.index(meshes)),
               b = static_cast<std::uint32_t>(c.index(meshes));
    es_distance distance;
    es_depth depth;
    if (c.below(2) == 0) {
        const std::int32_t threads = c.threads();
        return es_world_distance(world, a, b, threads, c.out(distance));
    }
    return es_world_depth(world, a, b, c.out(depth));
}

es_status build_with(Caller& c, es_scene scene, es_visible_sets_options& options) {
    options.triangles_per_object = c.chance(0.98) ? 1 + c.count(3) : 0;
    c.wrong = c.wrong || options.triangles_per_object == 0;
    options.rays = 1 + c.count(300);
    options.until = c.chance(0.5) ? -1 : static_cast<std::int64_t>(c.count(9));
    options.validation_rays = c.chance(0.97) ? static_cast<std::int64_t>(c.count(50)) : -2;
    c.wrong = c.wrong || options.validation_rays < -1;
    options.segments = c.chance(0.98) ? 1 + c.count(100) : 0;
    c.wrong = c.wrong || options.segments == 0;
    options.seconds = c.chance(0.98) ? 1.0 : -1.0;
    c.wrong = c.wrong || options.seconds < 0.0;
    options.skip_solids = c.flag();
    options.threads = c.threads();
    es_visible_sets sets = 0;
    return kept(c, es_visible_sets_build(scene, &options, c.out(sets)), sets);
}

es_status build_visible_sets(Caller& c) {
    const es_scene scene = c.handle(ES_KIND_SCENE);
    es_visible_sets_options options;
    es_visible_sets_options_init(&options, sizeof options);
    options.time = c.number(-1e12, 1e12);
    std::uint32_t boxes[3] = {1 + static_cast<std::uint32_t>(c.below(3)), 1, 2};
    switch (c.below(4)) {
        case 0:
            options.cells = c.chance(0.97) ? 1 + c.count(4) : std::size_t{1} << 30U;
            c.wrong = c.wrong || options.cells > 5;
            break;
        case 1:
            options.grid = boxes;
            boxes[1] = c.chance(0.95) ? 1 : 0;
            c.wrong = c.wrong || boxes[1] == 0;
            break;
        default:
            break;
    }
    const double corners[6] = {-2.0, -2.0, -2.0, 2.0, c.chance(0.9) ? 2.0 : -3.0, 2.0};
    if (c.chance(0.3)) {
        c.wrong = c.wrong || corners[4] < 0.0;
        options.region = corners;
    }
    return build_with(c, scene, options);
}

es_status visible_sets(Caller& c) {
    const es_visible_sets sets = c.handle(ES_KIND_VISIBLE_SETS);
    es_visible_sets_info info{};
    info.struct_size = sizeof info;
    const bool has_info = es_visible_sets_get_info(sets, &info) == ES_OK;
    const std::size_t cell = c.index(has_info ? info.cells : 1);
    const auto number = static_cast<std::uint32_t>(cell);
    std::uint32_t cells[3];
    const std::uint32_t* objects = nullptr;
    const double* volumes = nullptr;
    size_t count = 0;
    switch (c.below(6)) {
        case 0:
            c.wrong = !has_info;
            return es_visible_sets_get_info(sets, &info);
        case 1: {
            c.wrong = !has_info;
            const double* points = c.points(3);
            return es_visible_sets_locate(sets, points, 3, cells);
        }
        case 2:
            c.wrong = !has_info;
            return es_visible_sets_volumes(sets, &volumes, c.out(count));
        case 3:
            return es_visible_sets_objects(sets, number, &objects, c.out(count));
        case 4: {
            c.wrong = !has_info;
            const char* file = c.text({"fuzz.pvs", "none/none.pvs"});
            return es_visible_sets_write(sets, file);
        }
        default:
            return es_visible_sets_triangles(sets, number, cells, 3, c.out(count));
    }
}

}  // namespace

const std::vector<WeightedCall>& query_calls() {
    static const std::vector<WeightedCall> calls = {{"create_bvh", create_bvh, 12},
                                                    {"update_bvh", update_bvh, 15},
                                                    {"rays", rays, 15},
                                                    {"segments", segments, 15},
                                                    {"matrix", matrix, 8},
                                                    {"closest_points", closest_points, 8},
                                                    {"create_world", create_world, 5},
                                                    {"add_mesh", add_mesh, 20},
                                                    {"step", step, 25},
                                                    {"contacts", contacts, 20},
                                                    {"read_contacts", read_contacts, 10},
                                                    {"distances", distances, 12},
                                                    {"build_visible_sets", build_visible_sets, 2},
                                                    {"visible_sets", visible_sets, 8}};
    return calls;
}

}  // namespace earshot::capi_fuzz
