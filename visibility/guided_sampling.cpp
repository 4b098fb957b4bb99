// SPDX-License-Identifier: MIT
#include "earshot/visibility/guided_sampling.h"

#include "earshot/geometry/overlap.h"
#include "earshot/visibility/internal/guided_sampler.h"

namespace earshot::visibility {

using geometry::TriangleId;

RegionPvs sample_region(const bvh::MeshBvh& bvh,
                        const ViewRegion& region,
                        const GuidedSamplingOptions& options,
                        Executor& executor) {
    validate(region);
    GuidedSampler sampler(bvh, region, options, executor);
    RegionPvs pvs = sampler.run();
    const geometry::BoxRegion box(region.lower, region.upper);
    for (std::size_t i = 0; i < bvh.mesh().triangles.size(); ++i) {
        const auto id = static_cast<TriangleId>(i);
        const auto [a, b, c] = bvh.corners(static_cast<geometry::TriangleId>(i));
        const bool is_inside = box.touches(a, b, c);
        if (!sampler.excluded().contains(id) && (sampler.is_known(id) || is_inside)) {
            pvs.triangles.push_back(id);
            pvs.witnesses.push_back(sampler.is_known(id)
                                        ? sampler.witness_of(id)
                                        : geometry::Ray{region.lower, {0.0, 0.0, -1.0}, 0.0});
        }
    }
    return pvs;
}

}  // namespace earshot::visibility
