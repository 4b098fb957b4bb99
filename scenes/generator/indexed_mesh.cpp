// SPDX-License-Identifier: MIT
#include "earshot/scenes/indexed_mesh.h"

#include "earshot/base/assert.h"
#include "earshot/base/error.h"

#include <algorithm>
#include <iterator>
#include <limits>

namespace earshot::scenes {

namespace {

using Position = std::array<float, 3>;
using Corner = std::array<Position, 3>;

Position rounded(const Vec3& point) {
    // Adding 0 turns -0 into 0, so that equal points have equal bytes.
    return {static_cast<float>(point.x) + 0.0F,
            static_cast<float>(point.y) + 0.0F,
            static_cast<float>(point.z) + 0.0F};
}

bool before(const Vec3& a, const Vec3& b) {
    return std::array{a.x, a.y, a.z} < std::array{b.x, b.y, b.z};
}

// The point i / n of the way from a to b, the same bits from either end.
Vec3 between(const Vec3& a, const Vec3& b, int i, int n) {
    if (before(b, a)) {
        return between(b, a, n - i, n);
    }
    return i == 0 ? a : i == n ? b : a + (b - a) * (static_cast<double>(i) / n);
}

struct SmallFace {
    std::array<Vec3, 4> corners;
    std::size_t corner_count;
};

void split_quadrilateral(const Face& face, int n, std::vector<SmallFace>& out) {
    const Vec3& a = face.corners[0];
    const Vec3& b = face.corners[1];
    const Vec3& c = face.corners[2];
    const Vec3& d = face.corners[3];
    const auto at = [&](int i, int j) {
        // On the border the edge alone decides.
        if (i == 0 || i == n) {
            return i == 0 ? between(a, d, j, n) : between(b, c, j, n);
        }
        return between(between(a, b, i, n), between(d, c, i, n), j, n);
    };
    for (int j = 0; j < n; ++j) {
        for (int i = 0; i < n; ++i) {
            out.push_back({{at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)}, 4});
        }
    }
}

void split_triangle(const Face& face, int n, std::vector<SmallFace>& out) {
    const Vec3& a = face.corners[0];
    const Vec3& b = face.corners[1];
    const Vec3& c = face.corners[2];
    // Row j has its ends on the sides a-c and b-c; row 0 is the side a-b.
    const auto at = [&](int i, int j) {
        return j == n ? c : between(between(a, c, j, n), between(b, c, j, n), i, n - j);
    };
    for (int j = 0; j < n; ++j) {
        for (int i = 0; i < n - j; ++i) {
            out.push_back({{at(i, j), at(i + 1, j), at(i, j + 1)}, 3});
            if (i + 1 < n - j) {
                out.push_back({{at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)}, 3});
            }
        }
    }
}

std::vector<SmallFace> split(const Face& face, int n) {
    std::vector<SmallFace> out;
    if (face.corner_count == 4) {
        split_quadrilateral(face, n, out);
    } else {
        split_triangle(face, n, out);
    }
    return out;
}

// The displacements of a vertex by all targets, once the positions are final.
std::vector<std::vector<Position>> displacements(const DraftNode& node, std::vector<Vec3> points) {
    std::sort(points.begin(), points.end(), [](const Vec3& a, const Vec3& b) {
        return rounded(a) < rounded(b);
    });
    points.erase(std::unique(points.begin(),
                             points.end(),
                             [](const Vec3& a, const Vec3& b) { return rounded(a) == rounded(b); }),
                 points.end());
    std::vector<std::vector<Position>> result;
    for (const auto& morph : node.morphs) {
        std::vector<Position> displaced;
        std::transform(
            points.begin(), points.end(), std::back_inserter(displaced), [&](const Vec3& point) {
                return rounded(morph(point));
            });
        result.push_back(std::move(displaced));
    }
    return result;
}

}  // namespace

std::size_t IndexedMesh::triangle_count() const {
    std::size_t count = 0;
    for (const auto& list : triangles) {
        count += list.size();
    }
    return count;
}

IndexedMesh index_faces(const DraftNode& node, std::size_t material_count, int tessellation) {
    EARSHOT_ASSERT(tessellation >= 1);
    std::vector<std::vector<Corner>> corners(material_count);
    std::vector<Vec3> points;
    for (const Face& face : node.faces) {
        for (const SmallFace& small : split(face, tessellation)) {
            std::array<Position, 4> at{};
            std::transform(small.corners.begin(), small.corners.end(), at.begin(), rounded);
            corners[face.material].push_back({at[0], at[1], at[2]});
            if (small.corner_count == 4) {
                corners[face.material].push_back({at[0], at[2], at[3]});
            }
            if (!node.morphs.empty()) {
                points.insert(
                    points.end(),
                    small.corners.begin(),
                    small.corners.begin() + static_cast<std::ptrdiff_t>(small.corner_count));
            }
        }
    }

    IndexedMesh mesh;
    for (const auto& list : corners) {
        for (const Corner& triangle : list) {
            mesh.positions.insert(mesh.positions.end(), triangle.begin(), triangle.end());
        }
    }
    std::sort(mesh.positions.begin(), mesh.positions.end());
    mesh.positions.erase(std::unique(mesh.positions.begin(), mesh.positions.end()),
                         mesh.positions.end());
    mesh.positions.shrink_to_fit();
    if (mesh.positions.size() > std::numeric_limits<std::uint32_t>::max()) {
        throw Error("tessellation", "makes too many vertices", "choose a smaller one");
    }
    mesh.displacements = displacements(node, std::move(points));

    const auto index_of = [&](const Position& position) {
        return static_cast<std::uint32_t>(
            std::lower_bound(mesh.positions.begin(), mesh.positions.end(), position) -
            mesh.positions.begin());
    };
    mesh.triangles.resize(material_count);
    for (std::size_t material = 0; material < material_count; ++material) {
        for (const auto& [a, b, c] : corners[material]) {
            mesh.triangles[material].push_back({index_of(a), index_of(b), index_of(c)});
        }
    }
    return mesh;
}

}  // namespace earshot::scenes
