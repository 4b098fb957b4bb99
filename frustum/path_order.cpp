// SPDX-License-Identifier: MIT
#include "earshot/frustum/internal/path_order.h"

#include "earshot/frustum/internal/facet_index.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <tuple>

namespace earshot::frustum {

using geometry::Vec3;

namespace {

// By listener, length, order, triangles.
bool comes_first(const SpecularPath& a, const SpecularPath& b) {
    const auto key = [](const SpecularPath& path) {
        return std::tuple(path.listener, path.length, path.triangles.size());
    };
    return key(a) != key(b) ? key(a) < key(b) : a.triangles < b.triangles;
}

}  // namespace

void sort_and_unify(std::vector<SpecularPath>& paths, double scale) {
    std::sort(paths.begin(), paths.end(), comes_first);
    std::vector<bool> repeated(paths.size(), false);
    for (std::size_t i = 0; i < paths.size(); ++i) {
        // Reflection points of one way found twice differ by the verifier's slack at a corner.
        const double slack = 64.0 * kRounding * (scale + paths[i].length);
        const auto same_way = [&](const SpecularPath& other) {
            return std::equal(
                paths[i].points.begin(),
                paths[i].points.end(),
                other.points.begin(),
                other.points.end(),
                [&](const Vec3& a, const Vec3& b) { return glm::distance(a, b) <= slack; });
        };
        for (std::size_t j = i + 1; j < paths.size() && !repeated[i]; ++j) {
            if (paths[j].listener != paths[i].listener ||
                paths[j].length - paths[i].length > slack) {
                break;
            }
            if (!repeated[j] && same_way(paths[j])) {
                repeated[paths[j].triangles < paths[i].triangles ? i : j] = true;
            }
        }
    }
    std::size_t kept = 0;
    for (std::size_t i = 0; i < paths.size(); ++i) {
        if (!repeated[i]) {
            if (kept != i) {
                paths[kept] = std::move(paths[i]);
            }
            ++kept;
        }
    }
    paths.resize(kept);
}

}  // namespace earshot::frustum
