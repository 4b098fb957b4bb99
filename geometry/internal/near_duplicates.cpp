// SPDX-License-Identifier: MIT
#include "earshot/geometry/internal/near_duplicates.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>

namespace earshot::geometry {
namespace {

/// A triangle whose smallest height is at least so many tolerances has corners that a shift of one
/// tolerance each cannot exchange, nor turn it over.
constexpr double kMinHeightInTolerances = 8.0;

bool is_higher_than(const std::array<Vec3, 3>& p, double height) noexcept {
    const Vec3 normal = glm::cross(p[1] - p[0], p[2] - p[0]);
    const Vec3 a = p[1] - p[0];
    const Vec3 b = p[2] - p[1];
    const Vec3 c = p[0] - p[2];
    const double longest = std::max({glm::dot(a, a), glm::dot(b, b), glm::dot(c, c)});
    return glm::dot(normal, normal) > height * height * longest;
}

/// Whether the corners of a lie within the tolerance of those of b, in some order.
bool corners_agree(const std::array<Vec3, 3>& a,
                   const std::array<Vec3, 3>& b,
                   double tolerance) noexcept {
    const auto close = [&](const Vec3& p, const Vec3& q) {
        return glm::dot(p - q, p - q) <= tolerance * tolerance;
    };
    for (std::size_t first = 0; first < 3; ++first) {
        const std::size_t second = (first + 1) % 3;
        const std::size_t third = (first + 2) % 3;
        if (close(a[0], b[first]) && ((close(a[1], b[second]) && close(a[2], b[third])) ||
                                      (close(a[1], b[third]) && close(a[2], b[second])))) {
            return true;
        }
    }
    return false;
}

}  // namespace

// The means of their corners lie within the tolerance as well, and so do, but for a factor, the
// means' positions along any direction. The direction has no rational relation between its
// coordinates, so that few triangles of a model lie side by side along it.
std::vector<std::pair<TriangleId, TriangleId>> find_near_duplicates(
    const MeshView& mesh, std::span<const TriangleId> candidates, double tolerance) {
    constexpr Vec3 kDirection = {1.0, 0.7548776662466927, 0.5698402909980532};
    constexpr double kWindow = 1.5;  // more than the length of the direction
    const auto corners_of = [&](TriangleId id) {
        const auto [a, b, c] = mesh.triangles[id];
        return std::array<Vec3, 3>{mesh.positions[a], mesh.positions[b], mesh.positions[c]};
    };
    std::vector<std::pair<double, TriangleId>> along;
    for (const TriangleId id : candidates) {
        const auto p = corners_of(id);
        if (is_higher_than(p, kMinHeightInTolerances * tolerance)) {
            along.emplace_back(glm::dot(kDirection, p[0] + p[1] + p[2]) / 3.0, id);
        }
    }
    std::sort(along.begin(), along.end());
    std::vector<std::pair<TriangleId, TriangleId>> pairs;
    for (std::size_t i = 0; i < along.size(); ++i) {
        const auto& [position, id] = along[i];
        for (std::size_t k = i + 1;
             k < along.size() && along[k].first - position <= kWindow * tolerance;
             ++k) {
            const TriangleId other = along[k].second;
            if (corners_agree(corners_of(id), corners_of(other), tolerance)) {
                pairs.emplace_back(std::max(id, other), std::min(id, other));
            }
        }
    }
    std::sort(pairs.begin(), pairs.end());
    return pairs;
}

}  // namespace earshot::geometry
