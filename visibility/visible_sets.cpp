// SPDX-License-Identifier: MIT
#include "earshot/visibility/visible_sets.h"

#include "earshot/base/digest.h"
#include "earshot/base/error.h"
#include "earshot/visibility/merge_cells.h"

#include <algorithm>
#include <functional>
#include <utility>

namespace earshot::visibility {

using geometry::TriangleId;

std::uint64_t mesh_digest(const geometry::MeshView& mesh) noexcept {
    Digest digest;
    digest.add_bytes(std::as_bytes(mesh.positions));
    digest.add_bytes(std::as_bytes(mesh.triangles));
    return digest.value();
}

VisibleSets::VisibleSets(ViewCells cells,
                         Objects objects,
                         std::vector<std::vector<ObjectId>> sets,
                         SetsProvenance provenance,
                         std::optional<MergeHistory> history)
    : cells_(std::move(cells)),
      objects_(std::move(objects)),
      sets_(std::move(sets)),
      provenance_(std::move(provenance)),
      history_(std::move(history)) {
    const auto is_set = [&](const std::vector<ObjectId>& set) {
        return std::adjacent_find(set.begin(), set.end(), std::greater_equal<>()) == set.end() &&
               (set.empty() || set.back() < objects_.size());
    };
    if (sets_.size() != cells_.size() || !std::all_of(sets_.begin(), sets_.end(), is_set) ||
        (history_ && history_->leaves() != cells_.size())) {
        throw Error(
            "visible sets", "sets, cells and objects do not fit together", "build them again");
    }
}

std::uint64_t VisibleSets::entries() const noexcept {
    std::uint64_t sum = 0;
    for (const std::vector<ObjectId>& set : sets_) {
        sum += set.size();
    }
    return sum;
}

bool VisibleSets::contains(CellId cell, TriangleId triangle) const noexcept {
    const std::vector<ObjectId>& set = sets_[cell];
    return std::binary_search(set.begin(), set.end(), objects_.of(triangle));
}

std::vector<TriangleId> VisibleSets::triangles_visible_from(CellId cell) const {
    std::vector<TriangleId> triangles;
    for (const ObjectId object : sets_[cell]) {
        const auto members = objects_.triangles_of(object);
        triangles.insert(triangles.end(), members.begin(), members.end());
    }
    std::sort(triangles.begin(), triangles.end());
    return triangles;
}

VisibleSets VisibleSets::merged(std::size_t cells) const {
    if (!history_) {
        throw Error(
            "visible sets", "how their cells merge is not known", "build them with --cells");
    }
    const std::vector<CellId> cell_of_group = history_->extract(cells);
    std::vector<CellId> cell_of_leaf;
    for (const CellId cell : cells_.cell_of_leaf()) {
        cell_of_leaf.push_back(cell_of_group[cell]);
    }
    return {cells_.merged(std::move(cell_of_leaf)),
            objects_,
            merged_sets(sets_, cell_of_group),
            provenance_};
}

}  // namespace earshot::visibility
