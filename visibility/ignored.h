// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/types.h"

#include <cstdint>
#include <span>
#include <vector>

namespace earshot::visibility {

/// Triangles that a line of sight passes as if they were not there: panes of glass, say, or the
/// surface that its end lies on. One bit per triangle; may be shared by any number of queries.
class Ignored {
public:
    Ignored() = default;  ///< nothing

    /// The triangles that have one of these materials, of `material_of_triangle`, an index per
    /// triangle.
    static Ignored materials(std::span<const std::uint32_t> material_of_triangle,
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
