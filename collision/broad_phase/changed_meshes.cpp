// SPDX-License-Identifier: MIT
#include "earshot/collision/broad_phase/internal/changed_meshes.h"

namespace earshot::collision {

std::vector<std::uint32_t> ChangedMeshes::take(const MovingScene& scene) {
    seen_.resize(scene.meshes(), 0);
    std::vector<std::uint32_t> changed;
    for (std::uint32_t mesh = 0; mesh < scene.meshes(); ++mesh) {
        if (seen_[mesh] != scene.revisions[mesh]) {
            seen_[mesh] = scene.revisions[mesh];
            changed.push_back(mesh);
        }
    }
    return changed;
}

std::vector<IndexRange> joined(std::vector<IndexRange> ranges) {
    std::erase_if(ranges, [](const IndexRange& range) { return range.begin == range.end; });
    std::sort(ranges.begin(), ranges.end(), [](const IndexRange& a, const IndexRange& b) {
        return a.begin < b.begin;
    });
    std::vector<IndexRange> result;
    for (const IndexRange& range : ranges) {
        if (!result.empty() && result.back().end == range.begin) {
            result.back().end = range.end;
        } else {
            result.push_back(range);
        }
    }
    return result;
}

}  // namespace earshot::collision
