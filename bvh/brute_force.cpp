// SPDX-License-Identifier: MIT
#include "earshot/bvh/brute_force.h"

#include "earshot/geometry/intersect.h"

#include <algorithm>

namespace earshot::bvh::brute_force {
namespace {

// As max_abs_coordinate() of a tree over the same.
double max_abs_coordinate(const geometry::MeshView& mesh) noexcept {
    geometry::Aabb box;
    for (const geometry::Triangle& triangle : mesh.triangles) {
        for (const geometry::VertexId vertex : triangle) {
            box.include(mesh.positions[vertex]);
        }
    }
    return box.max_abs_coordinate();
}

double max_abs_coordinate(const Instances& instances) noexcept {
    geometry::Aabb box;
    for (const Instances::Instance& instance : instances.active_instances()) {
        box.include(instance.box);
    }
    return box.max_abs_coordinate();
}

std::optional<geometry::Hit> hit_of(const geometry::PreparedRay& ray,
                                    const geometry::MeshView& mesh,
                                    std::size_t i) noexcept {
    const auto [a, b, c] = geometry::corners(mesh, i);
    auto hit = ray.hit(a, b, c, ray.t_max());
    if (hit) {
        hit->triangle = static_cast<geometry::TriangleId>(i);
    }
    return hit;
}

}  // namespace

std::optional<geometry::Hit> closest_hit(const geometry::MeshView& mesh,
                                         const geometry::Ray& ray) noexcept {
    const geometry::PreparedRay prepared(ray, max_abs_coordinate(mesh));
    std::optional<geometry::Hit> best;
    for (std::size_t i = 0; i < mesh.triangles.size() && prepared.is_valid(); ++i) {
        const auto hit = hit_of(prepared, mesh, i);
        if (hit && (!best || hit->t < best->t)) {
            best = hit;
        }
    }
    return best;
}

std::vector<geometry::Hit> all_hits(const geometry::MeshView& mesh, const geometry::Ray& ray) {
    const geometry::PreparedRay prepared(ray, max_abs_coordinate(mesh));
    std::vector<geometry::Hit> hits;
    for (std::size_t i = 0; i < mesh.triangles.size() && prepared.is_valid(); ++i) {
        if (const auto hit = hit_of(prepared, mesh, i)) {
            hits.push_back(*hit);
        }
    }
    std::stable_sort(
        hits.begin(), hits.end(), [](const auto& a, const auto& b) { return a.t < b.t; });
    return hits;
}

bool occluded(const geometry::MeshView& mesh, const geometry::Segment& segment) noexcept {
    return std::any_of(
        mesh.triangles.begin(), mesh.triangles.end(), [&](const geometry::Triangle& triangle) {
            const auto [a, b, c] = geometry::corners(mesh.positions, triangle);
            return geometry::touches(segment, a, b, c);
        });
}

std::vector<geometry::ClosestPoint> closest_triangles(const geometry::MeshView& mesh,
                                                      const geometry::Vec3& point,
                                                      std::size_t count,
                                                      double max_distance) {
    const geometry::PreparedPoint prepared(point);
    std::vector<geometry::ClosestPoint> found;
    for (std::size_t i = 0; i < mesh.triangles.size() && prepared.is_valid(); ++i) {
        const auto [a, b, c] = geometry::corners(mesh, i);
        if (auto near = prepared.closest_point(a, b, c, max_distance)) {
            near->triangle = static_cast<geometry::TriangleId>(i);
            found.push_back(*near);
        }
    }
    std::stable_sort(found.begin(), found.end(), [](const auto& a, const auto& b) {
        return a.distance < b.distance;
    });
    found.resize(std::min(found.size(), count));
    return found;
}

std::optional<geometry::ClosestPoint> closest_point(const geometry::MeshView& mesh,
                                                    const geometry::Vec3& point,
                                                    double max_distance) {
    const auto nearest = closest_triangles(mesh, point, 1, max_distance);
    return nearest.empty() ? std::nullopt : std::optional(nearest.front());
}

std::optional<InstanceHit> closest_hit(const Instances& instances,
                                       const geometry::Ray& ray) noexcept {
    const geometry::PreparedRay prepared(ray, max_abs_coordinate(instances));
    std::optional<InstanceHit> best;
    for (const Instances::Instance& instance : instances.active_instances()) {
        const auto own = prepared.box_interval(instance.box, prepared.t_max());
        if (!prepared.is_valid() || own.is_empty()) {
            continue;
        }
        auto hit = closest_hit(instances.part(instance.part).mesh,
                               instance.to_local(ray, prepared.t_max()));
        if (hit) {
            hit->t = std::clamp(hit->t, own.min, own.max);
            if (!best || hit->t < best->hit.t) {
                best = InstanceHit{instance.id, *hit};
            }
        }
    }
    return best;
}

bool occluded(const Instances& instances, const geometry::Segment& segment) noexcept {
    const geometry::Vec3 along = segment.to - segment.from;
    const geometry::SlabTest slab_test(segment.from, along, max_abs_coordinate(instances));
    const auto blocks = [&](const Instances::Instance& instance) {
        return !slab_test.interval(instance.box, 1.0).is_empty() &&
               occluded(instances.part(instance.part).mesh, instance.to_local(segment));
    };
    const double sum = along.x + along.y + along.z;
    return sum - sum == 0.0 &&  // only if all are finite
           std::any_of(
               instances.active_instances().begin(), instances.active_instances().end(), blocks);
}

}  // namespace earshot::bvh::brute_force
