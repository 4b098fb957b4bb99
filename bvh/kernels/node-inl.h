// SPDX-License-Identifier: MIT
//
// Slab tests of a ray against the children of wide nodes, and the traversal stack, compiled once
// per instruction set.

#include "earshot/base/simd/float_lanes-inl.h"
#include "earshot/bvh/internal/float_ray.h"
#include "earshot/bvh/tree.h"
#include "earshot/bvh/wide_tree.h"
#include "earshot/geometry/mesh.h"

#include <glm/gtc/type_ptr.hpp>

#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>

#if defined(EARSHOT_BVH_KERNELS_NODE_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef EARSHOT_BVH_KERNELS_NODE_INL_H
#undef EARSHOT_BVH_KERNELS_NODE_INL_H
#else
#define EARSHOT_BVH_KERNELS_NODE_INL_H
#endif

HWY_BEFORE_NAMESPACE();
namespace earshot::bvh::HWY_NAMESPACE {

using namespace earshot::HWY_NAMESPACE;  // NOLINT: the lanes

// Every node on the path down leaves at most seven children on the stack, and compress_ordered()
// writes eight.
constexpr std::size_t kMaxStackSize = (WideNode::kWidth - 1) * (kMaxDepth + 1) + WideNode::kWidth;

/// The axis-aligned plane that an excluded triangle lies in.
struct ExcludedPlane {
    std::uint32_t planes = 0;  ///< first of the axis in WideNode::planes
    /// Its coordinate along the axis; not a number: the triangle lies in no such plane, or the
    /// coordinate is no float.
    float at = std::numeric_limits<float>::quiet_NaN();

    ExcludedPlane() = default;
    /// Free of branches, which depend on the triangle and mispredict.
    HWY_INLINE ExcludedPlane(const geometry::MeshView& mesh, std::uint32_t triangle) {
        const geometry::Triangle& corners = mesh.triangles[triangle];
        const Double4 a = load_three(glm::value_ptr(mesh.positions[corners[0]]));
        const Double4 b = load_three(glm::value_ptr(mesh.positions[corners[1]]));
        const Double4 c = load_three(glm::value_ptr(mesh.positions[corners[2]]));
        const Float4 rounded = round_to_float(a);
        const Double4 exact = to_double(rounded);
        const Double4 lowest = min(min(a, b), min(c, exact));
        const Double4 highest = max(max(a, b), max(c, exact));
        const std::uint32_t flat_axes = bits(highest <= lowest) & 7U;
        // The last of them; without one, the padding.
        constexpr std::uint32_t kNone = 3;
        const std::uint32_t none = flat_axes == 0 ? kNone + 1 : 0;
        const std::uint32_t k = static_cast<std::uint32_t>(std::bit_width(flat_axes)) + none - 1;
        alignas(16) float coordinates[4];
        rounded.store(coordinates);
        coordinates[kNone] = std::numeric_limits<float>::quiet_NaN();
        at = coordinates[k];
        constexpr std::uint32_t kFirstPlanes[] = {0, 2 * WideNode::kWidth, 4 * WideNode::kWidth, 0};
        planes = kFirstPlanes[k];
    }
};

/// Where a ray enters and leaves the children of a node; it passes those that it does not leave
/// before it enters them.
struct SlabIntervals {
    Float8 near, far;
};

/// The slab test (Kay and Kajiya 1986) of a ray against the eight children of a wide node.
class SlabTest {
public:
    explicit SlabTest(const FloatRay& ray)
        : ray_(ray),
          inverse_{Float8(ray.inverse[0]), Float8(ray.inverse[1]), Float8(ray.inverse[2])},
          offset_near_{
              Float8(ray.offset_near[0]), Float8(ray.offset_near[1]), Float8(ray.offset_near[2])},
          offset_far_{
              Float8(ray.offset_far[0]), Float8(ray.offset_far[1]), Float8(ray.offset_far[2])} {}

    HWY_INLINE SlabIntervals operator()(const WideNode& node, const Float8& bound) const {
        const float* planes = node.planes[0];
        Float8 near[3], far[3];
        for (std::size_t k = 0; k < 3; ++k) {
            near[k] =
                mul_add(Float8::load(planes + ray_.planes.near[k]), inverse_[k], offset_near_[k]);
            far[k] =
                mul_add(Float8::load(planes + ray_.planes.far[k]), inverse_[k], offset_far_[k]);
        }
        return {max(max(near[0], near[1]), max(near[2], Float8(0.0F))),
                min(min(far[0], far[1]), min(far[2], bound))};
    }

    /// For a loop without calls of other functions.
    HWY_INLINE void keep() {
        for (std::size_t k = 0; k < 3; ++k) {
            keep_in_registers(inverse_[k]);
            keep_in_registers(offset_near_[k]);
            keep_in_registers(offset_far_[k]);
        }
    }

private:
    const FloatRay& ray_;
    Float8 inverse_[3], offset_near_[3], offset_far_[3];
};

/// The slab test of a secondary ray whose excluded (origin) triangle lies in an axis-aligned plane:
/// children that are coplanar with it are skipped, because the ray goes away from that plane.
class SlabTestSkippingCoplanar {
public:
    SlabTestSkippingCoplanar(const FloatRay& ray, const ExcludedPlane& excluded)
        : slab_test_(ray), planes_(excluded.planes), at_(Float8(excluded.at)) {}

    HWY_INLINE SlabIntervals operator()(const WideNode& node, const Float8& bound) const {
        const auto [near, far] = slab_test_(node, bound);
        const float* planes = node.planes[0] + planes_;
        const Float8::Mask is_coplanar =
            (at_ <= Float8::load(planes)) & (Float8::load(planes + WideNode::kWidth) <= at_);
        return {near, select(is_coplanar, Float8(-1.0F), far)};
    }

private:
    SlabTest slab_test_;
    std::uint32_t planes_;
    Float8 at_;
};

/// The traversal stack of one ray or packet: the children still to be visited and where they begin.
struct TraversalStack {
    std::size_t count = 0;
    std::uint32_t current = 0;  // to be visited next
    alignas(32) float entry_near[kMaxStackSize];
    std::uint32_t entry[kMaxStackSize];

    /// Pushes the children of a node that are entered, the closest on top.
    HWY_INLINE void push(const SlabIntervals& intervals, const WideNode& node, int shift) {
        count += compress_ordered(intervals.near,
                                  intervals.far,
                                  node.child,
                                  node.order,
                                  shift,
                                  entry_near + count,
                                  entry + count);
    }

    /// The same, in any order.
    HWY_INLINE void push_unordered(const SlabIntervals& intervals, const WideNode& node) {
        count += compress(intervals.near,
                          intervals.near <= intervals.far,
                          node.child,
                          entry_near + count,
                          entry + count);
    }

    /// Pops the next child that begins before `bound` into `current`; false if there is none.
    HWY_INLINE bool pop(float bound) {
        do {
            if (count == 0) {
                return false;
            }
            --count;
        } while (entry_near[count] > bound);
        current = entry[count];
        return true;
    }

    /// Removes the children that begin beyond `bound`. Where a bound falls rarely this is faster
    /// than a comparison in every pop, of which the result is hard to predict.
    HWY_INLINE void remove_beyond(float bound) {
        const std::size_t end = count;
        count = 0;
        for (std::size_t i = 0; i < end; i += Float8::kCount) {
            const Float8 near = Float8::load(entry_near + i);
            count += compress(near,
                              Float8::Mask::first(end - i) & (near <= Float8(bound)),
                              entry + i,
                              entry_near + count,
                              entry + count);
        }
    }

    /// Pops the next child, wherever it begins.
    HWY_INLINE bool pop_any() {
        if (count == 0) {
            return false;
        }
        current = entry[--count];
        return true;
    }
};

/// The stack of one ray that is traversed alone: as TraversalStack, but its count and its current
/// child are variables of the loop, which a compiler keeps in registers.
struct SingleRayStack {
    alignas(32) float entry_near[kMaxStackSize];
    std::uint32_t entry[kMaxStackSize];
};

/// Visits the leaves that one ray passes, the children of a node in their order along it;
/// `visit_leaf(leaf)` returns the bound from then on. The nodes between two leaves are a loop of
/// their own, so that what their tests need stays in registers.
template <typename VisitLeaf>
HWY_INLINE void traverse_single_ray(const WideNode* nodes,
                                    const FloatRay& ray,
                                    float bound,
                                    VisitLeaf&& visit_leaf) {
    SingleRayStack stack;
    std::size_t count = 0;
    std::uint32_t current = 0;
    const auto pop = [&] {
        do {
            if (count == 0) {
                return false;
            }
            --count;
        } while (stack.entry_near[count] > bound);
        current = stack.entry[count];
        return true;
    };
    do {
        SlabTest slab_test(ray);
        slab_test.keep();
        const Float8 bounds = Float8(bound);
        while (!is_leaf(current)) {
            const WideNode& node = nodes[current];
            const SlabIntervals intervals = slab_test(node, bounds);
            const std::uint32_t lanes = bits(intervals.near <= intervals.far);
            if (std::has_single_bit(lanes)) {
                current = node.child[std::countr_zero(lanes)];
            } else if (lanes != 0) {
                count += compress_before_last(intervals.near,
                                              intervals.far,
                                              node.child,
                                              node.order,
                                              ray.order_shift,
                                              stack.entry_near + count,
                                              stack.entry + count,
                                              current);
            } else if (!pop()) {
                return;
            }
        }
        bound = visit_leaf(current);
    } while (pop());
}

/// Visits the leaves that one segment passes, in any order, until `visit_leaf(leaf)` is true; false
/// if it never is. The only child and one of several are not told apart by a branch, which would
/// often be mispredicted.
template <typename VisitLeaf>
HWY_INLINE bool traverse_single_segment(const WideNode* nodes,
                                        const FloatRay& ray,
                                        VisitLeaf&& visit_leaf) {
    std::uint32_t entry[kMaxStackSize];
    std::size_t count = 0;
    std::uint32_t current = 0;
    for (;;) {
        SlabTest slab_test(ray);
        slab_test.keep();
        const Float8 bounds = Float8(ray.t_max);
        while (!is_leaf(current)) {
            const WideNode& node = nodes[current];
            const SlabIntervals intervals = slab_test(node, bounds);
            const std::uint32_t lanes = bits(intervals.near <= intervals.far);
            if (lanes != 0) {
                current = node.child[std::countr_zero(lanes)];
                count += compress_words(lanes & (lanes - 1), node.child, entry + count);
            } else if (count == 0) {
                return false;
            } else {
                current = entry[--count];
            }
        }
        if (visit_leaf(current)) {
            return true;
        }
        if (count == 0) {
            return false;
        }
        current = entry[--count];
    }
}

}  // namespace earshot::bvh::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
