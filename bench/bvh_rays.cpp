// SPDX-License-Identifier: MIT
#include "bvh_rays.h"

#include "earshot/base/math.h"
#include "earshot/base/random.h"
#include "earshot/bvh/wide_ray.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace bench {

using earshot::random;
using earshot::geometry::MeshView;
using earshot::geometry::Ray;
using earshot::geometry::Vec3;

namespace {

Vec3 direction(std::uint64_t stream, std::uint64_t i) {
    const double z = 1.0 - 2.0 * random(1, stream, i);
    const double angle = 2.0 * earshot::math::kPi * random(1, stream + 1, i);
    const double r = std::sqrt(std::max(0.0, 1.0 - z * z));
    return {r * std::cos(angle), r * std::sin(angle), z};
}

struct Box {
    Vec3 lower{1e300}, upper{-1e300};
};

Box box_of(const MeshView& mesh) {
    Box box;
    for (const Vec3& position : mesh.positions) {
        box.lower = glm::min(box.lower, position);
        box.upper = glm::max(box.upper, position);
    }
    return box;
}

struct View {
    Vec3 eye, look, right, up;
};

View view_of(const MeshView& mesh, bool from_inside) {
    const Box box = box_of(mesh);
    const Vec3 size = box.upper - box.lower;
    const Vec3 middle = 0.5 * (box.lower + box.upper);
    View view;
    double width = 0.4;
    if (from_inside) {
        view.eye = middle + Vec3(0.0, 0.1 * size.y, 0.0);
        view.look = size.x > size.z ? Vec3(1.0, -0.1, 0.2) : Vec3(0.2, -0.1, 1.0);
        width = 0.9;
    } else {
        view.eye = middle + 0.8 * glm::length(size) * Vec3(0.3, 0.4, 1.2);
        view.look = middle - view.eye;
    }
    view.look = glm::normalize(view.look);
    view.right = width * glm::normalize(glm::cross(view.look, Vec3(0.0, 1.0, 0.0)));
    view.up = glm::cross(view.right, view.look);
    return view;
}

std::vector<Ray> camera_rays(const View& view, std::size_t count) {
    constexpr std::size_t kTile = 8;
    const auto tiles = static_cast<std::size_t>(std::sqrt(static_cast<double>(count))) / kTile;
    const auto pixels = static_cast<double>(tiles * kTile);
    std::vector<Ray> rays;
    for (std::size_t tile = 0; tile < tiles * tiles; ++tile) {
        for (std::size_t k = 0; k < kTile * kTile; ++k) {
            const auto x = static_cast<double>(tile % tiles * kTile + k % kTile);
            const auto y = static_cast<double>(tile / tiles * kTile + k / kTile);
            rays.push_back({view.eye,
                            view.look + (2.0 * (x + 0.5) / pixels - 1.0) * view.right +
                                (1.0 - 2.0 * (y + 0.5) / pixels) * view.up});
        }
    }
    return rays;
}

/// Cosine-distributed about a normal.
Vec3 bounce(const Vec3& normal, std::uint64_t stream, std::uint64_t i) {
    return glm::normalize(1.0001 * normal + direction(stream, i));
}

}  // namespace

std::vector<RaySet> make_ray_sets(const MeshView& mesh, std::size_t count, bool from_inside) {
    const auto tree = earshot::bvh::WideTree::build(
        earshot::bvh::Tree::build(earshot::bvh::triangle_boxes(mesh)), mesh);
    const Box box = box_of(mesh);
    const Vec3 size = box.upper - box.lower;
    const double diagonal = glm::length(size);
    std::vector<RaySet> sets(5);
    sets[0].name = "camera";
    sets[1].name = "diffuse";
    sets[2].name = "ao";
    sets[3].name = "random";
    sets[4].name = "los";
    sets[0].rays = camera_rays(view_of(mesh, from_inside), count);
    for (std::size_t i = 0; i < sets[0].rays.size(); ++i) {
        const Ray& ray = sets[0].rays[i];
        const auto hit = closest_hit(tree, mesh, ray);
        if (!hit) {
            continue;
        }
        const auto [a, b, c] = earshot::geometry::corners(mesh, hit->triangle);
        Vec3 normal = glm::cross(b - a, c - a);
        if (!(glm::length(normal) > 0.0)) {
            continue;
        }
        normal = glm::normalize(normal) * (glm::dot(normal, ray.direction) > 0.0 ? -1.0 : 1.0);
        const Vec3 from = ray.origin + hit->t * ray.direction + 1e-5 * diagonal * normal;
        sets[1].rays.push_back({from, bounce(normal, 2, i)});
        sets[2].segments.push_back({from, from + 0.1 * diagonal * bounce(normal, 4, i)});
    }
    for (std::uint64_t i = 0; i < count; ++i) {
        const auto point = [&](std::uint64_t stream) {
            return box.lower + size * Vec3(random(1, stream, i),
                                           random(1, stream + 1, i),
                                           random(1, stream + 2, i));
        };
        sets[3].rays.push_back({point(6), direction(9, i)});
        sets[4].segments.push_back({point(6), point(11)});
    }
    return sets;
}

}  // namespace bench
