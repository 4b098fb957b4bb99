// SPDX-License-Identifier: MIT
//
// Deferred exact tests, compiled once per instruction set: geometry::ShearedRay::hit() for eight
// pairs of ray and triangle at a time, with the same bits.

#include "earshot/base/simd/float_lanes-inl.h"
#include "earshot/bvh/kernels/exact_test-inl.h"
#include "earshot/geometry/mesh.h"
#include "earshot/geometry/sheared_ray.h"

#include <glm/gtc/type_ptr.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#if defined(EARSHOT_BVH_KERNELS_EXACT_QUEUE_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef EARSHOT_BVH_KERNELS_EXACT_QUEUE_INL_H
#undef EARSHOT_BVH_KERNELS_EXACT_QUEUE_INL_H
#else
#define EARSHOT_BVH_KERNELS_EXACT_QUEUE_INL_H
#endif

HWY_BEFORE_NAMESPACE();
namespace earshot::bvh::HWY_NAMESPACE {

using namespace earshot::HWY_NAMESPACE;

/// Where the pairs of ray and triangle are that are tested together.
struct RayTrianglePairs {
    static constexpr std::size_t kCount = 8;
    const double* origin[kCount];
    const double* direction[kCount];
    const double* corner[3][kCount];
    alignas(64) double t_max[kCount];
};

/// The results of ShearedRay::hit() for them.
struct ExactTestResults {
    std::uint32_t certain = 0;  ///< bit per pair: the hit lies in the triangle's own box for sure;
                                ///< else the rest is not valid
    std::uint32_t hit = 0;
    alignas(64) double t[RayTrianglePairs::kCount];
    alignas(64) double u[RayTrianglePairs::kCount];
    alignas(64) double v[RayTrianglePairs::kCount];
};

/// Vectors of three components, along the axes of rays.
class AlongAxes {
public:
    /// The axes are those of geometry::RayAxes.
    explicit HWY_INLINE AlongAxes(const Doubles (&direction)[3]) {
        const Doubles x = abs(direction[0]);
        const Doubles y = abs(direction[1]);
        const Doubles largest = max(max(x, y), abs(direction[2]));
        is_x_ = largest <= x;
        is_y_ = largest <= y;
    }
    HWY_INLINE void operator()(Doubles (&v)[3]) const {
        const Doubles x = select(is_x_, v[1], select(is_y_, v[2], v[0]));
        const Doubles y = select(is_x_, v[2], select(is_y_, v[0], v[1]));
        const Doubles z = select(is_x_, v[0], select(is_y_, v[1], v[2]));
        v[0] = x;
        v[1] = y;
        v[2] = z;
    }

private:
    Doubles::Mask is_x_, is_y_;
};

HWY_INLINE void decide(const RayTrianglePairs& pairs, ExactTestResults& results) {
    results.certain = 0;
    results.hit = 0;
    const Doubles zero = Doubles(0.0);
    for (std::size_t i = 0; i < RayTrianglePairs::kCount; i += Doubles::kCount) {
        Doubles origin[3], direction[3], corner[3];
        load_transposed(pairs.direction + i, direction);
        load_transposed(pairs.origin + i, origin);
        const AlongAxes along_axes(direction);
        along_axes(direction);
        along_axes(origin);
        const ShearedRays<Doubles> rays(origin, direction);
        ShearedCorners<Doubles> corners[3];
        for (std::size_t k = 0; k < 3; ++k) {
            load_transposed(pairs.corner[k] + i, corner);
            along_axes(corner);
            corners[k] = shear(rays, corner[0], corner[1], corner[2]);
        }
        const Intersections<Doubles> found = intersect(rays, corners[0], corners[1], corners[2]);
        const Doubles::Mask between =
            (zero <= found.t) & (found.t <= Doubles::load(pairs.t_max + i));
        results.certain |= bits(found.certain) << i;
        results.hit |= bits(found.inside & between) << i;
        // Adding 0 turns -0 into 0.
        (found.t + zero).store(results.t + i);
        (found.v / found.determinant + zero).store(results.u + i);
        (found.w / found.determinant + zero).store(results.v + i);
    }
}

/// Pairs of ray and triangle whose exact tests are deferred until the memory has fetched them.
class ExactTestQueue {
public:
    /// Precondition: hits[i] is what is already known of rays[i].
    ExactTestQueue(const geometry::MeshView& mesh,
                   std::span<const geometry::Ray> rays,
                   std::span<std::optional<geometry::Hit>> hits,
                   double reach)
        : mesh_(mesh), rays_(rays), hits_(hits), reach_(reach) {}

    HWY_INLINE void push(std::size_t ray, std::uint32_t triangle) {
        __builtin_prefetch(&mesh_.triangles[triangle]);
        pending_[last_ % kRing] = {static_cast<std::uint32_t>(ray), triangle};
        ++last_;
        if (last_ - first_ == kRing) {
            test_next(RayTrianglePairs::kCount);
        }
        if (last_ % RayTrianglePairs::kCount == 0 &&
            last_ - first_ >= 2 * RayTrianglePairs::kCount) {
            fetch_corners(last_ - 2 * RayTrianglePairs::kCount);
        }
    }

    /// Tests the remaining pairs.
    HWY_INLINE void finish() {
        while (first_ != last_) {
            test_next(std::min(last_ - first_, RayTrianglePairs::kCount));
        }
    }

private:
    static constexpr std::size_t kRing = 4 * RayTrianglePairs::kCount;
    struct Pair {
        std::uint32_t ray, triangle;
    };

    HWY_INLINE void fetch_corners(std::size_t first) const {
        for (std::size_t i = first; i < first + RayTrianglePairs::kCount; ++i) {
            for (const geometry::VertexId corner : mesh_.triangles[pending_[i % kRing].triangle]) {
                __builtin_prefetch(&mesh_.positions[corner]);
            }
        }
    }

    HWY_INLINE void test_next(std::size_t count) {
        for (std::size_t i = 0; i < RayTrianglePairs::kCount; ++i) {
            gather(pending_[(first_ + std::min(i, count - 1)) % kRing], i);
        }
        ExactTestResults results;
        decide(pairs_, results);
        for (std::size_t i = 0; i < count; ++i) {
            const Pair& pair = pending_[(first_ + i) % kRing];
            if ((results.certain >> i & 1U) == 0) {
                test_scalar(pair);
            } else if ((results.hit >> i & 1U) != 0) {
                keep({pair.triangle, results.t[i], results.u[i], results.v[i]}, hits_[pair.ray]);
            }
        }
        first_ += count;
    }

    HWY_INLINE void gather(const Pair& pair, std::size_t lane) {
        const geometry::Ray& ray = rays_[pair.ray];
        pairs_.origin[lane] = glm::value_ptr(ray.origin);
        pairs_.direction[lane] = glm::value_ptr(ray.direction);
        pairs_.t_max[lane] = ray.t_max;
        const geometry::Triangle& triangle = mesh_.triangles[pair.triangle];
        for (std::size_t k = 0; k < 3; ++k) {
            pairs_.corner[k][lane] = glm::value_ptr(mesh_.positions[triangle[k]]);
        }
    }

    HWY_INLINE static void keep(const geometry::Hit& hit, std::optional<geometry::Hit>& best) {
        if (!best || hit.t < best->t || (hit.t == best->t && hit.triangle < best->triangle)) {
            best = hit;
        }
    }

    void test_scalar(const Pair& pair) {
        const geometry::Ray& ray = rays_[pair.ray];
        const geometry::Triangle& triangle = mesh_.triangles[pair.triangle];
        auto hit = geometry::ShearedRay(ray).hit(mesh_.positions[triangle[0]],
                                                 mesh_.positions[triangle[1]],
                                                 mesh_.positions[triangle[2]],
                                                 ray.t_max,
                                                 reach_);
        if (hit) {
            hit->triangle = pair.triangle;
            keep(*hit, hits_[pair.ray]);
        }
    }

    const geometry::MeshView& mesh_;
    std::span<const geometry::Ray> rays_;
    std::span<std::optional<geometry::Hit>> hits_;
    double reach_;
    std::size_t first_ = 0, last_ = 0;  // the range of pushed pairs that are not yet tested
    Pair pending_[kRing];
    RayTrianglePairs pairs_;
};

}  // namespace earshot::bvh::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
