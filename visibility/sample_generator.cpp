// SPDX-License-Identifier: MIT
#include "earshot/visibility/internal/sample_generator.h"

#include "earshot/base/halton.h"
#include "earshot/base/math.h"
#include "earshot/base/random.h"
#include "earshot/geometry/aabb.h"
#include "earshot/geometry/sheared_ray.h"
#include "earshot/visibility/internal/directions.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace earshot::visibility {

using geometry::Ray;
using geometry::TriangleId;
using geometry::Vec3;

namespace {

constexpr double kFullTurn = 2.0 * math::kPi;

// Streams of random numbers; mutations need no low-discrepancy sequence.
constexpr std::uint64_t kTwoPoint = 100;
constexpr std::uint64_t kSilhouette = 110;

// The silhouette point is bisected to a 128th of the search interval: Bittner et al. 2009, 4.3.
constexpr int kBisections = 7;

// Rays start this far from a surface, as a fraction of the largest coordinate: more than rounding.
constexpr double kSurfaceOffset = 0x1p-40;

/// Two unit vectors perpendicular to a direction and to each other.
struct PerpendicularAxes {
    Vec3 right, up;
};

PerpendicularAxes perpendicular_axes(const Vec3& direction) noexcept {
    const Vec3 other = std::abs(direction.x) < 0.5 * glm::length(direction) ? Vec3(1.0, 0.0, 0.0)
                                                                            : Vec3(0.0, 1.0, 0.0);
    const Vec3 right = glm::normalize(glm::cross(direction, other));
    return {right, glm::normalize(glm::cross(direction, right))};
}

}  // namespace

SampleGenerator::SampleGenerator(const geometry::MeshView& mesh,
                                 const Objects& objects,
                                 const ViewRegion& region,
                                 std::uint64_t seed)
    : mesh_(mesh), objects_(objects), region_(region), seed_(seed) {
    for (ObjectId object = 0; object < objects.size(); ++object) {
        first_area_.push_back(areas_.size());
        Vec3 lower(std::numeric_limits<double>::infinity());
        Vec3 upper(-lower);
        double sum = 0.0;
        for (const TriangleId id : objects.triangles_of(object)) {
            const auto [a, b, c] = geometry::corners(mesh, id);
            lower = glm::min(lower, glm::min(a, glm::min(b, c)));
            upper = glm::max(upper, glm::max(a, glm::max(b, c)));
            sum += glm::length(glm::cross(b - a, c - a));
            areas_.push_back(sum);
        }
        radii_.push_back(0.5 * glm::distance(lower, upper));
        const Vec3 far = glm::max(glm::abs(lower), glm::abs(upper));
        max_coordinate_ = std::max({max_coordinate_, far.x, far.y, far.z});
    }
}

double SampleGenerator::number(std::uint64_t index, std::uint32_t base) const noexcept {
    return shifted_radical_inverse(index + 1, base, random(seed_, base, 0));
}

Vec3 SampleGenerator::point_in_region(std::uint64_t index) const noexcept {
    return region_.lower +
           Vec3(number(index, 2), number(index, 3), number(index, 5)) * region_.size();
}

// Uniform over the objects, and uniform by area on the one drawn.
SampleGenerator::SurfacePoint SampleGenerator::point_on_object(std::uint64_t index) const noexcept {
    const auto object =
        static_cast<ObjectId>(number(index, 7) * static_cast<double>(objects_.size()));
    const auto members = objects_.triangles_of(object);
    const auto sums = areas_.begin() + static_cast<std::ptrdiff_t>(first_area_[object]);
    const auto end = sums + static_cast<std::ptrdiff_t>(members.size());
    const auto place = std::upper_bound(sums, end - 1, number(index, 11) * *(end - 1));
    const auto [a, end_b, end_c] =
        geometry::corners(mesh_, members[static_cast<std::size_t>(place - sums)]);
    const Vec3 b = end_b - a;
    const Vec3 c = end_c - a;
    const double u = std::sqrt(number(index, 13));
    const double v = number(index, 17);
    return {a + (u * (1.0 - v)) * b + (u * v) * c, glm::cross(b, c)};
}

void SampleGenerator::draw(Sample& sample, std::uint64_t index) const {
    switch (sample.distribution) {
        case SampleDistribution::view_space_direction: {
            sample.ray = {point_in_region(index),
                          on_sphere(1.0 - 2.0 * number(index, 7), kFullTurn * number(index, 11))};
            return;
        }
        case SampleDistribution::object_surface_direction: {
            sample.ray = object_surface_ray(index);
            return;
        }
        case SampleDistribution::two_point: {
            const Vec3 eye = point_in_region(index);
            sample.ray = {eye, point_on_object(index).point - eye};
            return;
        }
        case SampleDistribution::two_point_mutation:
            sample.ray = two_point_mutation(*sample.candidate, index);
            return;
        case SampleDistribution::silhouette_mutation:
            silhouette_mutation(sample, index);
            return;
    }
}

// From either side of the surface in turn, cosine-weighted.
Ray SampleGenerator::object_surface_ray(std::uint64_t index) const {
    const SurfacePoint surface = point_on_object(index);
    const double length = glm::length(surface.normal);
    const Vec3 normal = (index % 2 == 0 ? 1.0 : -1.0) *
                        (length > 0.0 ? surface.normal / length : Vec3(0.0, 1.0, 0.0));
    const auto [right, up] = perpendicular_axes(normal);
    const double squared = number(index, 19);
    const double turn = kFullTurn * number(index, 23);
    return {surface.point + kSurfaceOffset * max_coordinate_ * normal,
            std::sqrt(squared) * (math::cos(turn) * right + math::sin(turn) * up) +
                std::sqrt(1.0 - squared) * normal};
}

// Bittner et al. 2009, section 4.2: both ends move in the plane perpendicular to the segment by a
// Gaussian as wide as the radius of what lies there. The ray starts in the middle of the mutated
// segment, to avoid occlusion near its ends.
Ray SampleGenerator::two_point_mutation(const MutationCandidate& candidate,
                                        std::uint64_t index) const {
    const auto [right, up] = perpendicular_axes(candidate.to - candidate.from);
    const auto moved = [&, right = right, up = up](
                           const Vec3& end, double sigma, std::uint64_t stream) {
        const double radius =
            sigma * std::sqrt(-2.0 * math::log(1.0 - random(seed_, kTwoPoint + stream, index)));
        const double turn = kFullTurn * random(seed_, kTwoPoint + stream + 1, index);
        return end + radius * math::cos(turn) * right + radius * math::sin(turn) * up;
    };
    const Vec3 from = moved(candidate.from, candidate.from_radius, 0);
    const Vec3 to = moved(candidate.to, radii_[candidate.object], 2);
    return {0.5 * (from + to), to - from};
}

// Bittner et al. 2009, section 4.3: a ray just past the object's silhouette in a random direction.
void SampleGenerator::silhouette_mutation(Sample& sample, std::uint64_t index) const {
    const MutationCandidate& candidate = *sample.candidate;
    const auto [right, up] = perpendicular_axes(candidate.to - candidate.from);
    const double turn = kFullTurn * random(seed_, kSilhouette, index);
    const Vec3 direction = math::cos(turn) * right + math::sin(turn) * up;
    double on = 0.0;
    double off = 2.0 * radii_[candidate.object];
    for (int i = 0; i < kBisections; ++i) {
        const double middle = 0.5 * (on + off);
        (intersects(candidate.from, candidate.to + middle * direction, candidate.object) ? on
                                                                                         : off) =
            middle;
    }
    sample.silhouette_point = candidate.to + off * direction;
    sample.ray = {0.5 * (candidate.from + sample.silhouette_point),
                  sample.silhouette_point - candidate.from};
}

bool SampleGenerator::intersects(const Vec3& from, const Vec3& towards, ObjectId object) const {
    const geometry::ShearedRay ray({from, towards - from});
    if (!ray.is_valid()) {
        return false;
    }
    const auto members = objects_.triangles_of(object);
    return std::any_of(members.begin(), members.end(), [&](TriangleId id) {
        const auto [a, b, c] = geometry::corners(mesh_, id);
        return ray.hit(a, b, c, ray.t_max(), max_coordinate_).has_value();
    });
}

}  // namespace earshot::visibility
