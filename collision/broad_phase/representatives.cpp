// SPDX-License-Identifier: MIT
#include "earshot/collision/broad_phase/internal/representatives.h"

#include <algorithm>
#include <tuple>

namespace earshot::collision {

using geometry::VertexId;

std::vector<std::uint8_t> representative_features(std::span<const geometry::Triangle> triangles) {
    struct Entry {
        std::array<VertexId, 2> vertices;  // of a corner, both the same
        std::uint32_t triangle;
        std::uint8_t bit;
    };
    std::vector<Entry> entries;
    entries.reserve(6 * triangles.size());
    for (std::uint32_t i = 0; i < triangles.size(); ++i) {
        for (unsigned k = 0; k < 3; ++k) {
            const VertexId from = triangles[i][k];
            const VertexId to = triangles[i][(k + 1) % 3];
            entries.push_back({{from, from}, i, static_cast<std::uint8_t>(1U << k)});
            if (from != to) {
                entries.push_back({{std::min(from, to), std::max(from, to)},
                                   i,
                                   static_cast<std::uint8_t>(1U << (3 + k))});
            }
        }
    }
    std::sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) {
        return std::tie(a.vertices, a.triangle, a.bit) < std::tie(b.vertices, b.triangle, b.bit);
    });
    std::vector<std::uint8_t> representatives(triangles.size(), 0);
    for (std::size_t i = 0; i < entries.size(); ++i) {
        if (i == 0 || entries[i].vertices != entries[i - 1].vertices) {
            representatives[entries[i].triangle] |= entries[i].bit;
        }
    }
    return representatives;
}

std::vector<std::uint8_t> all_features(std::span<const geometry::Triangle> triangles) {
    std::vector<std::uint8_t> all;
    all.reserve(triangles.size());
    for (const geometry::Triangle& triangle : triangles) {
        unsigned bits = 7;
        for (unsigned k = 0; k < 3; ++k) {
            bits |= triangle[k] != triangle[(k + 1) % 3] ? 1U << (3 + k) : 0U;
        }
        all.push_back(static_cast<std::uint8_t>(bits));
    }
    return all;
}

}  // namespace earshot::collision
