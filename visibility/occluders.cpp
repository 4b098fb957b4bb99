// SPDX-License-Identifier: MIT
#include "earshot/visibility/internal/occluders.h"

#include "earshot/geometry/disjoint_sets.h"
#include "earshot/geometry/predicates.h"
#include "earshot/geometry/vector.h"
#include "earshot/visibility/internal/corner_signs.h"
#include "earshot/visibility/internal/mesh_touch.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

// Why a patch hides: let no segment from the region to the box touch the patch's border, and let
// the region and the box lie on two sides of a slab that holds the patch. Then the parity of the
// number of triangles that a segment crosses is the same for all of these segments, because as one
// segment turns into another it changes only where the border is crossed, or an end crosses a
// triangle. If one segment crosses a single triangle, the parity is odd, and every other segment
// crosses at least one. This needs neither a plane nor a convex border, but vertices that are
// shared exactly: the border is what belongs to an odd number of triangles of the patch.

namespace earshot::visibility {

using geometry::Aabb;
using geometry::MeshView;
using geometry::TriangleId;
using geometry::Vec3;

namespace {

constexpr std::uint32_t kNoPatch = std::numeric_limits<std::uint32_t>::max();

// Neighbours belong to one patch where the sine between their normals is below this. It decides how
// thick a patch is, not whether it hides.
constexpr double kMaxSine = 1e-6;

// More than the rounding of a bound that is a sum of products of a few numbers.
constexpr double kRoundedUp = 1.0 + 0x1p-44;

/// Bounds of normal . (p - origin) over a box that hold whatever the rounding.
struct Heights {
    double min = 0.0, max = 0.0;
};

Heights heights_over(const Aabb& box, const Vec3& normal, const Vec3& origin) noexcept {
    const double slack =
        kPlaneError * 3.0 * geometry::max_abs(normal) * (max_distance(box, origin) + kMinExtent);
    return {.min = glm::dot(normal, farthest_corner(box, -normal) - origin) - slack,
            .max = glm::dot(normal, farthest_corner(box, normal) - origin) + slack};
}

/// The side of the plane through an edge and a viewer on which the whole box lies, wherever the
/// viewer is within a radius of the centre; 0 if that is not certain.
int side_of_edge(const Vec3& a, const Vec3& b, const Ball& viewer, const Aabb& box) noexcept {
    // For one point of the box the determinant is affine in the viewer's position, with the
    // gradient (b - a) x (point - a).
    const Vec3 along = glm::abs(b - a);
    const Vec3 away = max_distances(box, a);
    const double gradient =
        along.x * (away.y + away.z) + along.y * (away.z + away.x) + along.z * (away.x + away.y);
    return TrianglePlane({viewer.centre, a, b}).side(box, kRoundedUp * gradient * viewer.radius);
}

/// Whether the line of the edge and every segment from the region to the box are apart, which holds
/// if they have one orientation throughout.
bool is_clear_of_edge(const Vec3& a,
                      const Vec3& b,
                      const ViewerRegion& viewer,
                      const Aabb& box) noexcept {
    const int side = side_of_edge(a, b, viewer.begin_ball(), box);
    return side != 0 && (viewer.is_point() || side_of_edge(a, b, viewer.end_ball(), box) == side);
}

}  // namespace

/// Finds the patches of a mesh.
struct Occluders::PatchBuilder {
    struct EdgeUse {
        Vec3 first{0.0}, second{0.0};  // in lexicographic order
        std::uint32_t triangle = 0;    // index into `triangles`

        bool is_same_edge(const EdgeUse& other) const noexcept {
            return first == other.first && second == other.second;
        }
    };

    PatchBuilder(const MeshView& the_mesh, const ExclusionMask& excluded) : mesh(the_mesh) {
        choose_triangles(excluded);
        list_edges();
    }

    Vec3 normal_of(TriangleId id) const {
        const auto [a, b, c] = geometry::corners(mesh, id);
        return glm::cross(b - a, c - a);
    }

    // The largest ones, which hide most; of equal ones the lowest.
    void choose_triangles(const ExclusionMask& excluded) {
        std::vector<std::pair<double, TriangleId>> by_size;
        for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
            const auto id = static_cast<TriangleId>(i);
            const Vec3 normal = normal_of(id);
            if (const double size = glm::dot(normal, normal);
                size > 0.0 && !excluded.contains(id)) {
                by_size.emplace_back(-size, id);
            }
        }
        const std::size_t count = std::min(by_size.size(), kMaxPatchedTriangles);
        std::nth_element(
            by_size.begin(), by_size.begin() + static_cast<std::ptrdiff_t>(count), by_size.end());
        for (std::size_t i = 0; i < count; ++i) {
            const auto [a, b, c] = geometry::corners(mesh, by_size[i].second);
            if (geometry::has_area(geometry::without_tiny_coordinates(a),
                                   geometry::without_tiny_coordinates(b),
                                   geometry::without_tiny_coordinates(c))) {
                triangles.push_back(by_size[i].second);
            }
        }
        std::sort(triangles.begin(), triangles.end());
    }

    void list_edges() {
        for (std::uint32_t i = 0; i < triangles.size(); ++i) {
            const geometry::Corners corners = geometry::corners(mesh, triangles[i]);
            for (std::size_t k = 0; k < 3; ++k) {
                EdgeUse use{corners[k], corners[(k + 1) % 3], i};
                if (geometry::lexicographic_less(use.second, use.first)) {
                    std::swap(use.first, use.second);
                }
                edges.push_back(use);
            }
        }
        std::sort(edges.begin(), edges.end(), [](const EdgeUse& a, const EdgeUse& b) {
            if (a.first != b.first) {
                return geometry::lexicographic_less(a.first, b.first);
            }
            return a.second != b.second ? geometry::lexicographic_less(a.second, b.second)
                                        : a.triangle < b.triangle;
        });
    }

    bool are_in_one_plane(TriangleId a, TriangleId b) const {
        const Vec3 normal_a = normal_of(a);
        const Vec3 normal_b = normal_of(b);
        const Vec3 cross = glm::cross(normal_a, normal_b);
        return glm::dot(cross, cross) <=
               kMaxSine * kMaxSine * glm::dot(normal_a, normal_a) * glm::dot(normal_b, normal_b);
    }

    /// Calls with each run of uses of one edge.
    template <typename Take>
    void for_each_edge(const Take& take) const {
        for (std::size_t begin = 0; begin < edges.size();) {
            std::size_t end = begin + 1;
            while (end < edges.size() && edges[end].is_same_edge(edges[begin])) {
                ++end;
            }
            take(std::span(edges).subspan(begin, end - begin));
            begin = end;
        }
    }

    void build(Occluders& occluders) const {
        geometry::DisjointSets sets(triangles.size());
        for_each_edge([&](std::span<const EdgeUse> uses) {
            if (uses.size() == 2 &&
                are_in_one_plane(triangles[uses[0].triangle], triangles[uses[1].triangle])) {
                sets.unite(uses[0].triangle, uses[1].triangle);
            }
        });
        std::vector<std::pair<std::uint32_t, std::uint32_t>> members;  // set, triangle
        std::vector<std::vector<Edge>> borders(triangles.size());      // per set
        for (std::uint32_t i = 0; i < triangles.size(); ++i) {
            members.emplace_back(sets.find(i), i);
        }
        std::sort(members.begin(), members.end());
        for_each_edge([&](std::span<const EdgeUse> uses) {
            for (const EdgeUse& use : uses) {
                const std::uint32_t set = sets.find(use.triangle);
                const auto of_set = std::count_if(uses.begin(), uses.end(), [&](const EdgeUse& u) {
                    return sets.find(u.triangle) == set;
                });
                const bool is_first = std::none_of(uses.data(), &use, [&](const EdgeUse& u) {
                    return sets.find(u.triangle) == set;
                });
                if (is_first && of_set % 2 == 1) {
                    borders[set].push_back({use.first, use.second});
                }
            }
        });
        for (std::size_t begin = 0; begin < members.size();) {
            std::size_t end = begin + 1;
            while (end < members.size() && members[end].first == members[begin].first) {
                ++end;
            }
            add_patch(std::span(members).subspan(begin, end - begin),
                      borders[members[begin].first],
                      occluders);
            begin = end;
        }
    }

    void add_patch(std::span<const std::pair<std::uint32_t, std::uint32_t>> members,
                   const std::vector<Edge>& border,
                   Occluders& occluders) const {
        if (members.size() < 2 || members.size() > kMaxPatchTriangles ||
            border.size() > kMaxPatchEdges) {
            return;
        }
        Patch patch = {.first_triangle = static_cast<std::uint32_t>(occluders.triangles_.size()),
                       .triangle_count = static_cast<std::uint32_t>(members.size()),
                       .first_edge = static_cast<std::uint32_t>(occluders.edges_.size()),
                       .edge_count = static_cast<std::uint32_t>(border.size())};
        for (const auto& [set, index] : members) {
            const Vec3 normal = normal_of(triangles[index]);
            if (glm::dot(normal, normal) > glm::dot(patch.normal, patch.normal)) {
                patch.normal = normal;
                patch.origin = geometry::corners(mesh, triangles[index])[0];
            }
            occluders.triangles_.push_back(triangles[index]);
            occluders.patch_of_triangle_[triangles[index]] =
                static_cast<std::uint32_t>(occluders.patches_.size());
        }
        for (const auto& [set, index] : members) {
            for (const Vec3& vertex : geometry::corners(mesh, triangles[index])) {
                const Vec3 away = vertex - patch.origin;
                const double height = glm::dot(patch.normal, away);
                const double slack = kPlaneError * 3.0 * geometry::max_abs(patch.normal) *
                                     (geometry::max_abs(away) + kMinExtent);
                patch.min_height = std::min(patch.min_height, height - slack);
                patch.max_height = std::max(patch.max_height, height + slack);
            }
        }
        occluders.edges_.insert(occluders.edges_.end(), border.begin(), border.end());
        occluders.patches_.push_back(patch);
    }

    MeshView mesh;
    std::vector<TriangleId> triangles;
    std::vector<EdgeUse> edges;
};

Occluders::Occluders(const MeshView& mesh, const ExclusionMask& excluded)
    : triangle_count_(static_cast<std::uint32_t>(mesh.triangles.size())),
      patch_of_triangle_(mesh.triangles.size(), kNoPatch) {
    PatchBuilder(mesh, excluded).build(*this);
}

Occluders::Id Occluders::of_triangle(TriangleId triangle) const noexcept {
    const std::uint32_t patch = patch_of_triangle_[triangle];
    return patch == kNoPatch ? triangle : triangle_count_ + patch;
}

const Occluders::Patch* Occluders::patch_of(Id occluder) const noexcept {
    return occluder < triangle_count_ ? nullptr : &patches_[occluder - triangle_count_];
}

bool Occluders::hides(const MeshView& mesh,
                      Id occluder,
                      const ViewerRegion& viewer,
                      const Aabb& box) const noexcept {
    if (const Patch* patch = patch_of(occluder)) {
        return hides(mesh, *patch, viewer, box);
    }
    const auto [a, b, c] = geometry::corners(mesh, occluder);
    const TrianglePlane plane({a, b, c});
    const int side = plane.side(box);
    return side != 0 && plane.side(viewer.begin()) == -side && plane.side(viewer.end()) == -side &&
           is_clear_of_edge(a, b, viewer, box) && is_clear_of_edge(b, c, viewer, box) &&
           is_clear_of_edge(c, a, viewer, box) &&
           touches({viewer.begin_ball().centre, corner(box, 0)}, mesh, occluder);
}

bool Occluders::hides(const MeshView& mesh,
                      const Patch& patch,
                      const ViewerRegion& viewer,
                      const Aabb& box) const noexcept {
    if (!patch.is_whole) {
        return false;
    }
    const Heights begin = heights_over(viewer.begin(), patch.normal, patch.origin);
    const Heights end = heights_over(viewer.end(), patch.normal, patch.origin);
    const Heights from{std::min(begin.min, end.min), std::max(begin.max, end.max)};
    const Heights to = heights_over(box, patch.normal, patch.origin);
    if (!(from.min > patch.max_height && to.max < patch.min_height) &&
        !(from.max < patch.min_height && to.min > patch.max_height)) {
        return false;
    }
    for (std::uint32_t i = 0; i < patch.edge_count; ++i) {
        const auto& [a, b] = edges_[patch.first_edge + i];
        if (!is_clear_of_edge(a, b, viewer, box)) {
            return false;
        }
    }
    // A segment that touches a single triangle crosses it: at a shared edge it would touch two.
    for (const std::size_t flags : {0U, 7U}) {
        const geometry::Segment segment{viewer.begin_ball().centre, corner(box, flags)};
        std::size_t touched = 0;
        for (std::uint32_t i = 0; i < patch.triangle_count && touched < 2; ++i) {
            touched += touches(segment, mesh, triangles_[patch.first_triangle + i]) ? 1 : 0;
        }
        if (touched < 2) {
            return touched == 1;
        }
    }
    return false;
}

bool Occluders::has_moved(Id occluder, std::span<const std::uint8_t> moved) const noexcept {
    const Patch* patch = patch_of(occluder);
    if (patch == nullptr) {
        return moved[occluder] != 0;
    }
    const auto first = triangles_.begin() + patch->first_triangle;
    return std::any_of(
        first, first + patch->triangle_count, [&](TriangleId id) { return moved[id] != 0; });
}

void Occluders::remove_moved_patches(std::span<const std::uint8_t> moved) {
    for (std::uint32_t index = 0; index < patches_.size(); ++index) {
        if (!patches_[index].is_whole || !has_moved(triangle_count_ + index, moved)) {
            continue;
        }
        patches_[index].is_whole = false;
        for (std::uint32_t i = 0; i < patches_[index].triangle_count; ++i) {
            patch_of_triangle_[triangles_[patches_[index].first_triangle + i]] = kNoPatch;
        }
    }
}

}  // namespace earshot::visibility
