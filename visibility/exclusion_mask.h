// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/types.h"

#include <cstdint>
#include <span>
#include <vector>

namespace earshot::visibility {

/// The triangles that a query treats as absent: panes of glass, say, or the surface that the end of
/// a line of sight lies on. One bit per triangle; a mask may be shared by any number of queries.
class ExclusionMask {
public:
    ExclusionMask() = default;  ///< excludes no triangle

    /// Excludes the triangles that have one of `materials`; `material_of_triangle` holds the index
    /// of each triangle's material.
    static ExclusionMask of_materials(std::span<const std::uint32_t> material_of_triangle,
                                      std::span<const std::uint32_t> materials);

    void add(geometry::TriangleId triangle);

    bool is_empty() const noexcept { return bits_.empty(); }
    bool contains(geometry::TriangleId triangle) const noexcept {
        const std::size_t word = triangle / kWordBits;
        return word < bits_.size() && (bits_[word] >> triangle % kWordBits & 1U) != 0;
    }

private:
    static constexpr std::size_t kWordBits = 64;

    std::vector<std::uint64_t> bits_;
};

}  // namespace earshot::visibility
