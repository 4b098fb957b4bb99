// SPDX-License-Identifier: MIT
#include "earshot/bvh/brute_force.h"

#include "earshot/geometry/intersect.h"

#include <algorithm>
#include <cmath>

namespace earshot::bvh::brute_force {
namespace {

// As reach_of() of a tree with this box.
double reach_of(const geometry::Aabb& box) noexcept {
    double reach = 0.0;
    for (std::size_t k = 0; k < 3 && !box.is_empty(); ++k) {
        reach = std::max({reach,
                          std::abs(static_cast<double>(box.lower[k])),
                          std::abs(static_cast<double>(box.upper[k]))});
    }
    return reach;
}

double reach_of(const geometry::MeshView& mesh) noexcept {
    geometry::Aabb box;
    for (const geometry::Triangle& triangle : mesh.triangles) {
        for (const geometry::VertexId vertex : triangle) {
            box.include(mesh.positions[vertex]);
        }
    }
    return reach_of(box);
}

double reach_of(const Instances& scene) noexcept {
    geometry::Aabb box;
    for (const Instances::Instance& instance : scene.placed()) {
        box.include(instance.box);
    }
    return reach_of(box);
}

std::optional<geometry::Hit> hit_of(const geometry::PreparedRay& ray,
                                    const geometry::MeshView& mesh,
                                    std::size_t i) noexcept {
    const geometry::Triangle& triangle = mesh.triangles[i];
    auto hit = ray.hit(mesh.positions[triangle[0]],
                       mesh.positions[triangle[1]],
                       mesh.positions[triangle[2]],
                       ray.t_max());
    if (hit) {
        hit->triangle = static_cast<geometry::TriangleId>(i);
    }
    return hit;
}

}  // namespace

std::optional<geometry::Hit> closest_hit(const geometry::MeshView& mesh,
                                         const geometry::Ray& ray) noexcept {
    const geometry::PreparedRay prepared(ray, reach_of(mesh));
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
    const geometry::PreparedRay prepared(ray, reach_of(mesh));
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
            return geometry::touches(segment,
                                     mesh.positions[triangle[0]],
                                     mesh.positions[triangle[1]],
                                     mesh.positions[triangle[2]]);
        });
}

std::vector<geometry::NearPoint> nearest_triangles(const geometry::MeshView& mesh,
                                                   const geometry::Vec3& point,
                                                   std::size_t count,
                                                   double most) {
    const geometry::PreparedPoint prepared(point);
    std::vector<geometry::NearPoint> found;
    for (std::size_t i = 0; i < mesh.triangles.size() && prepared.is_valid(); ++i) {
        const geometry::Triangle& triangle = mesh.triangles[i];
        if (auto near = prepared.nearest(mesh.positions[triangle[0]],
                                         mesh.positions[triangle[1]],
                                         mesh.positions[triangle[2]],
                                         most)) {
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

std::optional<geometry::NearPoint> closest_point(const geometry::MeshView& mesh,
                                                 const geometry::Vec3& point,
                                                 double most) {
    const auto nearest = nearest_triangles(mesh, point, 1, most);
    return nearest.empty() ? std::nullopt : std::optional(nearest.front());
}

std::optional<InstanceHit> closest_hit(const Instances& scene, const geometry::Ray& ray) noexcept {
    const geometry::PreparedRay prepared(ray, reach_of(scene));
    std::optional<InstanceHit> best;
    for (const Instances::Instance& instance : scene.placed()) {
        const auto own = prepared.passage(instance.box, prepared.t_max());
        if (!prepared.is_valid() || own.is_empty()) {
            continue;
        }
        auto hit =
            closest_hit(scene.part(instance.part).mesh, instance.into_part(ray, prepared.t_max()));
        if (hit) {
            hit->t = std::clamp(hit->t, own.near, own.far);
            if (!best || hit->t < best->hit.t) {
                best = InstanceHit{instance.id, *hit};
            }
        }
    }
    return best;
}

bool occluded(const Instances& scene, const geometry::Segment& segment) noexcept {
    const geometry::Vec3 along = segment.to - segment.from;
    const geometry::Slabs slabs(segment.from, along, reach_of(scene));
    const auto blocks = [&](const Instances::Instance& instance) {
        return !slabs.passage(instance.box, 1.0).is_empty() &&
               occluded(scene.part(instance.part).mesh, instance.into_part(segment));
    };
    const double sum = along.x + along.y + along.z;
    return sum - sum == 0.0 &&  // only if all are finite
           std::any_of(scene.placed().begin(), scene.placed().end(), blocks);
}

}  // namespace earshot::bvh::brute_force
