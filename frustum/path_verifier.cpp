// SPDX-License-Identifier: MIT
#include "earshot/frustum/path_verifier.h"

#include "earshot/bvh/ray.h"
#include "earshot/bvh/traverse.h"
#include "earshot/frustum/internal/facet_index.h"
#include "earshot/geometry/predicates.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <tuple>

namespace earshot::frustum {

using geometry::FacetId;
using geometry::Plane;
using geometry::TriangleId;
using geometry::Vec3;

namespace {

/// A leg that meets a second surface at its reflection point does so within flatness / sin(angle)
/// of it. Angles below a thousandth of a radian are left to the plane distance alone.
constexpr double kContactReach = 1024.0;

/// The two coordinates that remain when the plane's dominant axis is dropped.
glm::dvec2 project(const Vec3& point, int axis) noexcept {
    return {point[(axis + 1) % 3], point[(axis + 2) % 3]};
}

double squared_distance_to_edge(const glm::dvec2& p, const glm::dvec2& a, const glm::dvec2& b) {
    const glm::dvec2 edge = b - a;
    const double squared = glm::dot(edge, edge);
    const double t = squared > 0.0 ? std::clamp(glm::dot(p - a, edge) / squared, 0.0, 1.0) : 0.0;
    const glm::dvec2 gap = p - (a + t * edge);
    return glm::dot(gap, gap);
}

enum class Containment { outside, near, inside };

/// A source or image less than this many rounding slacks from a facet's plane is not reflected:
/// with less, the slack allowed to the other end of the leg would move the reflection point by a
/// good part of the leg.
constexpr double kGrazing = 8.0;

bool lies_in_box(const glm::dvec2& p, const std::array<glm::dvec2, 3>& corner) noexcept {
    const glm::dvec2 lower = glm::min(glm::min(corner[0], corner[1]), corner[2]);
    const glm::dvec2 upper = glm::max(glm::max(corner[0], corner[1]), corner[2]);
    return p.x >= lower.x && p.x <= upper.x && p.y >= lower.y && p.y <= upper.y;
}

/// Where a point lies relative to a triangle: decided exactly; `near` is outside by up to `slack`.
/// A sliver may stand on edge in its facet and project to a line, all of whose points are on no
/// edge's outside: its box tells them apart.
Containment locate(const glm::dvec2& p, const std::array<glm::dvec2, 3>& corner, double slack) {
    const int ab = geometry::orient2d(corner[0], corner[1], p);
    const int bc = geometry::orient2d(corner[1], corner[2], p);
    const int ca = geometry::orient2d(corner[2], corner[0], p);
    if (((ab >= 0 && bc >= 0 && ca >= 0) || (ab <= 0 && bc <= 0 && ca <= 0)) &&
        lies_in_box(p, corner)) {
        return Containment::inside;
    }
    const double nearest = std::min({squared_distance_to_edge(p, corner[0], corner[1]),
                                     squared_distance_to_edge(p, corner[1], corner[2]),
                                     squared_distance_to_edge(p, corner[2], corner[0])});
    return nearest <= slack * slack ? Containment::near : Containment::outside;
}

}  // namespace

PathVerifier::PathVerifier(const SceneView& scene) : scene_(scene) {
    if (!scene.tree.nodes().empty()) {
        const geometry::Aabb& box = scene.tree.nodes().front().box;
        for (std::size_t k = 0; k < 3; ++k) {
            scale_ = std::max({scale_,
                               std::abs(static_cast<double>(box.lower[k])),
                               std::abs(static_cast<double>(box.upper[k]))});
        }
    }
}

double PathVerifier::grazing_distance(double reach) const noexcept {
    return kRounding * (scale_ + reach);
}

double PathVerifier::contact_reach() const noexcept {
    return kContactReach * scene_.facets.tolerance;
}

std::optional<SpecularPath> PathVerifier::verify(std::span<const FacetId> sequence,
                                                 std::span<const Vec3> images,
                                                 const Vec3& listener) const {
    const std::size_t order = sequence.size();
    SpecularPath path;
    path.length = glm::distance(images[order], listener);
    const double slack = grazing_distance(path.length);

    // From the listener back to the source: the leg towards image i meets facet i.
    path.points.resize(order + 2);
    path.triangles.resize(order);
    path.points[order + 1] = listener;
    for (std::size_t i = order; i > 0; --i) {
        const FacetId facet = sequence[i - 1];
        const Plane& plane = scene_.facets.facets[facet].plane;
        const Vec3& target = path.points[i + 1];
        const double before = plane.distance(images[i - 1]);  // of the side that reflects
        const double behind = plane.distance(images[i]);
        const bool front = before > 0.0;
        double ahead = plane.distance(target);
        if (std::abs(before) <= kGrazing * slack || (front ? ahead < -slack : ahead > slack)) {
            return std::nullopt;
        }
        ahead = front ? std::max(ahead, 0.0) : std::min(ahead, 0.0);
        if (!front && !scene_.one_sided.empty() && scene_.one_sided[facet] != 0) {
            return std::nullopt;
        }
        path.points[i] = target + (ahead / (ahead - behind)) * (images[i] - target);
        const auto triangle = triangle_at(facet, path.points[i], slack);
        if (!triangle) {
            return std::nullopt;
        }
        path.triangles[i - 1] = *triangle;
    }
    path.points[0] = images[0];
    if (turns_on_an_outer_edge(sequence, images, path.points, slack)) {
        return std::nullopt;
    }

    // From the last leg to the first, so that what is inserted moves none that is still to come.
    std::vector<Passage> passages;
    for (std::size_t i = order + 1; i-- > 0;) {
        const FacetId* from_facet = i > 0 ? &sequence[i - 1] : nullptr;
        const FacetId* to_facet = i < order ? &sequence[i] : nullptr;
        passages.clear();
        if (!leg_is_free(path.points[i], path.points[i + 1], from_facet, to_facet, passages)) {
            return std::nullopt;
        }
        insert(path, i, passages);
    }
    return path;
}

template <typename Visit>
void PathVerifier::visit_triangles_at(FacetId facet,
                                      const Vec3& point,
                                      double slack,
                                      Visit&& visit) const {
    const geometry::Facet& surface = scene_.facets.facets[facet];
    const int axis = dominant_axis(surface.plane.normal);
    const glm::dvec2 p = project(point, axis);
    // The point lies in the plane, the triangles within the facet's deviation of it, measured along
    // the dominant axis at most sqrt(3) times as far.
    const double reach = 2.0 * surface.deviation + slack;
    bvh::traverse(
        scene_.tree,
        [&](const bvh::Node& node) {
            for (int k = 0; k < 3; ++k) {
                const auto index = static_cast<std::size_t>(k);
                if (point[k] < static_cast<double>(node.box.lower[index]) - reach ||
                    point[k] > static_cast<double>(node.box.upper[index]) + reach) {
                    return false;
                }
            }
            return true;
        },
        [&](TriangleId id) {
            if (scene_.facets.of_triangle[id] == facet) {
                const geometry::Triangle& triangle = scene_.mesh.triangles[id];
                std::array<glm::dvec2, 3> corner;
                for (std::size_t k = 0; k < 3; ++k) {
                    corner[k] = project(scene_.mesh.positions[triangle[k]], axis);
                }
                visit(id, locate(p, corner, slack));
            }
            return true;
        });
}

std::optional<TriangleId> PathVerifier::triangle_at(FacetId facet,
                                                    const Vec3& point,
                                                    double slack) const {
    std::optional<TriangleId> inside, near;
    visit_triangles_at(facet, point, slack, [&](TriangleId id, Containment where) {
        if (where == Containment::inside && (!inside || id < *inside)) {
            inside = id;
        } else if (where == Containment::near && (!near || id < *near)) {
            near = id;
        }
    });
    return inside ? inside : near;
}

// Whether the facet at this point of its border has a part over another's plane, on the given side.
bool PathVerifier::rises_over(
    FacetId other, double side, FacetId facet, const Vec3& point, double slack) const {
    const geometry::Facet& ground = scene_.facets.facets[other];
    const double flatness = ground.deviation + scene_.facets.tolerance;
    bool rises = false;
    visit_triangles_at(facet, point, slack, [&](TriangleId id, Containment where) {
        for (const geometry::VertexId vertex : scene_.mesh.triangles[id]) {
            const double height = side * ground.plane.distance(scene_.mesh.positions[vertex]);
            rises = rises || (where != Containment::outside && height > flatness);
        }
    });
    return rises;
}

// From one facet to the next sound can only go where each stands on the sounding side of the other.
// Where a leg ends in both planes, in the edge that they share, that is not a matter of its ends: a
// listener at the source would hear every outer edge of a box reflect like an inner one.
bool PathVerifier::turns_on_an_outer_edge(std::span<const FacetId> sequence,
                                          std::span<const Vec3> images,
                                          std::span<const Vec3> points,
                                          double slack) const {
    for (std::size_t i = 0; i + 1 < sequence.size(); ++i) {
        const FacetId first = sequence[i];
        const FacetId second = sequence[i + 1];
        const auto side_of = [&](FacetId facet, const Vec3& image) {
            return scene_.facets.facets[facet].plane.distance(image) > 0.0 ? 1.0 : -1.0;
        };
        const auto lies_in = [&](FacetId facet, const Vec3& point) {
            return std::abs(scene_.facets.facets[facet].plane.distance(point)) <= slack;
        };
        const Vec3& from = points[i + 1];
        const Vec3& to = points[i + 2];
        if ((lies_in(first, to) &&
             !rises_over(first, side_of(first, images[i]), second, to, slack)) ||
            (lies_in(second, from) &&
             !rises_over(second, side_of(second, images[i + 1]), first, from, slack))) {
            return true;
        }
    }
    return false;
}

PathVerifier::LegEnd PathVerifier::end_of_leg(const FacetId* facet, const Vec3& other_end) const {
    if (facet == nullptr) {
        return {};
    }
    const Plane& plane = scene_.facets.facets[*facet].plane;
    return {.facet = facet, .rise = std::abs(plane.distance(other_end))};
}

// Whether a triangle met a share `t` of the leg from its end, at most `reach`, belongs to the
// surface there: it is of the facet itself; it meets the facet in the reflection point, which is
// known up to rounding and up to the facet's deviation from its plane; or it coats the facet.
bool PathVerifier::reflects_at(const LegEnd& end,
                               TriangleId triangle,
                               double t,
                               double reach) const {
    if (end.facet == nullptr) {
        return false;
    }
    const geometry::Facets& facets = scene_.facets;
    if (facets.of_triangle[triangle] == *end.facet) {
        return true;
    }
    const geometry::Facet& surface = facets.facets[*end.facet];
    const double height = t * end.rise;
    const double joint = surface.deviation + grazing_distance(end.rise);
    return t <= reach &&
           (height <= joint || (height <= joint + facets.tolerance && coats(surface, triangle)));
}

// A layer on the facet: all of the triangle lies in the facet's plane, as far as files can tell.
bool PathVerifier::coats(const geometry::Facet& surface, TriangleId triangle) const {
    const geometry::Facets& facets = scene_.facets;
    const double deviation =
        surface.deviation + facets.facets[facets.of_triangle[triangle]].deviation;
    const geometry::Triangle& corners = scene_.mesh.triangles[triangle];
    return std::all_of(corners.begin(), corners.end(), [&](geometry::VertexId vertex) {
        return std::abs(surface.plane.distance(scene_.mesh.positions[vertex])) <=
               deviation + facets.tolerance;
    });
}

bool PathVerifier::leg_is_free(const Vec3& from,
                               const Vec3& to,
                               const FacetId* from_facet,
                               const FacetId* to_facet,
                               std::vector<Passage>& passages) const {
    const LegEnd start = end_of_leg(from_facet, to);
    const LegEnd finish = end_of_leg(to_facet, from);
    const double length = glm::distance(from, to);
    const double reach = contact_reach() / length;  // in parameters of the leg
    const auto blocks = [&](TriangleId id, double t) {
        if (reflects_at(start, id, t, reach) || reflects_at(finish, id, 1.0 - t, reach)) {
            return false;
        }
        const FacetId facet = scene_.facets.of_triangle[id];
        if (scene_.transmissive.empty() || scene_.transmissive[facet] == 0 ||
            runs_along(facet, from, to)) {
            return true;
        }
        passages.push_back({t, facet, id});
        return false;
    };
    if (bvh::any_hit(scene_.tree, scene_.mesh, geometry::Segment{from, to}, blocks)) {
        return false;
    }
    unify(passages, length);
    return true;
}

bool PathVerifier::runs_along(FacetId facet, const Vec3& from, const Vec3& to) const {
    const Plane& plane = scene_.facets.facets[facet].plane;
    const double slack = grazing_distance(glm::distance(from, to));
    return std::abs(plane.distance(from)) <= slack && std::abs(plane.distance(to)) <= slack;
}

// A facet is passed once, whichever of its triangles are touched, and so is an edge of two facets.
void PathVerifier::unify(std::vector<Passage>& passages, double length) const {
    std::sort(passages.begin(), passages.end(), [](const Passage& a, const Passage& b) {
        return std::tie(a.facet, a.triangle) < std::tie(b.facet, b.triangle);
    });
    const auto of_one_facet = [](const Passage& a, const Passage& b) { return a.facet == b.facet; };
    passages.erase(std::unique(passages.begin(), passages.end(), of_one_facet), passages.end());
    std::stable_sort(passages.begin(), passages.end(), [](const Passage& a, const Passage& b) {
        return a.t < b.t;
    });
    const double slack = grazing_distance(length);
    const auto at_one_point = [&](const Passage& a, const Passage& b) {
        return (b.t - a.t) * length <= slack;
    };
    passages.erase(std::unique(passages.begin(), passages.end(), at_one_point), passages.end());
}

void PathVerifier::insert(SpecularPath& path, std::size_t leg, std::span<const Passage> passages) {
    if (path.transmitted.empty() && !passages.empty()) {
        path.transmitted.assign(path.triangles.size(), 0);
    }
    const Vec3 from = path.points[leg];
    const Vec3 way = path.points[leg + 1] - from;
    auto place = static_cast<std::ptrdiff_t>(leg);
    for (const Passage& passage : passages) {
        path.triangles.insert(path.triangles.begin() + place, passage.triangle);
        path.transmitted.insert(path.transmitted.begin() + place, 1);
        path.points.insert(path.points.begin() + place + 1, from + passage.t * way);
        ++place;
    }
}

}  // namespace earshot::frustum
