// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/collision/broad_phase/internal/bvtt_front.h"
#include "earshot/collision/broad_phase/internal/leaf_slabs.h"
#include "earshot/collision/broad_phase/internal/normal_cones.h"
#include "earshot/collision/broad_phase/internal/swept_bvh.h"
#include "earshot/collision/broad_phase/internal/swept_pairs.h"
#include "earshot/collision/contact_options.h"
#include "earshot/collision/internal/moving_scene.h"
#include "earshot/collision/statistics.h"

#include <cstddef>
#include <cstdint>

namespace earshot::collision {

/// The broad phase of a step: the swept-volume BVH, what culls its pairs, and the front of its
/// BVTT, kept from step to step.
class SweptBroadPhase {
public:
    explicit SweptBroadPhase(bvh::Builder builder = bvh::Builder::binned_sah)
        : swept_bvh_(builder) {}

    /// Follows the scene. Counts what it did to the tree.
    void update(const MovingScene& scene,
                const ContactOptions& options,
                Executor& executor,
                WorldStatistics& statistics);

    const SweptBvh& swept_bvh() const noexcept { return swept_bvh_; }
    const LeafSlabs& leaf_slabs() const noexcept { return leaf_slabs_; }
    /// Null where the options rule them out.
    const NormalCones* normal_cones() const noexcept {
        return uses_normal_cones_ ? &normal_cones_ : nullptr;
    }

    /// Tests all pairs of triangles that are left: new_tester() makes testers of SweptPairs, and
    /// finish(tester) takes them, in rounds of so many tasks. Counts box tests.
    template <typename NewTester, typename Finish>
    void traverse(const ContactOptions& options,
                  std::size_t round,
                  Executor& executor,
                  WorldStatistics& statistics,
                  NewTester&& new_tester,
                  Finish&& finish) {
        const std::uint64_t box_tests = front_.traverse(
            swept_bvh_.tree(),
            options.track_front,
            round,
            executor,
            [&] { return SweptPairs(swept_bvh_, new_tester()); },
            [&](auto& pairs) { finish(pairs.tester()); });
        statistics.box_tests += box_tests;
        statistics.front_nodes += front_.size();
        swept_bvh_.expect_box_tests(box_tests);
    }

private:
    SweptBvh swept_bvh_;
    LeafSlabs leaf_slabs_;
    NormalCones normal_cones_;
    bool has_normal_cones_ = false;  // whether they were built for the present tree
    bool uses_normal_cones_ = false;
    BvttFront front_;
};

}  // namespace earshot::collision
