// SPDX-License-Identifier: MIT
#include "generated_city.h"

#include "earshot/base/random.h"

#include <cmath>

namespace bench {

using earshot::geometry::Mesh;

Mesh generated_city(std::size_t count) {
    const auto side =
        static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(count) / 2.0)));
    constexpr std::uint64_t kBlock = 24;
    Mesh mesh;
    mesh.positions.reserve((side + 1) * (side + 1));
    mesh.triangles.reserve(2 * side * side);
    for (std::size_t z = 0; z <= side; ++z) {
        for (std::size_t x = 0; x <= side; ++x) {
            const bool is_street = x % kBlock < 6 || z % kBlock < 6;
            const double house = earshot::random(1, x / kBlock, z / kBlock);
            const double rough = 0.2 * earshot::random(2, x, z);
            mesh.positions.emplace_back(static_cast<double>(x),
                                        (is_street ? 0.0 : 5.0 + 40.0 * house) + rough,
                                        static_cast<double>(z));
        }
    }
    for (std::size_t z = 0; z < side; ++z) {
        for (std::size_t x = 0; x < side; ++x) {
            const auto corner = static_cast<earshot::geometry::VertexId>(z * (side + 1) + x);
            const auto below = static_cast<earshot::geometry::VertexId>(corner + side + 1);
            mesh.triangles.push_back({corner, below, corner + 1});
            mesh.triangles.push_back({corner + 1, below, below + 1});
        }
    }
    return mesh;
}

}  // namespace bench
