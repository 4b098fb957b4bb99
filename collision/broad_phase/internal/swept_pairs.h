// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/collision/broad_phase/internal/bvtt_front.h"
#include "earshot/collision/broad_phase/internal/swept_bvh.h"

#include <cstdint>

namespace earshot::collision {

/// The tester of a SelfTraversal of a SweptBvh, for a tester of its triangles that has
///   bool accepts(mesh, mesh)          whether contacts of two meshes are requested,
///   bool is_contact_free(node)        whether no two triangles below a node are in contact,
///   bool disjoint_leaves(node, node)  whether no triangles of two leaves are in contact,
///   void test(slot, slot)             called for every pair of slots whose boxes overlap.
template <class Tester>
class SweptPairs {
public:
    SweptPairs(const SweptBvh& swept_bvh, Tester tester)
        : swept_bvh_(&swept_bvh), tester_(std::move(tester)) {}

    bool culls(std::uint32_t a, std::uint32_t b) const {
        const std::uint32_t mesh_a = swept_bvh_->mesh_of_node(a);
        const std::uint32_t mesh_b = swept_bvh_->mesh_of_node(b);
        if (mesh_a != SweptBvh::kMixedMeshes && mesh_b != SweptBvh::kMixedMeshes &&
            !tester_.accepts(mesh_a, mesh_b)) {
            return true;
        }
        return a == b && tester_.is_contact_free(a);
    }

    std::uint64_t test_leaves(std::uint32_t a, std::uint32_t b) {
        if (a != b && tester_.disjoint_leaves(a, b)) {
            return 0;
        }
        std::uint64_t box_tests = 0;
        const SlotRange left = swept_bvh_->slots_of_node(a);
        const SlotRange right = swept_bvh_->slots_of_node(b);
        for (std::uint32_t i = left.begin; i < left.end; ++i) {
            for (std::uint32_t k = a == b ? i + 1 : right.begin; k < right.end; ++k) {
                ++box_tests;
                if (SelfTraversal<SweptPairs>::overlap(swept_bvh_->box(i), swept_bvh_->box(k))) {
                    tester_.test(i, k);
                }
            }
        }
        return box_tests;
    }

    Tester& tester() noexcept { return tester_; }

private:
    const SweptBvh* swept_bvh_;
    Tester tester_;
};

}  // namespace earshot::collision
