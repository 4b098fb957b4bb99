// SPDX-License-Identifier: MIT
#include "earshot/collision/world.h"

#include "earshot/base/assert.h"
#include "earshot/earshot.h"

#include <algorithm>
#include <cstdint>
#include <span>

namespace earshot {

struct World::State {
    explicit State(const Room& room) : animated(room.scene.mesh) {
        // Vertices are numbered part after part; a part is a mesh of its own.
        std::vector<std::vector<geometry::Triangle>> triangles(animated.parts().size());
        for (const geometry::Part& part : animated.parts()) {
            names.push_back(part.node >= 0
                                ? animated.nodes()[static_cast<std::size_t>(part.node)].name
                                : std::string());
            first_vertex.push_back(first_vertex.back() + part.positions.size());
        }
        for (const geometry::Triangle& triangle : animated.triangles()) {
            const auto end =
                std::upper_bound(first_vertex.begin(), first_vertex.end(), triangle[0]);
            const auto part = static_cast<std::size_t>(end - first_vertex.begin()) - 1;
            const auto first = static_cast<geometry::VertexId>(first_vertex[part]);
            triangles[part].push_back(
                {triangle[0] - first, triangle[1] - first, triangle[2] - first});
        }
        for (std::size_t part = 0; part < triangles.size(); ++part) {
            world.add_mesh(triangles[part], first_vertex[part + 1] - first_vertex[part]);
        }
    }

    geometry::AnimatedMesh animated;
    std::vector<std::string> names;            // of the parts
    std::vector<std::size_t> first_vertex{0};  // of the parts, and the end
    collision::World world;
};

World::World(const Room& room) : state_(std::make_unique<State>(room)) {}
World::~World() = default;
World::World(World&&) noexcept = default;
World& World::operator=(World&&) noexcept = default;

std::vector<collision::Contact> World::contacts(double begin, double end) {
    const std::vector<Vec3> from = state_->animated.positions_at(begin);
    const std::vector<Vec3> to = state_->animated.positions_at(end);
    std::vector<std::uint8_t> moves;
    for (std::uint32_t mesh = 0; mesh < state_->names.size(); ++mesh) {
        const std::size_t first = state_->first_vertex[mesh];
        const std::size_t count = state_->first_vertex[mesh + 1] - first;
        const auto before = std::span(from).subspan(first, count);
        const auto after = std::span(to).subspan(first, count);
        moves.push_back(std::equal(before.begin(), before.end(), after.begin()) ? 0 : 1);
        state_->world.update(mesh, before, after);
    }
    const auto one_moves = [&](std::uint32_t a, std::uint32_t b) {
        return moves[a] != 0 || moves[b] != 0;
    };
    return state_->world.contacts({.filter = one_moves});
}

double World::duration() const noexcept {
    return state_->animated.duration();
}

const std::string& World::name_of(std::uint32_t mesh) const {
    EARSHOT_ASSERT(mesh < state_->names.size());
    return state_->names[mesh];
}

}  // namespace earshot
