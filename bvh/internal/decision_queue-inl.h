// SPDX-License-Identifier: MIT
//
// geometry::ShearedRay::hit() for eight pairs of ray and triangle at a time, with the same bits:
// included by kernels once per instruction set, after base/wide.h.

#include "earshot/geometry/mesh.h"
#include "earshot/geometry/sheared_ray.h"

#include <glm/gtc/type_ptr.hpp>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#if defined(EARSHOT_BVH_DECISION_QUEUE_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef EARSHOT_BVH_DECISION_QUEUE_INL_H
#undef EARSHOT_BVH_DECISION_QUEUE_INL_H
#else
#define EARSHOT_BVH_DECISION_QUEUE_INL_H
#endif

HWY_BEFORE_NAMESPACE();
namespace earshot::bvh::HWY_NAMESPACE {

using namespace earshot::HWY_NAMESPACE;

/// Pairs of ray and triangle, along the ray's axes.
struct Pairs {
    static constexpr std::size_t kMost = 8;
    alignas(64) double origin[3][kMost];
    alignas(64) double direction[3][kMost];
    alignas(64) double corner[3][3][kMost];
    alignas(64) double most[kMost];
};

/// What ShearedRay::hit() says of them.
struct Verdicts {
    std::uint32_t clear = 0;  ///< bit per pair: it lies in its own box, the rest is not valid else
    std::uint32_t hit = 0;
    alignas(64) double t[Pairs::kMost];
    alignas(64) double u[Pairs::kMost];
    alignas(64) double v[Pairs::kMost];
};

/// The steps and their order are those of ShearedRay::hit().
HWY_INLINE void decide(const Pairs& pairs, Verdicts& verdicts) {
    verdicts.clear = 0;
    verdicts.hit = 0;
    const Doubles zero = broadcast(0.0);
    for (std::size_t i = 0; i < Pairs::kMost; i += lanes()) {
        const Doubles dz = load(pairs.direction[2] + i);
        const Doubles shear_x = divide(load(pairs.direction[0] + i), dz);
        const Doubles shear_y = divide(load(pairs.direction[1] + i), dz);
        const Doubles shear_z = divide(broadcast(1.0), dz);
        Doubles x[3], y[3], z[3];
        for (std::size_t k = 0; k < 3; ++k) {
            z[k] = subtract(load(pairs.corner[k][2] + i), load(pairs.origin[2] + i));
            x[k] = subtract(subtract(load(pairs.corner[k][0] + i), load(pairs.origin[0] + i)),
                            multiply(shear_x, z[k]));
            y[k] = subtract(subtract(load(pairs.corner[k][1] + i), load(pairs.origin[1] + i)),
                            multiply(shear_y, z[k]));
        }
        const Doubles u = subtract(multiply(x[2], y[1]), multiply(y[2], x[1]));
        const Doubles v = subtract(multiply(x[0], y[2]), multiply(y[0], x[2]));
        const Doubles w = subtract(multiply(x[1], y[0]), multiply(y[1], x[0]));
        const Doubles determinant = add(add(u, v), w);
        const Doubles weighted = add(add(multiply(u, z[0]), multiply(v, z[1])), multiply(w, z[2]));
        const Doubles t = divide(multiply(shear_z, weighted), determinant);
        const Doubles size =
            add(add(add(absolute(x[0]), absolute(y[0])), add(absolute(x[1]), absolute(y[1]))),
                add(absolute(x[2]), absolute(y[2])));
        const Doubles depth =
            subtract(greater(greater(z[0], z[1]), z[2]), lesser(lesser(z[0], z[1]), z[2]));
        const Doubles magnitude = absolute(determinant);
        const Doubles least = lesser(lesser(u, v), w);
        const Doubles most = greater(greater(u, v), w);
        const std::uint32_t clear =
            at_most_bits(multiply(size, greater(size, multiply(broadcast(4.0), depth))),
                         multiply(broadcast(64.0), magnitude)) &
            ~at_most_bits(magnitude, zero);
        const std::uint32_t inside = at_most_bits(zero, least) | at_most_bits(most, zero);
        const std::uint32_t between = at_most_bits(zero, t) & at_most_bits(t, load(pairs.most + i));
        verdicts.clear |= clear << i;
        verdicts.hit |= (inside & between) << i;
        // Adding 0 turns -0 into 0.
        store(add(t, zero), verdicts.t + i);
        store(add(divide(v, determinant), zero), verdicts.u + i);
        store(add(divide(w, determinant), zero), verdicts.v + i);
    }
}

/// Triangles that rays may hit, decided a few later, when the memory has brought them.
class DecisionQueue {
public:
    /// Precondition: hits[i] is what is already known of rays[i].
    DecisionQueue(const geometry::MeshView& mesh,
                  std::span<const geometry::Ray> rays,
                  std::span<std::optional<geometry::Hit>> hits,
                  double reach)
        : mesh_(mesh), rays_(rays), hits_(hits), reach_(reach) {}

    HWY_INLINE void push(std::size_t ray, std::uint32_t triangle) {
        __builtin_prefetch(&mesh_.triangles[triangle]);
        pending_[last_ % kRing] = {static_cast<std::uint32_t>(ray), triangle};
        ++last_;
        if (last_ - first_ == kRing) {
            decide_next(Pairs::kMost);
        }
        if (last_ % Pairs::kMost == 0 && last_ - first_ >= 2 * Pairs::kMost) {
            fetch_corners(last_ - 2 * Pairs::kMost);
        }
    }

    /// Decides what is left.
    HWY_INLINE void finish() {
        while (first_ != last_) {
            decide_next(std::min(last_ - first_, Pairs::kMost));
        }
    }

private:
    static constexpr std::size_t kRing = 4 * Pairs::kMost;
    struct Pair {
        std::uint32_t ray, triangle;
    };

    HWY_INLINE void fetch_corners(std::size_t first) const {
        for (std::size_t i = first; i < first + Pairs::kMost; ++i) {
            for (const geometry::VertexId corner : mesh_.triangles[pending_[i % kRing].triangle]) {
                __builtin_prefetch(&mesh_.positions[corner]);
            }
        }
    }

    HWY_INLINE void decide_next(std::size_t count) {
        for (std::size_t i = 0; i < Pairs::kMost; ++i) {
            gather(pending_[(first_ + std::min(i, count - 1)) % kRing], i);
        }
        Verdicts verdicts;
        decide(pairs_, verdicts);
        for (std::size_t i = 0; i < count; ++i) {
            const Pair& pair = pending_[(first_ + i) % kRing];
            if ((verdicts.clear >> i & 1U) == 0) {
                decide_alone(pair);
            } else if ((verdicts.hit >> i & 1U) != 0) {
                keep({pair.triangle, verdicts.t[i], verdicts.u[i], verdicts.v[i]}, hits_[pair.ray]);
            }
        }
        first_ += count;
    }

    HWY_INLINE void gather(const Pair& pair, std::size_t lane) {
        const geometry::Ray& ray = rays_[pair.ray];
        const double* d = glm::value_ptr(ray.direction);
        const double* o = glm::value_ptr(ray.origin);
        const double size = std::max({std::abs(d[0]), std::abs(d[1]), std::abs(d[2])});
        std::size_t axis[3];
        axis[2] = std::abs(d[0]) == size ? 0 : std::abs(d[1]) == size ? 1 : 2;
        axis[0] = axis[2] == 2 ? 0 : axis[2] + 1;
        axis[1] = axis[0] == 2 ? 0 : axis[0] + 1;
        const geometry::Triangle& triangle = mesh_.triangles[pair.triangle];
        for (std::size_t k = 0; k < 3; ++k) {
            pairs_.origin[k][lane] = o[axis[k]];
            pairs_.direction[k][lane] = d[axis[k]];
        }
        for (std::size_t corner = 0; corner < 3; ++corner) {
            const double* position = glm::value_ptr(mesh_.positions[triangle[corner]]);
            for (std::size_t k = 0; k < 3; ++k) {
                pairs_.corner[corner][k][lane] = position[axis[k]];
            }
        }
        pairs_.most[lane] = ray.t_max;
    }

    HWY_INLINE static void keep(const geometry::Hit& hit, std::optional<geometry::Hit>& best) {
        if (!best || hit.t < best->t || (hit.t == best->t && hit.triangle < best->triangle)) {
            best = hit;
        }
    }

    void decide_alone(const Pair& pair) {
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
    std::size_t first_ = 0, last_ = 0;  // of what was pushed: not yet decided
    Pair pending_[kRing];
    Pairs pairs_;
};

}  // namespace earshot::bvh::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
