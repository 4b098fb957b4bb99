// SPDX-License-Identifier: MIT
//
// Exact tests, compiled once per instruction set: the steps of geometry::ShearedRay::hit() for a
// pair of ray and triangle per lane, with the same bits.

#include "earshot/base/simd/float_lanes-inl.h"
#include "earshot/bvh/exact_coordinates.h"
#include "earshot/bvh/wide_tree.h"
#include "earshot/geometry/mesh.h"
#include "earshot/geometry/sheared_ray.h"
#include "earshot/geometry/types.h"

#include <glm/gtc/type_ptr.hpp>

#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>

#if defined(EARSHOT_BVH_KERNELS_EXACT_TEST_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef EARSHOT_BVH_KERNELS_EXACT_TEST_INL_H
#undef EARSHOT_BVH_KERNELS_EXACT_TEST_INL_H
#else
#define EARSHOT_BVH_KERNELS_EXACT_TEST_INL_H
#endif

HWY_BEFORE_NAMESPACE();
namespace earshot::bvh::HWY_NAMESPACE {

using namespace earshot::HWY_NAMESPACE;  // NOLINT: the lanes

/// Rays along their axes, one per lane.
template <typename Row>
struct ShearedRays {
    Row origin[3], shear[3];

    ShearedRays() = default;
    HWY_INLINE ShearedRays(const Row (&from)[3], const Row (&direction)[3])
        : origin{from[0], from[1], from[2]},
          shear{direction[0] / direction[2], direction[1] / direction[2], Row(1.0) / direction[2]} {
    }
};

/// Corners of triangles from the rays' origins, sheared along the rays.
template <typename Row>
struct ShearedCorners {
    Row x, y, z;
    Row off;  ///< |x| + |y|
};

/// The steps of these two and their order are those of ShearedRay::hit().
template <typename Row>
HWY_INLINE ShearedCorners<Row> shear(const ShearedRays<Row>& rays, Row x, Row y, Row z) {
    ShearedCorners<Row> seen;
    seen.z = z - rays.origin[2];
    seen.x = x - rays.origin[0] - rays.shear[0] * seen.z;
    seen.y = y - rays.origin[1] - rays.shear[1] * seen.z;
    seen.off = abs(seen.x) + abs(seen.y);
    return seen;
}

/// What ShearedRay::hit() finds before it asks for the range of t.
template <typename Row>
struct Intersections {
    typename Row::Mask inside;
    typename Row::Mask
        certain;  ///< the hit lies in the triangle's own box; else the rest is not valid
    Row t, v, w, determinant;
};

template <typename Row>
HWY_INLINE Intersections<Row> intersect(const ShearedRays<Row>& rays,
                                        const ShearedCorners<Row>& a,
                                        const ShearedCorners<Row>& b,
                                        const ShearedCorners<Row>& c) {
    const Row zero = Row(0.0);
    const Row u = c.x * b.y - c.y * b.x;
    const Row v = a.x * c.y - a.y * c.x;
    const Row w = b.x * a.y - b.y * a.x;
    const Row determinant = u + v + w;
    const Row weighted = u * a.z + v * b.z + w * c.z;
    const Row t = rays.shear[2] * weighted / determinant;
    const Row size = a.off + b.off + c.off;
    const Row depth = max(max(a.z, b.z), c.z) - min(min(a.z, b.z), c.z);
    const Row magnitude = abs(determinant);
    const Row lowest = min(min(u, v), w);
    const Row highest = max(max(u, v), w);
    const typename Row::Mask in_own_box =
        size * max(size, Row(4.0) * depth) <= Row(64.0) * magnitude;
    return {.inside = (zero <= lowest) | (highest <= zero),
            .certain = and_not(in_own_box, magnitude <= zero),
            .t = t,
            .v = v,
            .w = w,
            .determinant = determinant};
}

/// ExactCoordinates::restore() of three decimal numbers.
HWY_INLINE Double4 restore(const ExactCoordinates& exact, float a, float b, float c) {
    const Double4 coordinates = doubles_of(a, b, c);
    const Double4 scale = Double4(exact.scale());
    const Double4 round = Double4(ExactCoordinates::kRound);
    const Double4 steps = (coordinates * scale + round) - round;
    return copy_sign(steps / scale, coordinates);
}

/// One ray, prepared for exact tests of one triangle after another.
class ExactRay {
public:
    ExactRay() = default;
    explicit HWY_INLINE ExactRay(const geometry::Ray& ray) : ray_(&ray) {
        const double* origin = glm::value_ptr(ray.origin);
        const double* direction = glm::value_ptr(ray.direction);
        const double x = std::abs(direction[0]);
        const double y = std::abs(direction[1]);
        const double z = std::abs(direction[2]);
        const double larger = x < y ? y : x;
        axes_ = geometry::RayAxes::of(x, y, larger < z ? z : larger);
        const Double1 from[3] = {
            Double1(origin[axes_.x]), Double1(origin[axes_.y]), Double1(origin[axes_.z])};
        const Double1 along[3] = {
            Double1(direction[axes_.x]), Double1(direction[axes_.y]), Double1(direction[axes_.z])};
        sheared_ = ShearedRays<Double1>(from, along);
    }

    const geometry::RayAxes& axes() const { return axes_; }

    /// ShearedRay::hit() within the ray's t_max; row k of `corners` has the coordinates of all
    /// corners along axis k of axes(). Precondition: ShearedRay::takes() the ray.
    HWY_INLINE bool hit(const double (&corners)[3][4],
                        double max_abs_coordinate,
                        double& t,
                        double& u,
                        double& v) const {
        const auto corner = [&](std::size_t k) {
            return shear(
                sheared_, Double1(corners[0][k]), Double1(corners[1][k]), Double1(corners[2][k]));
        };
        const Intersections<Double1> found = intersect(sheared_, corner(0), corner(1), corner(2));
        if (!any(found.certain)) {
            return hit_scalar(corners, max_abs_coordinate, t, u, v);
        }
        // Adding 0 turns -0 into 0.
        const Double1 zero = Double1(0.0);
        t = first_lane(found.t + zero);
        u = first_lane(found.v / found.determinant + zero);
        v = first_lane(found.w / found.determinant + zero);
        return any(found.inside & (zero <= found.t) & (found.t <= Double1(ray_->t_max)));
    }

private:
    bool hit_scalar(const double (&corners)[3][4],
                    double max_abs_coordinate,
                    double& t,
                    double& u,
                    double& v) const {
        geometry::Vec3 at[3];
        for (std::size_t k = 0; k < 3; ++k) {
            double* corner = glm::value_ptr(at[k]);
            corner[axes_.x] = corners[0][k];
            corner[axes_.y] = corners[1][k];
            corner[axes_.z] = corners[2][k];
        }
        const auto hit =
            geometry::ShearedRay(*ray_).hit(at[0], at[1], at[2], ray_->t_max, max_abs_coordinate);
        if (hit) {
            t = hit->t;
            u = hit->u;
            v = hit->v;
        }
        return hit.has_value();
    }

    using Double1 = Lanes<double, 1>;

    const geometry::Ray* ray_;
    geometry::RayAxes axes_;
    ShearedRays<Double1> sheared_;
};

/// The coordinates of a triangle's corners along a ray's axes, a row each, from the mesh.
HWY_INLINE void gather_corners(const geometry::MeshView& mesh,
                               std::uint32_t id,
                               const geometry::RayAxes& axes,
                               double (&corners)[3][4]) {
    const geometry::Triangle& triangle = mesh.triangles[id];
    for (std::size_t k = 0; k < 3; ++k) {
        const double* position = glm::value_ptr(mesh.positions[triangle[k]]);
        corners[0][k] = position[axes.x];
        corners[1][k] = position[axes.y];
        corners[2][k] = position[axes.z];
    }
}

/// The same of the triangle in a lane of a packed leaf that holds it exactly.
HWY_INLINE void gather_corners(const ExactCoordinates& exact,
                               const std::uint32_t* words,
                               std::size_t count,
                               std::size_t lane,
                               const geometry::RayAxes& axes,
                               double (&corners)[3][4]) {
    const std::size_t first[3] = {
        axes.x * count + lane, axes.y * count + lane, axes.z * count + lane};
    for (std::size_t row = 0; row < 3; ++row) {
        const auto corner = [&](std::size_t k) {
            return std::bit_cast<float>(words[first[row] + 3 * k * count]);
        };
        const float a = corner(0), b = corner(1), c = corner(2);
        if (exact.scale() == 1.0) {
            corners[row][0] = static_cast<double>(a);
            corners[row][1] = static_cast<double>(b);
            corners[row][2] = static_cast<double>(c);
        } else {
            restore(exact, a, b, c).store(corners[row]);
        }
    }
}

}  // namespace earshot::bvh::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
