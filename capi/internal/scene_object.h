// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/error.h"
#include "earshot/capi/internal/object_table.h"
#include "earshot/geometry/types.h"
#include "earshot/io/scene_file.h"
#include "earshot/propagation/plausibility.h"
#include "earshot/propagation/scene.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace earshot::capi {

struct SceneObject : ObjectOf<ES_KIND_SCENE> {
    io::LoadedScene loaded;
    /// How its file was read, and whether another way can be asked for.
    propagation::ReadAs read_as{};
    bool has_unit_option = false;
    std::string simplification_json{};  ///< of a scene that es_scene_simplify() has made
};

struct MessagesObject : ObjectOf<ES_KIND_MESSAGES> {
    explicit MessagesObject(Warnings the_list) : list(std::move(the_list)) {}
    Warnings list;
};

/// A new handle of messages.
es_messages publish_messages(Warnings list);

/// The sources or listeners of a scene. Throws Failure for other items.
std::vector<propagation::Emitter>& emitters_of(propagation::Scene& scene, std::int32_t item);
const std::vector<propagation::Emitter>& emitters_of(const propagation::Scene& scene,
                                                     std::int32_t item);

/// Change the emitter of that index; set_look_at() all of them for ES_ALL.
void set_position(propagation::Scene& scene,
                  std::int32_t item,
                  std::uint32_t index,
                  const geometry::Vec3& position);
void set_look_at(propagation::Scene& scene,
                 std::int32_t item,
                 std::uint32_t index,
                 const double* point);

/// Throws Error if a scene has no triangle.
void require_triangles_of(const propagation::Scene& scene);

/// An instant of an animation.
void require_time(double time, const char* argument);

}  // namespace earshot::capi
