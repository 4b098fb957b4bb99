// SPDX-License-Identifier: MIT
// Sources and listeners of a scene.
#include "earshot/capi/internal/checks.h"
#include "earshot/capi/internal/scene_object.h"
#include "earshot/io/directivity_file.h"

#include <algorithm>
#include <iterator>
#include <set>
#include <string>

namespace earshot::capi {
namespace {

using propagation::Emitter;

/// Calls `change` for the emitter of that index, for all of ES_ALL.
template <typename Change>
void change_emitters(std::vector<Emitter>& emitters, std::uint32_t index, const Change& change) {
    if (index == ES_ALL) {
        for (Emitter& emitter : emitters) {
            change(emitter);
        }
        return;
    }
    require_index(index, emitters.size(), "index");
    change(emitters[index]);
}

/// "source7", or the next number that is free.
std::string free_name(const char* role, std::size_t number, const std::set<std::string>& taken) {
    std::string name = role + std::to_string(number);
    while (taken.count(name) > 0) {
        name = role + std::to_string(++number);
    }
    return name;
}

void add_emitters(std::vector<Emitter>& emitters,
                  const char* role,
                  std::span<const geometry::Vec3> positions,
                  const char* const* names) {
    std::set<std::string> taken;
    for (const Emitter& emitter : emitters) {
        taken.insert(emitter.name);
    }
    std::vector<Emitter> added;
    for (std::size_t i = 0; i < positions.size(); ++i) {
        std::string name(text_or(names == nullptr ? nullptr : names[i], "", "names"));
        if (name.empty()) {
            name = free_name(role, emitters.size() + i + 1, taken);
        }
        if (!taken.insert(name).second) {
            throw Error(std::string(role) + " \"" + name + "\"",
                        "is there already, and results are told by name",
                        std::string("give each ") + role + " a name of its own");
        }
        added.push_back({.name = std::move(name), .node = -1, .position = positions[i]});
    }
    emitters.insert(emitters.end(),
                    std::make_move_iterator(added.begin()),
                    std::make_move_iterator(added.end()));
}

propagation::DirectivityTable table_of(std::span<const double> frequencies,
                                       std::span<const double> azimuths,
                                       std::span<const double> elevations,
                                       const double* levels_db) {
    constexpr std::size_t kMaxLevels = std::size_t{1} << 28U;
    std::size_t count = 1;
    for (const std::size_t size : {frequencies.size(), azimuths.size(), elevations.size()}) {
        if (size == 0 || count > kMaxLevels / size) {
            fail_argument("levels_db",
                          size == 0 ? "are none" : "are more than 2^28",
                          "give a level per frequency, elevation and azimuth");
        }
        count *= size;
    }
    const auto levels = require_array(levels_db, count, "levels_db");
    return {.frequencies_hz = {frequencies.begin(), frequencies.end()},
            .azimuths = {azimuths.begin(), azimuths.end()},
            .elevations = {elevations.begin(), elevations.end()},
            .levels_db = {levels.begin(), levels.end()}};
}

template <typename T>
void copy_vector(const geometry::Vec3& from, T& to) {
    for (int axis = 0; axis < 3; ++axis) {
        to[axis] = from[axis];
    }
}

}  // namespace

const std::vector<Emitter>& emitters_of(const propagation::Scene& scene, std::int32_t item) {
    if (item != ES_SOURCES && item != ES_LISTENERS) {
        fail_argument("item", "is " + std::to_string(item), "give ES_SOURCES or ES_LISTENERS");
    }
    return item == ES_SOURCES ? scene.sources : scene.listeners;
}

std::vector<Emitter>& emitters_of(propagation::Scene& scene, std::int32_t item) {
    return const_cast<std::vector<Emitter>&>(emitters_of(std::as_const(scene), item));
}

void set_position(propagation::Scene& scene,
                  std::int32_t item,
                  std::uint32_t index,
                  const geometry::Vec3& position) {
    std::vector<Emitter>& emitters = emitters_of(scene, item);
    require_index(index, emitters.size(), "index");
    emitters[index].node = -1;
    emitters[index].position = position;
}

void set_look_at(propagation::Scene& scene,
                 std::int32_t item,
                 std::uint32_t index,
                 const double* point) {
    std::optional<geometry::Vec3> target;
    if (point != nullptr) {
        target = require_point(point, "point");
    }
    change_emitters(
        emitters_of(scene, item), index, [&](Emitter& emitter) { emitter.looks_at = target; });
}

}  // namespace earshot::capi

using namespace earshot;
using namespace earshot::capi;

es_status es_scene_add(es_scene scene,
                       int32_t item,
                       const double* positions,
                       const char* const* names,
                       size_t count,
                       uint32_t* first) {
    return call(__func__, [&] {
        const Changing<SceneObject> object(scene, "scene");
        constexpr std::size_t kMaxEmitters = 1U << 24U;
        auto& emitters = emitters_of(object->loaded.scene, item);
        if (count > kMaxEmitters - std::min(emitters.size(), kMaxEmitters)) {
            fail_argument("count", "makes more than 2^24 of them", "add fewer");
        }
        const std::size_t before = emitters.size();
        add_emitters(emitters,
                     item == ES_SOURCES ? "source" : "listener",
                     require_points(positions, count, "positions"),
                     names);
        if (first != nullptr) {
            *first = static_cast<uint32_t>(before);
        }
    });
}

es_status es_scene_remove(es_scene scene, int32_t item, uint32_t index) {
    return call(__func__, [&] {
        const Changing<SceneObject> object(scene, "scene");
        auto& emitters = emitters_of(object->loaded.scene, item);
        if (index == ES_ALL) {
            emitters.clear();
            return;
        }
        require_index(index, emitters.size(), "index");
        emitters.erase(emitters.begin() + index);
    });
}

es_status es_scene_set_position(es_scene scene,
                                int32_t item,
                                uint32_t index,
                                const double position[3]) {
    return call(__func__, [&] {
        const Changing<SceneObject> object(scene, "scene");
        set_position(object->loaded.scene, item, index, require_point(position, "position"));
    });
}

es_status es_scene_set_look_at(es_scene scene, int32_t item, uint32_t index, const double* point) {
    return call(__func__, [&] {
        const Changing<SceneObject> object(scene, "scene");
        set_look_at(object->loaded.scene, item, index, point);
    });
}

es_status es_scene_set_directivity(es_scene scene, uint32_t source, const char* name) {
    return call(__func__, [&] {
        const Changing<SceneObject> object(scene, "scene");
        const auto directivity =
            io::directivity_named(std::string(require_text(name, "name")), "", __func__);
        change_emitters(object->loaded.scene.sources, source, [&](propagation::Emitter& emitter) {
            emitter.directivity = directivity;
        });
    });
}

es_status es_scene_set_directivity_table(es_scene scene,
                                         uint32_t source,
                                         const double* frequencies,
                                         size_t frequency_count,
                                         const double* azimuths,
                                         size_t azimuth_count,
                                         const double* elevations,
                                         size_t elevation_count,
                                         const double* levels_db) {
    return call(__func__, [&] {
        const Changing<SceneObject> object(scene, "scene");
        const auto directivity = propagation::Directivity::tabulated(
            table_of(require_array(frequencies, frequency_count, "frequencies"),
                     require_array(azimuths, azimuth_count, "azimuths"),
                     require_array(elevations, elevation_count, "elevations"),
                     levels_db));
        change_emitters(object->loaded.scene.sources, source, [&](propagation::Emitter& emitter) {
            emitter.directivity = directivity;
        });
    });
}

es_status es_scene_pose(es_scene scene, int32_t item, size_t index, double time, es_pose* pose) {
    return call(__func__, [&] {
        const Reading<SceneObject> object(scene, "scene");
        const auto& emitters = emitters_of(object->loaded.scene, item);
        require(pose, "pose");
        require_time(time, "time");
        require_index(index, emitters.size(), "index");
        const propagation::Pose found = object->loaded.scene.pose_at(emitters[index], time);
        copy_vector(found.position, pose->position);
        copy_vector(found.front, pose->front);
        copy_vector(found.left, pose->left);
        copy_vector(found.up, pose->up);
    });
}
