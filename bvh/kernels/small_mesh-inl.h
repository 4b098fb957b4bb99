// SPDX-License-Identifier: MIT
//
// The brute-force kernel for small meshes, compiled once per instruction set: of so few triangles
// that testing all of them is faster than testing boxes first.

#include "earshot/bvh/kernels/exact_queue-inl.h"
#include "earshot/bvh/kernels/float_ray-inl.h"
#include "earshot/bvh/kernels/leaf-inl.h"
#include "earshot/bvh/wide_batch.h"
#include "earshot/bvh/wide_ray.h"

#include <glm/gtc/type_ptr.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#if defined(EARSHOT_BVH_KERNELS_SMALL_MESH_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef EARSHOT_BVH_KERNELS_SMALL_MESH_INL_H
#undef EARSHOT_BVH_KERNELS_SMALL_MESH_INL_H
#else
#define EARSHOT_BVH_KERNELS_SMALL_MESH_INL_H
#endif

HWY_BEFORE_NAMESPACE();
namespace earshot::bvh::HWY_NAMESPACE {

/// A mesh of no more triangles is small.
inline constexpr std::size_t kMaxSmallMeshTriangles = 16;

/// The triangles of a small mesh, and the positions of their corners, each once.
struct SmallMesh {
    explicit SmallMesh(const geometry::MeshView& mesh) : count(mesh.triangles.size()) {
        for (std::size_t id = 0; id < count; ++id) {
            for (std::size_t k = 0; k < 3; ++k) {
                const double* vertex = glm::value_ptr(mesh.positions[mesh.triangles[id][k]]);
                std::size_t i = 0;
                while (i < vertex_count && !std::equal(vertex, vertex + 3, position[i])) {
                    ++i;
                }
                if (i == vertex_count) {
                    std::copy_n(vertex, 3, position[vertex_count++]);
                }
                corner[id][k] = static_cast<std::uint32_t>(i);
            }
        }
    }

    static constexpr std::size_t kMaxVertices = 3 * kMaxSmallMeshTriangles;

    std::size_t count;
    std::size_t vertex_count = 0;
    double position[kMaxVertices][3];
    std::uint32_t corner[kMaxSmallMeshTriangles][3];
};

/// Rays with the same largest component of direction, along the axes that go with it: z is that
/// component.
struct RayLanes {
    static constexpr std::size_t kLanes = 8;

    alignas(64) double origin[3][kLanes];
    alignas(64) double direction[3][kLanes];
    alignas(64) double t_max[kLanes];
    std::size_t axis[3];  ///< of x, y and z
    std::size_t index[kLanes];
    std::size_t count = 0;

    explicit RayLanes(std::size_t z) : axis{z == 2 ? 0 : z + 1, z == 0 ? 2 : z - 1, z} {}

    HWY_INLINE void add(const geometry::Ray& ray, std::size_t ray_index) {
        for (std::size_t k = 0; k < 3; ++k) {
            origin[k][count] = glm::value_ptr(ray.origin)[axis[k]];
            direction[k][count] = glm::value_ptr(ray.direction)[axis[k]];
        }
        t_max[count] = ray.t_max;
        index[count++] = ray_index;
    }

    /// Pads the unused lanes with the first ray.
    HWY_INLINE void pad() {
        for (std::size_t i = count; i < kLanes; ++i) {
            for (std::size_t k = 0; k < 3; ++k) {
                origin[k][i] = origin[k][0];
                direction[k][i] = direction[k][0];
            }
            t_max[i] = t_max[0];
        }
    }
};

/// The closest hits of rays in a small mesh, decided in double precision, several rays at a
/// time, as geometry::ShearedRay::hit() decides them.
class SmallMeshClosest {
public:
    SmallMeshClosest(const geometry::MeshView& mesh,
                     std::span<const geometry::Ray> rays,
                     std::span<std::optional<geometry::Hit>> hits,
                     ExactTestQueue& queue)
        : triangles_(mesh), rays_(rays), hits_(hits), queue_(queue) {}

    HWY_INLINE void add(std::size_t ray) {
        const geometry::Vec3& d = rays_[ray].direction;
        const double x = std::abs(d.x);
        const double y = std::abs(d.y);
        const double size = std::max(std::max(x, y), std::abs(d.z));
        if (!geometry::ShearedRay::takes(rays_[ray], size)) {
            hits_[ray].reset();
            return;
        }
        RayLanes& rays = groups_[geometry::RayAxes::of(x, y, size).z];
        rays.add(rays_[ray], ray);
        if (rays.count == RayLanes::kLanes) {
            decide_all(rays);
        }
    }

    HWY_INLINE void finish() {
        for (RayLanes& rays : groups_) {
            if (rays.count > 0) {
                rays.pad();
                decide_all(rays);
            }
        }
    }

private:
    /// The best so far, per lane.
    struct Best {
        Doubles t, triangle, v, w, determinant;
    };

    void decide_all(RayLanes& rays) {
        alignas(64) double t[RayLanes::kLanes];
        alignas(64) double triangle[RayLanes::kLanes];
        alignas(64) double u[RayLanes::kLanes];
        alignas(64) double v[RayLanes::kLanes];
        for (std::size_t i = 0; i < RayLanes::kLanes; i += Doubles::kCount) {
            const Best best = decide(rays, i);
            // Adding 0 turns -0 into 0.
            const Doubles zero = Doubles(0.0);
            (best.t + zero).store(t + i);
            best.triangle.store(triangle + i);
            (best.v / best.determinant + zero).store(u + i);
            (best.w / best.determinant + zero).store(v + i);
        }
        for (std::size_t i = 0; i < rays.count; ++i) {
            std::optional<geometry::Hit>& hit = hits_[rays.index[i]];
            hit.reset();
            if (triangle[i] >= 0.0) {
                hit = {static_cast<geometry::TriangleId>(triangle[i]), t[i], u[i], v[i]};
            }
        }
        for (std::size_t k = 0; k < uncertain_count_; ++k) {
            if (uncertain_[k].lane < rays.count) {
                queue_.push(rays.index[uncertain_[k].lane], uncertain_[k].triangle);
            }
        }
        uncertain_count_ = 0;
        rays.count = 0;
    }

    HWY_INLINE Best decide(const RayLanes& rays, std::size_t first) {
        Doubles origin[3], direction[3];
        for (std::size_t k = 0; k < 3; ++k) {
            origin[k] = Doubles::load(rays.origin[k] + first);
            direction[k] = Doubles::load(rays.direction[k] + first);
        }
        const ShearedRays<Doubles> sheared(origin, direction);
        ShearedCorners<Doubles> corners[SmallMesh::kMaxVertices];
        for (std::size_t i = 0; i < triangles_.vertex_count; ++i) {
            const double* vertex = triangles_.position[i];
            corners[i] = shear(sheared,
                               Doubles(vertex[rays.axis[0]]),
                               Doubles(vertex[rays.axis[1]]),
                               Doubles(vertex[rays.axis[2]]));
        }
        const Doubles zero = Doubles(0.0);
        Doubles best_t = Doubles::load(rays.t_max + first);
        Doubles best_triangle = Doubles(-1.0);
        Doubles best_v = zero;
        Doubles best_w = zero;
        Doubles best_determinant = Doubles(1.0);
        for (std::uint32_t id = 0; id < triangles_.count; ++id) {
            const std::uint32_t* corner = triangles_.corner[id];
            const Intersections<Doubles> found =
                intersect(sheared, corners[corner[0]], corners[corner[1]], corners[corner[2]]);
            const Doubles::Mask uncertain = and_not(found.inside, found.certain);
            std::uint32_t remaining = bits(uncertain);
            for (; remaining != 0; remaining &= remaining - 1) {
                const auto lane = static_cast<std::size_t>(std::countr_zero(remaining));
                uncertain_[uncertain_count_++] = {first + lane, id};
            }
            // Of hits at the same t that of the lowest triangle stays.
            const Doubles::Mask nearer =
                (found.t < best_t) | ((found.t <= best_t) & (best_triangle < zero));
            const Doubles::Mask better = found.inside & found.certain & (zero <= found.t) & nearer;
            best_t = select(better, found.t, best_t);
            best_triangle = select(better, Doubles(id), best_triangle);
            best_v = select(better, found.v, best_v);
            best_w = select(better, found.w, best_w);
            best_determinant = select(better, found.determinant, best_determinant);
        }
        return {best_t, best_triangle, best_v, best_w, best_determinant};
    }

    struct Uncertain {
        std::size_t lane;
        std::uint32_t triangle;
    };

    SmallMesh triangles_;
    std::span<const geometry::Ray> rays_;
    std::span<std::optional<geometry::Hit>> hits_;
    ExactTestQueue& queue_;
    RayLanes groups_[3] = {RayLanes(0), RayLanes(1), RayLanes(2)};
    Uncertain uncertain_[RayLanes::kLanes * kMaxSmallMeshTriangles];
    std::size_t uncertain_count_ = 0;
};

/// Segments as RayLanes, in single precision.
struct SegmentLanes {
    static constexpr std::size_t kLanes = 8;

    alignas(32) float origin[3][kLanes];
    alignas(32) float origin_rest[3][kLanes];
    alignas(32) float shear[2][kLanes];
    alignas(32) float inverse_depth[kLanes];
    alignas(32) float corner_error[kLanes];
    alignas(32) float excluded[kLanes];  ///< the triangle that the segment starts from
    std::size_t index[kLanes];
    std::size_t count = 0;

    HWY_INLINE void add(const FloatRay& ray, std::uint32_t excluded_triangle, std::size_t segment) {
        for (std::size_t k = 0; k < 3; ++k) {
            origin[k][count] = ray.origin[ray.axis[k]];
            origin_rest[k][count] = ray.origin_rest[ray.axis[k]];
        }
        shear[0][count] = ray.shear[ray.axis[0]];
        shear[1][count] = ray.shear[ray.axis[1]];
        inverse_depth[count] = ray.inverse_depth;
        corner_error[count] = ray.corner_error;
        excluded[count] = static_cast<float>(excluded_triangle);
        index[count++] = segment;
    }
};

/// Which segments the triangles of a small mesh block.
class SmallMeshAny {
public:
    SmallMeshAny(const WideTree& tree,
                 const geometry::MeshView& mesh,
                 const SecondarySegments& secondary_segments,
                 std::span<std::uint8_t> blocked)
        : tree_(tree),
          reach_(static_cast<float>(tree.max_abs_coordinate())),
          mesh_(mesh),
          triangles_(mesh),
          secondary_segments_(secondary_segments),
          blocked_(blocked) {}

    HWY_INLINE void add(std::size_t segment) {
        const geometry::Segment& asked = secondary_segments_.segments[segment];
        FloatRay ray;
        if (!set_segment(ray, asked, reach_)) {
            blocked_[segment] = occluded(tree_, mesh_, asked) ? 1 : 0;
            return;
        }
        SegmentLanes& group = groups_[ray.axis[2]];
        group.add(ray,
                  secondary_segments_.origin_triangles.empty()
                      ? kMaxSmallMeshTriangles
                      : secondary_segments_.origin_triangles[segment],
                  segment);
        if (group.count == SegmentLanes::kLanes) {
            decide_all(ray.axis[2]);
        }
    }

    HWY_INLINE void finish() {
        for (std::size_t z = 0; z < 3; ++z) {
            if (groups_[z].count > 0) {
                decide_all(z);
            }
        }
    }

private:
    void decide_all(std::size_t z) {
        SegmentLanes& group = groups_[z];
        const std::size_t x = z == 2 ? 0 : z + 1;
        const std::size_t y = x == 2 ? 0 : x + 1;
        ShearedLanes at;
        at.corner_error = Float8::load(group.corner_error);
        at.inverse_depth = Float8::load(group.inverse_depth);
        std::uint32_t blocked = 0;
        Float8 seen[3][SmallMesh::kMaxVertices];
        for (std::size_t i = 0; i < triangles_.vertex_count; ++i) {
            const double* vertex = triangles_.position[i];
            const auto from_origin = [&](std::size_t k, std::size_t axis) {
                return (Float8(static_cast<float>(vertex[axis])) - Float8::load(group.origin[k])) -
                       Float8::load(group.origin_rest[k]);
            };
            seen[2][i] = from_origin(2, z);
            seen[0][i] = neg_mul_add(Float8::load(group.shear[0]), seen[2][i], from_origin(0, x));
            seen[1][i] = neg_mul_add(Float8::load(group.shear[1]), seen[2][i], from_origin(1, y));
        }
        for (std::uint32_t id = 0; id < triangles_.count; ++id) {
            for (std::size_t k = 0; k < 3; ++k) {
                const std::uint32_t corner = triangles_.corner[id][k];
                at.x[k] = seen[0][corner];
                at.y[k] = seen[1][corner];
                at.z[k] = seen[2][corner];
            }
            const EdgeTest<> test(at);
            if (any(Float8::Mask::first(group.count) & test.is_possible())) {
                blocked |= blocked_by(test.bounds(at, group.count), id, group, blocked);
            }
        }
        for (std::size_t i = 0; i < group.count; ++i) {
            blocked_[group.index[i]] = static_cast<std::uint8_t>(blocked >> i & 1U);
        }
        group.count = 0;
    }

    /// As touches_leaf(), a bit per segment; not of those that are blocked anyway.
    HWY_INLINE std::uint32_t blocked_by(const ConservativeHits& hits,
                                        std::uint32_t id,
                                        const SegmentLanes& group,
                                        std::uint32_t before) const {
        const Float8 zero = Float8(0.0F);
        const Float8 one = Float8(1.0F);
        const Float8 excluded = Float8::load(group.excluded);
        const Float8 triangle = Float8(static_cast<float>(id));
        const Float8::Mask stays = (excluded < triangle) | (triangle < excluded);
        const Float8::Mask inside = (zero < hits.near) & (hits.far < one);
        std::uint32_t blocked = bits(hits.certain & inside & stays);
        const Float8::Mask in_range = (hits.near <= one) & (zero <= hits.far);
        std::uint32_t open = bits(in_range & stays & hits.possible) & ~blocked & ~before;
        for (; open != 0; open &= open - 1) {
            const auto lane = static_cast<std::size_t>(std::countr_zero(open));
            const geometry::Triangle& corners = mesh_.triangles[id];
            const bool touches = geometry::touches(secondary_segments_.segments[group.index[lane]],
                                                   mesh_.positions[corners[0]],
                                                   mesh_.positions[corners[1]],
                                                   mesh_.positions[corners[2]]);
            blocked |= (touches ? 1U : 0U) << lane;
        }
        return blocked;
    }

    const WideTree& tree_;
    float reach_;
    const geometry::MeshView& mesh_;
    SmallMesh triangles_;
    const SecondarySegments& secondary_segments_;
    std::span<std::uint8_t> blocked_;
    SegmentLanes groups_[3] = {};
};

}  // namespace earshot::bvh::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
