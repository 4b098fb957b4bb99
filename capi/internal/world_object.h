// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/capi/internal/object_table.h"
#include "earshot/collision/world.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace earshot::capi {

struct WorldObject : ObjectOf<ES_KIND_WORLD> {
    struct Mesh {
        std::string name;
        std::size_t vertices = 0;
        bool of_scene = false;
        bool is_removed = false;
    };

    collision::World world;
    std::vector<Mesh> meshes;
};

/// Never changes.
struct ContactsObject : ObjectOf<ES_KIND_CONTACTS> {
    explicit ContactsObject(std::vector<es_contact> the_contacts)
        : contacts(std::move(the_contacts)) {}
    std::vector<es_contact> contacts;
};

/// Throws Failure unless the world has that mesh still.
const WorldObject::Mesh& require_mesh(const WorldObject& world,
                                      std::uint32_t mesh,
                                      const char* argument);

}  // namespace earshot::capi
