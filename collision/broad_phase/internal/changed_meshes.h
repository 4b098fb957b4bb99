// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/collision/internal/moving_scene.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace earshot::collision {

/// Tells what follows a scene from step to step which meshes it has to follow.
class ChangedMeshes {
public:
    /// The meshes that do not move as they did at the last call, ascending; at the first call and
    /// after reset() all of them.
    std::vector<std::uint32_t> take(const MovingScene& scene);

    void reset() noexcept { seen_.clear(); }

private:
    std::vector<std::uint64_t> seen_;  // revisions by mesh
};

/// Ascending, adjacent ranges joined, empty ones left out. Precondition: they do not overlap.
std::vector<IndexRange> joined(std::vector<IndexRange> ranges);

/// joined() of the range of every mesh.
template <typename RangeOf>
std::vector<IndexRange> ranges_of(std::span<const std::uint32_t> meshes, RangeOf&& range_of) {
    std::vector<IndexRange> ranges;
    for (const std::uint32_t mesh : meshes) {
        ranges.push_back(range_of(mesh));
    }
    return joined(std::move(ranges));
}

/// Runs visit(index) for every index of the ranges, in chunks of so many.
template <typename Visit>
void for_each_index(std::span<const IndexRange> ranges,
                    std::size_t grain,
                    Executor& executor,
                    Visit&& visit) {
    std::vector<std::size_t> ends;  // of the ranges, counting their indices
    std::size_t count = 0;
    for (const IndexRange& range : ranges) {
        count += range.end - range.begin;
        ends.push_back(count);
    }
    executor.for_each(count, grain, [&](std::size_t from, std::size_t to) {
        auto at = static_cast<std::size_t>(std::upper_bound(ends.begin(), ends.end(), from) -
                                           ends.begin());
        for (std::size_t i = from; i < to; ++at) {
            const std::size_t stop = std::min(to, ends[at]);
            auto index = ranges[at].end - static_cast<std::uint32_t>(ends[at] - i);
            for (; i < stop; ++i, ++index) {
                visit(index);
            }
        }
    });
}

}  // namespace earshot::collision
