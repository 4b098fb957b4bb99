// SPDX-License-Identifier: MIT
#include "earshot/visibility/exclusion_mask.h"

#include <algorithm>

namespace earshot::visibility {

ExclusionMask ExclusionMask::of_materials(std::span<const std::uint32_t> material_of_triangle,
                                          std::span<const std::uint32_t> materials) {
    ExclusionMask excluded;
    for (std::size_t i = 0; i < material_of_triangle.size(); ++i) {
        if (std::find(materials.begin(), materials.end(), material_of_triangle[i]) !=
            materials.end()) {
            excluded.add(static_cast<geometry::TriangleId>(i));
        }
    }
    return excluded;
}

void ExclusionMask::add(geometry::TriangleId triangle) {
    const std::size_t word = triangle / kWordBits;
    if (word >= bits_.size()) {
        bits_.resize(word + 1);
    }
    bits_[word] |= std::uint64_t{1} << triangle % kWordBits;
}

}  // namespace earshot::visibility
