// SPDX-License-Identifier: MIT
#include "earshot/collision/world.h"

#include "earshot/base/assert.h"
#include "earshot/earshot.h"

#include <cstdint>

namespace earshot {

struct World::State {
    explicit State(const Room& room)
        : names(room.scene.mesh.mesh_names()), duration(room.scene.mesh.duration()) {
        world.add(room.scene.mesh);
    }

    std::vector<std::string> names;  // of the meshes
    double duration;
    collision::World world;
};

World::World(const Room& room) : state_(std::make_unique<State>(room)) {}
World::~World() = default;
World::World(World&&) noexcept = default;
World& World::operator=(World&&) noexcept = default;

std::vector<collision::Contact> World::contacts(double begin, double end) {
    state_->world.set_step(begin, end);
    std::vector<std::uint8_t> moves;
    for (std::uint32_t mesh = 0; mesh < state_->names.size(); ++mesh) {
        moves.push_back(state_->world.moves(mesh) ? 1 : 0);
    }
    const auto one_moves = [&](std::uint32_t a, std::uint32_t b) {
        return moves[a] != 0 || moves[b] != 0;
    };
    return state_->world.contacts({.filter = one_moves});
}

double World::duration() const noexcept {
    return state_->duration;
}

const std::string& World::name_of(std::uint32_t mesh) const {
    EARSHOT_ASSERT(mesh < state_->names.size());
    return state_->names[mesh];
}

}  // namespace earshot
