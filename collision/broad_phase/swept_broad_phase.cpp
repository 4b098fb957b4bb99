// SPDX-License-Identifier: MIT
#include "earshot/collision/broad_phase/internal/swept_broad_phase.h"

#include <algorithm>

namespace earshot::collision {

void SweptBroadPhase::update(const MovingScene& scene,
                             const ContactOptions& options,
                             Executor& executor,
                             WorldStatistics& statistics) {
    // 1. The tree; what hangs on its nodes is made anew if these are new.
    if (swept_bvh_.update(scene, options.margin(), executor)) {
        front_.reset();
        has_normal_cones_ = false;
        leaf_slabs_.build(scene, swept_bvh_);
    }
    if (const auto action = swept_bvh_.last_action()) {
        statistics.updates.count(*action);
    }
    // 2. Leaf slabs.
    const double deviation =
        scene.meshes_on_screws == 0
            ? 0.0
            : *std::max_element(scene.deviation.begin(), scene.deviation.end());
    leaf_slabs_.update(scene, swept_bvh_, options.margin() + deviation, executor);
    // 3. Normal cones. A node without self-contact may still hold elements closer than a minimum
    // separation.
    uses_normal_cones_ =
        options.within_meshes && options.cull_with_normal_cones && !(options.min_separation > 0.0);
    if (uses_normal_cones_) {
        if (!has_normal_cones_) {
            normal_cones_.build(scene, swept_bvh_);
            has_normal_cones_ = true;
        }
        normal_cones_.update(scene, swept_bvh_, executor);
    }
}

}  // namespace earshot::collision
