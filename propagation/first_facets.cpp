// SPDX-License-Identifier: MIT
#include "earshot/propagation/internal/first_facets.h"

#include <algorithm>
#include <optional>

namespace earshot::propagation {

std::vector<std::uint8_t> first_facets(const visibility::VisibleSets* sets,
                                       const SceneGeometry& geometry,
                                       const geometry::Vec3& source,
                                       Executor& executor) {
    const auto cell = sets != nullptr ? sets->cells().cell_at(source) : std::nullopt;
    if (!cell) {
        return {};
    }
    std::vector<std::uint8_t> is_first;
    for (const geometry::Facet& facet : geometry.facets(executor).facets) {
        is_first.push_back(std::any_of(facet.triangles.begin(),
                                       facet.triangles.end(),
                                       [&](geometry::TriangleId triangle) {
                                           return sets->contains(*cell, geometry.kept()[triangle]);
                                       })
                               ? 1
                               : 0);
    }
    return is_first;
}

}  // namespace earshot::propagation
