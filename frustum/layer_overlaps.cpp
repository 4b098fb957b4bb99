// SPDX-License-Identifier: MIT
#include "earshot/frustum/layer_overlaps.h"

#include "earshot/base/assert.h"
#include "earshot/frustum/internal/coincident_layers.h"
#include "earshot/frustum/internal/facet_index.h"

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace earshot::frustum {

using geometry::Facet;
using geometry::TriangleId;
using geometry::Vec3;

namespace {

/// An overlap counts if it is wider than this many tolerances. Walls that meet in an edge overlap
/// by up to two, as each is drawn with its own rounding.
constexpr double kMinWidthInTolerances = 8.0;

using Corners = std::array<Vec3, 3>;

Corners corners_of(const geometry::MeshView& mesh, TriangleId id) {
    const auto [a, b, c] = mesh.triangles[id];
    return {mesh.positions[a], mesh.positions[b], mesh.positions[c]};
}

double cross(const glm::dvec2& a, const glm::dvec2& b) noexcept {
    return a.x * b.y - a.y * b.x;
}

/// Two triangles in the plane of the first, relative to one of its corners.
class PlaneFrame {
public:
    PlaneFrame(const Vec3& origin, const Vec3& normal) : origin_(origin), u_(0.0), v_(0.0) {
        Vec3 axis(0.0);
        axis[(dominant_axis(normal) + 1) % 3] = 1.0;
        u_ = glm::normalize(glm::cross(normal, axis));
        v_ = glm::cross(normal, u_);
    }
    glm::dvec2 project(const Vec3& p) const noexcept {
        return {glm::dot(p - origin_, u_), glm::dot(p - origin_, v_)};
    }
    Vec3 lift(const glm::dvec2& p) const noexcept { return origin_ + p.x * u_ + p.y * v_; }

private:
    Vec3 origin_, u_, v_;
};

/// The part of a convex polygon to the left of a line (Sutherland and Hodgman 1974).
std::vector<glm::dvec2> clip(const std::vector<glm::dvec2>& polygon,
                             const glm::dvec2& from,
                             const glm::dvec2& to) {
    std::vector<glm::dvec2> kept;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const glm::dvec2& p = polygon[i];
        const glm::dvec2& q = polygon[(i + 1) % polygon.size()];
        const double at_p = cross(to - from, p - from);
        const double at_q = cross(to - from, q - from);
        if (at_p >= 0.0) {
            kept.push_back(p);
        }
        if ((at_p >= 0.0) != (at_q >= 0.0)) {
            kept.push_back(p + at_p / (at_p - at_q) * (q - p));
        }
    }
    return kept;
}

struct Overlap {
    double area = 0.0;
    glm::dvec2 centre{0.0};
};

/// Nothing if it is narrower than `min_width`.
std::optional<Overlap> overlap_of(std::vector<glm::dvec2> a,
                                  std::vector<glm::dvec2> b,
                                  double min_width) {
    for (auto* triangle : {&a, &b}) {
        auto& p = *triangle;
        if (cross(p[1] - p[0], p[2] - p[0]) < 0.0) {
            std::swap(p[1], p[2]);
        }
    }
    for (std::size_t i = 0; i < 3 && !a.empty(); ++i) {
        a = clip(a, b[i], b[(i + 1) % 3]);
    }
    if (a.size() < 3) {
        return std::nullopt;
    }
    Overlap overlap;
    double longest = 0.0;
    for (std::size_t i = 1; i + 1 < a.size(); ++i) {
        const double part = 0.5 * cross(a[i] - a[0], a[i + 1] - a[0]);
        overlap.area += part;
        overlap.centre += part / 3.0 * (a[0] + a[i] + a[i + 1]);
        longest = std::max({longest, glm::length(a[i] - a[0]), glm::length(a[i + 1] - a[0])});
    }
    if (!(overlap.area > min_width * longest)) {
        return std::nullopt;
    }
    overlap.centre /= overlap.area;
    return overlap;
}

}  // namespace

std::vector<LayerOverlap> find_layer_overlaps(const SceneView& scene,
                                              std::span<const std::uint32_t> labels) {
    EARSHOT_ASSERT(labels.size() == scene.mesh().triangles.size());
    std::vector<LayerOverlap> overlaps;
    if (std::equal(labels.begin() + (labels.empty() ? 0 : 1), labels.end(), labels.begin())) {
        return overlaps;
    }
    const auto& facets = scene.facets;
    for (std::size_t i = 0; i < labels.size(); ++i) {
        const auto id = static_cast<TriangleId>(i);
        const Facet& facet = facets.facets[facets.of_triangle[id]];
        const Corners corners = corners_of(scene.mesh(), id);
        const PlaneFrame frame(corners[0], facet.plane.normal);
        geometry::Aabb box;
        for (const Vec3& corner : corners) {
            box.include(corner - (facet.deviation + facets.tolerance));
            box.include(corner + (facet.deviation + facets.tolerance));
        }
        const auto overlaps_box = [&](const geometry::Aabb& other) {
            bool overlaps_all = true;
            for (std::size_t k = 0; k < 3; ++k) {
                overlaps_all = overlaps_all && other.lower[k] <= box.upper[k] &&
                               other.upper[k] >= box.lower[k];
            }
            return overlaps_all;
        };
        const auto project = [&](const Corners& p) {
            return std::vector{frame.project(p[0]), frame.project(p[1]), frame.project(p[2])};
        };
        const std::size_t begin = overlaps.size();
        scene.bvh.traverse(overlaps_box, [&](TriangleId other) {
            const Facet& layer = facets.facets[facets.of_triangle[other]];
            if (other <= id || labels[other] == labels[id] ||
                glm::length(glm::cross(facet.plane.normal, layer.plane.normal)) > kMaxLayerTilt) {
                return true;
            }
            const auto overlap = overlap_of(project(corners),
                                            project(corners_of(scene.mesh(), other)),
                                            kMinWidthInTolerances * facets.tolerance);
            if (overlap) {
                const Vec3 point = frame.lift(overlap->centre);
                if (are_coincident_at(facets, facet, point, layer, point)) {
                    overlaps.push_back({id, other, overlap->area, point});
                }
            }
            return true;
        });
        std::sort(overlaps.begin() + static_cast<std::ptrdiff_t>(begin),
                  overlaps.end(),
                  [](const LayerOverlap& a, const LayerOverlap& b) { return a.second < b.second; });
    }
    return overlaps;
}

}  // namespace earshot::frustum
