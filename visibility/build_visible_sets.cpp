// SPDX-License-Identifier: MIT
#include "earshot/visibility/build_visible_sets.h"

#include "earshot/visibility/build_view_cells.h"
#include "earshot/visibility/global_sampling.h"
#include "earshot/visibility/guided_sampling.h"
#include "earshot/visibility/merge_cells.h"
#include "earshot/visibility/pvs_validation.h"
#include "earshot/visibility/render_cost.h"
#include "earshot/visibility/sample_free_segments.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace earshot::visibility {
namespace {

constexpr std::uint64_t kMinValidationRays = std::uint64_t{1} << 16U;
constexpr std::uint64_t kRaysPerValidationRay = 10;

/// The steps of build_visible_sets().
class SetsBuilder {
public:
    SetsBuilder(const bvh::MeshBvh& bvh,
                const ViewRegion& region,
                const VisibleSetsOptions& options,
                SetsProvenance provenance,
                Executor& executor)
        : bvh_(bvh),
          region_(region),
          options_(options),
          provenance_(std::move(provenance)),
          executor_(executor) {}

    VisibleSets sample_one_cell() {
        GuidedSamplingOptions sampling = {.seed = provenance_.seed,
                                          .progress = options_.progress,
                                          .interrupt = options_.interrupt};
        sampling.max_rays = options_.max_rays.value_or(sampling.max_rays);
        sampling.min_new_triangles = options_.until.value_or(sampling.min_new_triangles);
        const RegionPvs pvs = sample_region(bvh_, region_, sampling, executor_);
        Objects objects = group_triangles();
        std::vector<ObjectId> set;
        for (const geometry::TriangleId triangle : pvs.triangles) {
            set.push_back(objects.of(triangle));
        }
        std::sort(set.begin(), set.end());
        set.erase(std::unique(set.begin(), set.end()), set.end());
        const ViewCells cells(region_);
        std::vector<std::vector<ObjectId>> sets = {std::move(set)};
        complete_provenance(pvs.rays, objects, cells, sets);
        return {cells, std::move(objects), std::move(sets), std::move(provenance_)};
    }

    VisibleSets sample_many_cells() {
        Objects objects = group_triangles();
        ViewCells cells =
            options_.grid ? ViewCells::grid(region_, *options_.grid) : divide_region(objects);
        GlobalSamplingOptions sampling = {.seed = provenance_.seed,
                                          .progress = options_.progress,
                                          .interrupt = options_.interrupt};
        sampling.max_rays = options_.max_rays.value_or(sampling.max_rays);
        sampling.max_growth = options_.until.value_or(sampling.max_growth);
        GlobalPvs pvs = sample_cells(bvh_, objects, cells, sampling, executor_);
        complete_provenance(pvs.rays, objects, cells, pvs.visible);
        MergeHistory history =
            merge_cells(cells, pvs.visible, object_costs(objects), {}, executor_);
        return {std::move(cells),
                std::move(objects),
                std::move(pvs.visible),
                std::move(provenance_),
                std::move(history)};
    }

private:
    Objects group_triangles() const {
        return options_.triangles_per_object == 1
                   ? Objects::triangles(bvh_.mesh().triangles.size())
                   : Objects::groups(bvh_.mesh(), options_.triangles_per_object, executor_);
    }

    ViewCells divide_region(const Objects& objects) const {
        const auto segments = sample_free_segments(bvh_,
                                                   region_,
                                                   {.seed = provenance_.seed,
                                                    .count = options_.segments,
                                                    .skip_solids = options_.skip_solids},
                                                   executor_);
        return build_view_cells(region_,
                                segments,
                                objects,
                                {.max_cells = options_.max_cells,
                                 .mesh = bvh_.mesh(),
                                 .seed = provenance_.seed,
                                 .progress = options_.progress,
                                 .interrupt = options_.interrupt},
                                executor_)
            .cells;
    }

    void complete_provenance(std::uint64_t rays,
                             const Objects& objects,
                             const ViewCells& cells,
                             const std::vector<std::vector<ObjectId>>& sets) {
        provenance_.rays = rays;
        const std::uint64_t validation_rays = options_.validation_rays.value_or(
            std::max(kMinValidationRays, rays / kRaysPerValidationRay));
        if (validation_rays > 0) {
            provenance_.validation = validate_pvs(
                bvh_,
                objects,
                cells,
                sets,
                {.seed = provenance_.seed, .rays = validation_rays, .progress = options_.progress},
                executor_);
        }
    }

    const bvh::MeshBvh& bvh_;
    const ViewRegion& region_;
    const VisibleSetsOptions& options_;
    SetsProvenance provenance_;
    Executor& executor_;
};

}  // namespace

VisibleSets build_visible_sets(const bvh::MeshBvh& bvh,
                               const ViewRegion& region,
                               const VisibleSetsOptions& options,
                               SetsProvenance provenance,
                               Executor& executor) {
    SetsBuilder builder(bvh, region, options, std::move(provenance), executor);
    return options.max_cells > 0 || options.grid ? builder.sample_many_cells()
                                                 : builder.sample_one_cell();
}

ViewRegion region_of(const geometry::Aabb& box) {
    const auto point = [](const auto& p) { return geometry::Vec3(p[0], p[1], p[2]); };
    return box.is_empty() ? ViewRegion{} : ViewRegion{point(box.lower), point(box.upper)};
}

}  // namespace earshot::visibility
