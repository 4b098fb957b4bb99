// SPDX-License-Identifier: MIT
#include "earshot/bvh/instances.h"

#include "earshot/base/assert.h"
#include "earshot/base/error.h"
#include "earshot/bvh/quality.h"
#include "earshot/geometry/vector.h"

#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

namespace earshot::bvh {

using geometry::Aabb;
using geometry::Vec3;

namespace {

void assign_transform(Instances::Instance& instance, const glm::dmat4& transform) {
    const glm::dmat3 linear(transform);
    const Vec3 translation(transform[3]);
    const glm::dmat3 inverse = glm::inverse(linear);
    if (!geometry::is_finite(linear) || !geometry::is_finite(inverse) ||
        !geometry::is_finite(translation)) {
        throw Error("transform of an instance",
                    "is not a finite matrix with an inverse",
                    "scale by more than 0");
    }
    instance.linear = linear;
    instance.inverse_linear = inverse;
    instance.translation = translation;
}

/// The box of a part in the world, by interval arithmetic (Arvo 1990), rounded outward.
Aabb world_box(const Aabb& box, const glm::dmat3& linear, const Vec3& translation) {
    // Three products and three sums are off by less than 6 units of 2^-53 of their magnitudes.
    constexpr double kRounding = 0x1p-50;
    Aabb world;
    for (int axis = 0; axis < 3; ++axis) {
        double low = translation[axis];
        double high = translation[axis];
        double magnitude = std::abs(translation[axis]);
        for (int k = 0; k < 3; ++k) {
            const auto from = static_cast<std::size_t>(k);
            const double one = linear[k][axis] * static_cast<double>(box.lower[from]);
            const double other = linear[k][axis] * static_cast<double>(box.upper[from]);
            low += std::min(one, other);
            high += std::max(one, other);
            magnitude += std::max(std::abs(one), std::abs(other));
        }
        const auto to = static_cast<std::size_t>(axis);
        world.lower[to] = geometry::round_down(low - kRounding * magnitude);
        world.upper[to] = geometry::round_up(high + kRounding * magnitude);
    }
    return world;
}

/// The lowest free id, out of a heap with the lowest on top; a new entry if there is none.
template <class Entry>
std::uint32_t acquire_id(std::vector<std::uint32_t>& free, std::vector<Entry>& entries) {
    if (free.empty()) {
        entries.emplace_back();
        return static_cast<std::uint32_t>(entries.size() - 1);
    }
    std::pop_heap(free.begin(), free.end(), std::greater<>());
    const std::uint32_t id = free.back();
    free.pop_back();
    return id;
}

void release_id(std::vector<std::uint32_t>& free, std::uint32_t id) {
    free.push_back(id);
    std::push_heap(free.begin(), free.end(), std::greater<>());
}

}  // namespace

PartId Instances::add_part(const geometry::MeshView& mesh,
                           const BuildOptions& options,
                           Executor& executor) {
    const Tree tree = Tree::build(triangle_boxes(mesh, executor), options, executor);
    WideTree wide = WideTree::build(tree, mesh, executor);
    const PartId id = acquire_id(free_parts_, parts_);
    parts_[id] = {.mesh = mesh, .tree = std::move(wide), .exists = true};
    return id;
}

void Instances::refit_part(PartId part, const geometry::MeshView& mesh, Executor& executor) {
    EARSHOT_ASSERT(part < parts_.size() && parts_[part].exists);
    EARSHOT_ASSERT(mesh.triangles.size() == parts_[part].tree.triangle_count());
    parts_[part].mesh = mesh;
    parts_[part].tree.refit(mesh, executor);
    note(Change::moved);
}

void Instances::remove_part(PartId part) {
    EARSHOT_ASSERT(part < parts_.size() && parts_[part].exists && parts_[part].instances == 0);
    parts_[part] = {};
    release_id(free_parts_, part);
}

InstanceId Instances::add_instance(PartId part, const glm::dmat4& transform) {
    EARSHOT_ASSERT(part < parts_.size() && parts_[part].exists);
    Instance instance{.part = part};
    assign_transform(instance, transform);
    instance.id = acquire_id(free_instances_, instances_);
    instances_[instance.id] = instance;
    ++parts_[part].instances;
    note(Change::added_or_removed);
    return instance.id;
}

void Instances::set_transform(InstanceId instance, const glm::dmat4& transform) {
    EARSHOT_ASSERT(instance < instances_.size() && instances_[instance]);
    assign_transform(*instances_[instance], transform);
    note(Change::moved);
}

void Instances::remove_instance(InstanceId instance) {
    EARSHOT_ASSERT(instance < instances_.size() && instances_[instance]);
    --parts_[instances_[instance]->part].instances;
    instances_[instance].reset();
    release_id(free_instances_, instance);
    note(Change::added_or_removed);
}

void Instances::update(Executor& executor) {
    constexpr double kMaxSahCostGrowth = 1.4;  // Lauterbach 2010
    if (change_ == Change::none) {
        return;
    }
    active_instances_.clear();
    std::vector<Aabb> boxes;
    for (const auto& instance : instances_) {
        if (instance && parts_[instance->part].tree.triangle_count() > 0) {
            const Aabb& box = parts_[instance->part].tree.box();
            boxes.push_back(world_box(box, instance->linear, instance->translation));
            active_instances_.push_back(*instance);
            active_instances_.back().box = boxes.back();
        }
    }
    bool needs_rebuild = change_ == Change::added_or_removed;
    if (change_ == Change::moved) {
        top_level_.refit(boxes, executor);
        needs_rebuild = sah_cost(top_level_) > kMaxSahCostGrowth * built_sah_cost_;
    }
    if (needs_rebuild) {
        top_level_ = Tree::build(boxes, {.max_leaf_size = 1}, executor);
        built_sah_cost_ = sah_cost(top_level_);
    }
    change_ = Change::none;
}

}  // namespace earshot::bvh
