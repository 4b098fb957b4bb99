// SPDX-License-Identifier: MIT
#include "earshot/propagation/scene.h"

#include "earshot/base/digest.h"
#include "earshot/base/random.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace earshot::propagation {

using geometry::Vec3;

namespace {

std::uint64_t emitter_key(std::span<const Emitter> emitters, std::size_t index) {
    const std::string& name = emitters[index].name;
    Digest digest;
    digest.add_bytes(std::as_bytes(std::span(name)));
    const std::uint64_t earlier = static_cast<std::uint64_t>(
        std::count_if(emitters.begin(),
                      emitters.begin() + static_cast<std::ptrdiff_t>(index),
                      [&](const Emitter& emitter) { return emitter.name == name; }));
    digest.add(earlier);
    return digest.value();
}

}  // namespace

std::uint64_t pair_key(const Scene& scene, std::size_t source, std::size_t listener) {
    return random_bits(
        emitter_key(scene.sources, source), emitter_key(scene.listeners, listener), 0);
}

Vec3 Scene::position_at(const Emitter& emitter, double t) const {
    if (emitter.node < 0) {
        return emitter.position;
    }
    return geometry::transform_point(mesh.node_transform(emitter.node, t), emitter.position);
}

Pose Scene::pose_at(const Emitter& emitter, double t) const {
    const Vec3 position = position_at(emitter, t);
    constexpr Vec3 kUp(0.0, 1.0, 0.0);
    if (emitter.looks_at) {
        return pose_towards(position, *emitter.looks_at - position, kUp);
    }
    if (emitter.node < 0) {
        return {.position = position};
    }
    const glm::dmat4 matrix = mesh.node_transform(emitter.node, t);
    return pose_towards(position, Vec3(-matrix[2]), Vec3(matrix[1]));
}

Pose pose_towards(const Vec3& position, const Vec3& front, const Vec3& up) {
    const auto has_direction = [](const Vec3& v) {
        const double length = glm::length(v);
        return length > 0.0 && std::isfinite(length);
    };
    Pose pose{.position = position};
    if (!has_direction(front)) {
        return pose;
    }
    pose.front = glm::normalize(front);
    constexpr double kParallel = 1e-9;
    Vec3 left = has_direction(up) ? glm::cross(glm::normalize(up), pose.front) : Vec3(0.0);
    if (glm::length(left) < kParallel) {
        // Straight up or down: above is what was in front, or behind.
        left = glm::cross(Vec3(0.0, 0.0, pose.front.y > 0.0 ? 1.0 : -1.0), pose.front);
    }
    if (glm::length(left) < kParallel) {
        left = glm::cross(Vec3(0.0, 1.0, 0.0), pose.front);
    }
    pose.left = glm::normalize(left);
    pose.up = glm::cross(pose.front, pose.left);
    return pose;
}

}  // namespace earshot::propagation
