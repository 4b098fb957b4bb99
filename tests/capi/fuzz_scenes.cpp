// SPDX-License-Identifier: MIT
// Calls on scenes, materials, sources and listeners.
#include "capi/fuzz_caller.h"
#include <algorithm>

namespace earshot::capi_fuzz {
namespace {

const std::vector<std::string> kNames = {
    "a", "floor", "ceiling", "source1", "listener1", "brick-painted", "", "wall 0"};
const std::vector<std::string> kPatterns = {"*", "floor", "w*", "[a-f]*", "[", "?", ""};
const std::vector<std::string> kFiles = {
    "none.obj", "", "/", "none.gltf", "none", ".", "none.materials.json"};

template <typename T>
std::size_t struct_size(Caller& c, const T&) {
    if (c.chance(0.02)) {
        c.wrong = true;
        return c.chance(0.5) ? 0 : sizeof(T) + 1 + c.count(1000);
    }
    return sizeof(T);
}

/// The number of items of a scene; 0 if the handle is none.
std::size_t count_of(es_scene scene, std::int32_t item) {
    size_t count = 0;
    return es_scene_count(scene, item, &count) == ES_OK ? count : 0;
}

es_status load(Caller& c) {
    es_load_options options;
    es_load_options_init(&options, sizeof options);
    options.struct_size = struct_size(c, options);
    options.units = c.text({"m", "mm"}, true);
    options.up = c.choice(2);
    options.allow_outside = c.flag();
    options.read_materials = c.flag();
    es_scene scene = 0;
    const char* file = c.text(kFiles);
    return kept(c, es_scene_load(file, &options, c.out(scene)), scene);
}

es_status create(Caller& c) {
    es_scene_arrays arrays;
    es_scene_arrays_init(&arrays, sizeof arrays);
    arrays.struct_size = struct_size(c, arrays);
    arrays.vertex_count = c.count(12);
    arrays.triangle_count = arrays.vertex_count == 0 ? 0 : c.count(12);
    arrays.vertices = c.points(arrays.vertex_count);
    arrays.triangles = c.indices(3 * arrays.triangle_count, arrays.vertex_count);
    arrays.name = c.text(kNames, true);
    arrays.material_count = c.count(3);
    std::vector<const char*> names;
    for (std::size_t i = 0; i < arrays.material_count; ++i) {
        names.push_back(c.text(kNames));
    }
    arrays.material_names = names.empty() ? nullptr : names.data();
    if (c.chance(0.5)) {
        arrays.material_of_triangle =
            c.indices(arrays.triangle_count, std::max<std::size_t>(arrays.material_count, 1), true);
    }
    if (c.chance(0.05)) {
        arrays.vertex_count = static_cast<std::size_t>(-1) / (1 + c.count(3));
        c.wrong = true;
    }
    es_scene scene = 0;
    return kept(c, es_scene_create(&arrays, c.out(scene)), scene);
}

es_status create_shoebox(Caller& c) {
    double size[3];
    for (double& side : size) {
        side = c.number(1e-6, 1e9, {2.0, 6.0});
    }
    es_scene scene = 0;
    return kept(c, es_scene_create_shoebox(size, c.out(scene)), scene);
}

es_status create_extruded(Caller& c) {
    const std::size_t corners = c.count(7);  // many of these plans cross themselves
    const double* plan = c.values(2 * corners, -4.0, 4.0);
    c.wrong = c.wrong || corners < 3;
    const double height = c.number(1e-6, 1e9, {2.0, 3.0});
    es_scene scene = 0;
    return kept(c, es_scene_create_extruded(plan, corners, height, c.out(scene)), scene);
}

es_status copy(Caller& c) {
    es_scene other = 0;
    const es_scene scene = c.handle(ES_KIND_SCENE);
    return kept(c, es_scene_copy(scene, c.out(other)), other);
}

es_status contents(Caller& c) {
    const es_scene scene = c.handle(ES_KIND_SCENE);
    size_t count = 0;
    const char* name = nullptr;
    uint32_t index = 0;
    switch (c.below(4)) {
        case 0: {
            const std::int32_t item = c.choice(6);
            return es_scene_count(scene, item, c.out(count));
        }
        case 1: {
            const std::int32_t named = c.choice(4);
            const std::size_t at = c.index(count_of(scene, named));
            return es_scene_item_name(scene, named, at, c.out(name));
        }
        case 2: {
            const std::int32_t named = c.choice(4);
            const char* wanted = c.text(kNames);
            return es_scene_find(scene, named, wanted, c.out(index));
        }
        default:
            return es_scene_name(scene, c.out(name));
    }
}

es_status geometry(Caller& c) {
    const es_scene scene = c.handle(ES_KIND_SCENE);
    const std::size_t vertices = count_of(scene, ES_VERTICES);
    double lower[3], duration = 0.0;
    const uint32_t *triangles = nullptr, *materials = nullptr, *meshes = nullptr;
    size_t count = 0;
    switch (c.below(5)) {
        case 0: {
            const double time = c.number(-1e12, 1e12);
            return es_scene_extent(scene, time, c.out(lower[0]), c.out(lower[0]));
        }
        case 1: {
            const double time = c.number(-1e12, 1e12);
            double* room = c.room(3 * vertices, vertices == 0);
            return es_scene_positions(scene, time, room, vertices);
        }
        case 2: {
            const es_status status =
                es_scene_triangles(scene, &triangles, &materials, &meshes, c.out(count));
            for (std::size_t i = 0; status == ES_OK && i < count; ++i) {
                c.wrong = c.wrong || triangles[3 * i] >= vertices ||
                          meshes[i] >= count_of(scene, ES_MESHES) ||
                          materials[i] >= count_of(scene, ES_MATERIALS);
            }
            return status;
        }
        case 3: {
            const std::size_t given = c.chance(0.9) ? vertices : vertices + 1;
            c.wrong = c.wrong || given != vertices;
            const double* positions = c.points(given);
            return es_scene_set_positions(scene, positions, given);
        }
        default:
            return es_scene_duration(scene, c.out(duration));
    }
}

es_status messages(Caller& c) {
    es_messages list = 0;
    size_t count = 0;
    const char *subject = nullptr, *text = nullptr;
    switch (c.below(4)) {
        case 0: {
            const es_scene scene = c.handle(ES_KIND_SCENE);
            return kept(c, es_scene_warnings(scene, c.out(list)), list);
        }
        case 1: {
            const es_scene scene = c.handle(ES_KIND_SCENE);
            const double time = c.number(-1e12, 1e12);
            return kept(c, es_scene_check(scene, time, c.out(list)), list);
        }
        case 2: {
            list = c.handle(ES_KIND_MESSAGES);
            return es_messages_count(list, c.out(count));
        }
        default: {
            list = c.handle(ES_KIND_MESSAGES);
            es_messages_count(list, &count);
            const std::size_t index = c.index(count);
            return es_messages_get(list, index, c.out(subject), c.out(text));
        }
    }
}

es_material material(Caller& c, double (&values)[3]) {
    es_material data;
    es_material_init(&data, sizeof data);
    data.struct_size = struct_size(c, data);
    values[0] = c.number(0.0, 1.0, {0.2, 1.0});
    values[1] = c.number(0.0, 1.0);
    values[2] = c.number(0.0, 1.0, {0.0, 0.2});
    data.absorption = &values[0];
    data.scattering = &values[1];
    data.transmission = &values[2];
    data.one_sided = c.flag();
    return data;
}

es_status assign(Caller& c) {
    const es_scene scene = c.handle(ES_KIND_SCENE);
    double values[3];
    size_t matches = 0;
    switch (c.below(4)) {
        case 0: {
            const char* pattern = c.text(kPatterns);
            const es_material data = material(c, values);
            return es_scene_assign(scene, pattern, &data, &matches);
        }
        case 1: {
            const char* pattern = c.text(kPatterns);
            const char* name = c.text({"brick-painted", "no-such"});
            return es_scene_assign_library(scene, pattern, name, nullptr);
        }
        case 2: {
            const char* file = c.text(kFiles);
            return es_scene_assign_file(scene, file);
        }
        default: {
            const std::size_t index = c.index(count_of(scene, ES_MATERIALS));
            const es_material data = material(c, values);
            return es_scene_set_material(scene, index, &data);
        }
    }
}

es_status coefficients(Caller& c) {
    const double* hz = nullptr;
    const char* name = nullptr;
    size_t count = 0;
    if (c.below(3) == 0) {
        const std::int32_t bands = c.choice(2);
        return es_bands_nominal(bands, c.out(hz), c.out(count));
    }
    if (c.below(2) == 0) {
        const std::size_t index = c.index(es_library_count());
        return es_library_get(index, &name, nullptr, nullptr);
    }
    const bool of_library = c.below(2) == 0;
    const es_scene scene = of_library ? 0 : c.handle(ES_KIND_SCENE);
    const std::size_t index =
        c.index(of_library ? es_library_count() : count_of(scene, ES_MATERIALS));
    const std::int32_t coefficient = c.choice(3), bands = c.choice(2);
    const std::size_t needed = bands == 1 ? 31 : 10;
    const std::size_t given = c.chance(0.95) ? needed : c.count(40);
    c.wrong = c.wrong || given != needed;
    double* values = c.room(given, given == 0);
    return of_library ? es_library_coefficients(index, coefficient, bands, values, given)
                      : es_scene_coefficients(scene, index, coefficient, bands, values, given);
}

es_status add(Caller& c) {
    const es_scene scene = c.handle(ES_KIND_SCENE);
    const std::int32_t item = c.choice(2);
    std::size_t count = 1 + c.count(2);
    if (count_of(scene, item) > 6 && (item == 0 || item == 1)) {
        return es_scene_remove(scene, item, ES_ALL);
    }
    const double* positions = c.points(count, 2.0);
    if (c.chance(0.02)) {
        count = static_cast<std::size_t>(-1) >> c.count(20);
        c.wrong = true;
    }
    uint32_t first = 0;
    return es_scene_add(scene, item, positions, nullptr, count, &first);
}

es_status change_emitter(Caller& c) {
    const es_scene scene = c.handle(ES_KIND_SCENE);
    const std::int32_t item = c.choice(2);
    const std::size_t index = c.index(count_of(scene, item));
    // Not ES_ALL, which is right in some of these calls.
    const auto number = static_cast<uint32_t>(std::min<std::size_t>(index, 0xFFFFFFFEU));
    es_pose pose;
    switch (c.below(4)) {
        case 0:
            return es_scene_remove(scene, item, number);
        case 1: {
            const double* position = c.points(1, 2.0);
            return es_scene_set_position(scene, item, number, position);
        }
        case 2: {
            const double* point = c.points(1, 2.0, true);
            return es_scene_set_look_at(scene, item, number, point);
        }
        default: {
            const double time = c.number(-1e12, 1e12);
            return es_scene_pose(scene, item, index, time, c.out(pose));
        }
    }
}

es_status change_directivity(Caller& c) {
    const es_scene scene = c.handle(ES_KIND_SCENE);
    const std::size_t index = c.index(count_of(scene, ES_SOURCES));
    const auto number = static_cast<uint32_t>(std::min<std::size_t>(index, 0xFFFFFFFEU));
    if (c.below(2) == 0) {
        const char* name = c.text({"omni", "cardioid", "no-such", "none.csv"});
        return es_scene_set_directivity(scene, number, name);
    }
    const double frequencies[] = {500.0, 1000.0}, azimuths[] = {0.0, 120.0, 240.0},
                 elevations[] = {0.0};
    const double* levels = c.values(6, -20.0, 0.0, false, 1e308);
    const std::size_t count = c.chance(0.95) ? 1 : 0;
    c.wrong = c.wrong || count == 0;
    return es_scene_set_directivity_table(
        scene, number, frequencies, 2, azimuths, 3, elevations, count, levels);
}

es_status release(Caller& c) {
    if (c.chance(0.2)) {
        c.wrong = true;
        return es_release(0xABCDEF0123456789ULL + c.count(1000));
    }
    return es_release(c.take());
}

}  // namespace

const std::vector<WeightedCall>& scene_calls() {
    static const std::vector<WeightedCall> calls = {{"load", load, 3},
                                                    {"create", create, 20},
                                                    {"create_shoebox", create_shoebox, 10},
                                                    {"create_extruded", create_extruded, 10},
                                                    {"copy", copy, 5},
                                                    {"contents", contents, 20},
                                                    {"geometry", geometry, 20},
                                                    {"messages", messages, 20},
                                                    {"assign", assign, 20},
                                                    {"coefficients", coefficients, 15},
                                                    {"add", add, 30},
                                                    {"change_emitter", change_emitter, 30},
                                                    {"change_directivity", change_directivity, 8},
                                                    {"release", release, 5}};
    return calls;
}

}  // namespace earshot::capi_fuzz
