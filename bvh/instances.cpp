// SPDX-License-Identifier: MIT
#include "earshot/bvh/instances.h"

#include "earshot/base/assert.h"
#include "earshot/base/error.h"
#include "earshot/bvh/quality.h"

#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

namespace earshot::bvh {

using geometry::Aabb;
using geometry::Vec3;

namespace {

bool is_finite(const glm::dmat3& matrix) noexcept {
    for (int column = 0; column < 3; ++column) {
        for (int row = 0; row < 3; ++row) {
            if (!std::isfinite(matrix[column][row])) {
                return false;
            }
        }
    }
    return true;
}

void place(Instances::Instance& instance, const glm::dmat4& placement) {
    const glm::dmat3 linear(placement);
    const Vec3 origin(placement[3]);
    const glm::dmat3 inverse = glm::inverse(linear);
    if (!is_finite(linear) || !is_finite(inverse) ||
        !is_finite(glm::dmat3(origin, origin, origin))) {
        throw Error("placement", "is not a finite matrix with an inverse", "scale by more than 0");
    }
    instance.linear = linear;
    instance.inverse = inverse;
    instance.origin = origin;
}

/// Holds every point of the part's box where the placement puts it.
Aabb world_box(const Aabb& box, const glm::dmat3& linear, const Vec3& origin) {
    // Three products and three sums are off by less than 6 units of 2^-53 of their magnitudes.
    constexpr double kRounding = 0x1p-50;
    Aabb placed;
    for (int axis = 0; axis < 3; ++axis) {
        double low = origin[axis];
        double high = origin[axis];
        double size = std::abs(origin[axis]);
        for (int k = 0; k < 3; ++k) {
            const auto from = static_cast<std::size_t>(k);
            const double one = linear[k][axis] * static_cast<double>(box.lower[from]);
            const double other = linear[k][axis] * static_cast<double>(box.upper[from]);
            low += std::min(one, other);
            high += std::max(one, other);
            size += std::max(std::abs(one), std::abs(other));
        }
        const auto to = static_cast<std::size_t>(axis);
        placed.lower[to] = geometry::round_down(low - kRounding * size);
        placed.upper[to] = geometry::round_up(high + kRounding * size);
    }
    return placed;
}

/// The lowest index that is free, out of a heap with the lowest on top; one more entry if none is.
template <class Entry>
std::uint32_t take_index(std::vector<std::uint32_t>& free, std::vector<Entry>& entries) {
    if (free.empty()) {
        entries.emplace_back();
        return static_cast<std::uint32_t>(entries.size() - 1);
    }
    std::pop_heap(free.begin(), free.end(), std::greater<>());
    const std::uint32_t index = free.back();
    free.pop_back();
    return index;
}

void give_back(std::vector<std::uint32_t>& free, std::uint32_t index) {
    free.push_back(index);
    std::push_heap(free.begin(), free.end(), std::greater<>());
}

}  // namespace

PartId Instances::add_part(const geometry::MeshView& mesh,
                           const BuildOptions& options,
                           Executor& executor) {
    const Tree tree = Tree::build(triangle_boxes(mesh, executor), options, executor);
    WideTree wide = WideTree::build(tree, mesh, executor);
    const PartId id = take_index(free_parts_, parts_);
    parts_[id] = {.mesh = mesh, .tree = std::move(wide), .exists = true};
    return id;
}

void Instances::refit_part(PartId part, const geometry::MeshView& mesh, Executor& executor) {
    EARSHOT_ASSERT(part < parts_.size() && parts_[part].exists);
    EARSHOT_ASSERT(mesh.triangles.size() == parts_[part].tree.triangles());
    parts_[part].mesh = mesh;
    parts_[part].tree.refit(mesh, executor);
    note(Change::moved);
}

void Instances::remove_part(PartId part) {
    EARSHOT_ASSERT(part < parts_.size() && parts_[part].exists && parts_[part].instances == 0);
    parts_[part] = {};
    give_back(free_parts_, part);
}

InstanceId Instances::insert(PartId part, const glm::dmat4& placement) {
    EARSHOT_ASSERT(part < parts_.size() && parts_[part].exists);
    Instance instance{.part = part};
    place(instance, placement);
    instance.id = take_index(free_instances_, instances_);
    instances_[instance.id] = instance;
    ++parts_[part].instances;
    note(Change::replaced);
    return instance.id;
}

void Instances::move(InstanceId instance, const glm::dmat4& placement) {
    EARSHOT_ASSERT(instance < instances_.size() && instances_[instance]);
    place(*instances_[instance], placement);
    note(Change::moved);
}

void Instances::remove(InstanceId instance) {
    EARSHOT_ASSERT(instance < instances_.size() && instances_[instance]);
    --parts_[instances_[instance]->part].instances;
    instances_[instance].reset();
    give_back(free_instances_, instance);
    note(Change::replaced);
}

void Instances::update(Executor& executor) {
    constexpr double kMostAgeing = 1.4;
    if (change_ == Change::none) {
        return;
    }
    placed_.clear();
    std::vector<Aabb> boxes;
    for (const auto& instance : instances_) {
        if (instance && parts_[instance->part].tree.triangles() > 0) {
            const Aabb& box = parts_[instance->part].tree.box();
            boxes.push_back(world_box(box, instance->linear, instance->origin));
            placed_.push_back(*instance);
            placed_.back().box = boxes.back();
        }
    }
    bool is_rebuilt = change_ == Change::replaced;
    if (change_ == Change::moved) {
        upper_level_.refit(boxes, executor);
        is_rebuilt = sah_cost(upper_level_) > kMostAgeing * built_cost_;
    }
    if (is_rebuilt) {
        upper_level_ = Tree::build(boxes, {.leaf_size = 1}, executor);
        built_cost_ = sah_cost(upper_level_);
    }
    change_ = Change::none;
}

}  // namespace earshot::bvh
