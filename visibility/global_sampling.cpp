// SPDX-License-Identifier: MIT
#include "earshot/visibility/global_sampling.h"

#include "earshot/base/assert.h"
#include "earshot/base/error.h"
#include "earshot/visibility/internal/global_sampler.h"

#include <algorithm>
#include <string>

namespace earshot::visibility {

namespace {

constexpr std::size_t kMaxBits = std::size_t{1} << 35U;

}  // namespace

GlobalPvs sample_cells(const bvh::MeshBvh& bvh,
                       const Objects& objects,
                       const ViewCells& cells,
                       const GlobalSamplingOptions& options,
                       Executor& executor) {
    EARSHOT_ASSERT(objects.object_of_triangle().size() == bvh.mesh().triangles.size());
    if (objects.size() > kMaxBits / cells.size()) {
        throw Error("visible sets",
                    std::to_string(cells.size()) + " cells of " + std::to_string(objects.size()) +
                        " objects take more than 4 GiB",
                    "choose fewer cells or larger objects");
    }
    if (std::none_of(options.distributions.begin(), options.distributions.end(), [](bool is_on) {
            return is_on;
        })) {
        throw Error("visible sets", "no distribution of samples is allowed", "allow one");
    }
    return GlobalSampler(bvh, objects, cells, options, executor).run();
}

}  // namespace earshot::visibility
