// SPDX-License-Identifier: MIT
#include "earshot/bvh/deformable_bvh.h"
#include "earshot/earshot.h"
#include "earshot/visibility/line_of_sight.h"

namespace earshot {

struct Sight::State {
    State(const Room& room, double time)
        : animated(room.scene.mesh), positions(animated.positions_at(time)), tree(mesh()) {}

    geometry::MeshView mesh() const { return {positions, animated.triangles()}; }

    geometry::AnimatedMesh animated;
    std::vector<Vec3> positions;
    bvh::DeformableBvh tree;
};

Sight::Sight(const Room& room, double time) : state_(std::make_unique<State>(room, time)) {}
Sight::~Sight() = default;
Sight::Sight(Sight&&) noexcept = default;
Sight& Sight::operator=(Sight&&) noexcept = default;

void Sight::set_time(double time) {
    state_->animated.positions_at(time, state_->positions);
    state_->tree.update(state_->mesh());
}

bool Sight::visible(const Vec3& a, const Vec3& b) const {
    return visibility::visible(state_->tree.view(), {a, b});
}

}  // namespace earshot
