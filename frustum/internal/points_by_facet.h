// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/frustum/internal/aperture_test.h"
#include "earshot/geometry/facets.h"

#include <algorithm>
#include <iterator>
#include <limits>
#include <span>
#include <vector>

namespace earshot::frustum {

/// Items sorted by facet, each with a point, laid out for ApertureTest: the number of each facet's
/// points is a multiple of eight, padded with points whose coordinates are not numbers.
template <typename Item>
class PointsByFacet {
public:
    struct Entry {
        geometry::FacetId facet = 0;
        geometry::Vec3 point{0.0};
        Item item;
    };

    PointsByFacet() = default;

    /// Entries in any order; those of a facet keep theirs.
    PointsByFacet(std::size_t facets, std::span<const Entry> entries) {
        std::vector<std::uint32_t> counts(facets, 0);
        for (const Entry& entry : entries) {
            ++counts[entry.facet];
        }
        first_block_.assign(facets + 1, 0);
        for (std::size_t i = 0; i < facets; ++i) {
            first_block_[i + 1] =
                first_block_[i] + static_cast<std::uint32_t>(chunk_count(counts[i], kWidth));
        }
        PointBlock empty;
        for (auto& coordinates : empty.coordinate) {
            std::fill(std::begin(coordinates),
                      std::end(coordinates),
                      std::numeric_limits<double>::quiet_NaN());
        }
        blocks_.assign(first_block_.back(), empty);
        items_.resize(kWidth * blocks_.size());
        std::fill(counts.begin(), counts.end(), 0);
        for (const Entry& entry : entries) {
            const std::size_t slot = kWidth * first_block_[entry.facet] + counts[entry.facet]++;
            items_[slot] = entry.item;
            for (int k = 0; k < 3; ++k) {
                blocks_[slot / kWidth].coordinate[k][slot % kWidth] = entry.point[k];
            }
        }
    }

    /// Item i of a facet belongs to point i % 8 of its block i / 8.
    std::span<const Item> items(geometry::FacetId facet) const noexcept {
        return std::span(items_).subspan(kWidth * first_block_[facet],
                                         kWidth * (first_block_[facet + 1] - first_block_[facet]));
    }
    std::span<const PointBlock> blocks(geometry::FacetId facet) const noexcept {
        return std::span(blocks_).subspan(first_block_[facet],
                                          first_block_[facet + 1] - first_block_[facet]);
    }

private:
    static constexpr std::size_t kWidth = PointBlock::kWidth;
    std::vector<std::uint32_t> first_block_;  // per facet, and one past the last
    std::vector<Item> items_;
    std::vector<PointBlock> blocks_;
};

}  // namespace earshot::frustum
