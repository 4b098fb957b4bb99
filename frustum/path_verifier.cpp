// SPDX-License-Identifier: MIT
#include "earshot/frustum/path_verifier.h"

#include "earshot/frustum/internal/coincident_layers.h"
#include "earshot/frustum/internal/containment.h"
#include "earshot/frustum/internal/facet_index.h"
#include "earshot/frustum/internal/reflection_point.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

namespace earshot::frustum {

using geometry::FacetId;
using geometry::Plane;
using geometry::TriangleId;
using geometry::Vec3;

namespace {

/// A leg that meets a second surface at its reflection point does so within flatness / sin(angle)
/// of it. Angles below a thousandth of a radian are left to the plane distance alone.
constexpr double kContactRadius = 1024.0;

/// Surfaces that meet in an edge do so within this many tolerances of its line: the ends of their
/// outlines and of the line are off by one each, and outlines leave out vertices within another.
constexpr double kEdgeTolerances = 4.0;

}  // namespace

PathVerifier::PathVerifier(const SceneView& scene)
    : scene_(scene),
      may_be_covered_(find_transmissive_layers(scene)),
      extent_(scene.bvh.max_abs_coordinate()) {}

double PathVerifier::rounding_slack(double distance) const noexcept {
    return kRounding * (extent_ + distance);
}

double PathVerifier::contact_radius() const noexcept {
    return kContactRadius * scene_.facets.tolerance;
}

// From the listener back to the source: the leg towards image i meets facet i.
std::optional<SpecularPath> PathVerifier::reflect(std::span<const FacetId> sequence,
                                                  std::span<const Vec3> images,
                                                  const Vec3& listener) const {
    const std::size_t order = sequence.size();
    SpecularPath path;
    path.length = glm::distance(images[order], listener);
    const double slack = rounding_slack(path.length);

    path.points.resize(order + 2);
    path.triangles.resize(order);
    path.points[order + 1] = listener;
    for (std::size_t i = order; i > 0; --i) {
        const FacetId facet = sequence[i - 1];
        const Plane& plane = scene_.facets.facets[facet].plane;
        const Vec3& target = path.points[i + 1];
        const auto reflection = find_reflection(plane, images[i - 1], images[i], target, slack);
        if (!reflection ||
            (!reflection->is_front && !scene_.one_sided.empty() && scene_.one_sided[facet] != 0)) {
            return std::nullopt;
        }
        path.points[i] = reflection->point;
        const auto triangle = triangle_at(facet, path.points[i], slack);
        if (!triangle) {
            return std::nullopt;
        }
        path.triangles[i - 1] = *triangle;
    }
    path.points[0] = images[0];
    return path;
}

std::optional<SpecularPath> PathVerifier::construct(std::span<const FacetId> sequence,
                                                    std::span<const Vec3> images,
                                                    const Vec3& listener) const {
    auto path = reflect(sequence, images, listener);
    if (path &&
        (runs_between_layers(sequence, *path) ||
         turns_at_outer_edge(sequence, images, path->points, rounding_slack(path->length)))) {
        path.reset();
    }
    return path;
}

bool PathVerifier::turns_in_facets(std::span<const FacetId> sequence,
                                   std::span<const Vec3> images,
                                   const Vec3& point) const {
    return reflect(sequence, images, point).has_value();
}

std::optional<SpecularPath> PathVerifier::verify(std::span<const FacetId> sequence,
                                                 std::span<const Vec3> images,
                                                 const Vec3& listener,
                                                 Rejection* rejection) const {
    auto path = construct(sequence, images, listener);
    if (!path) {
        if (rejection != nullptr) {
            *rejection = {};
        }
        return std::nullopt;
    }
    // From the last leg to the first, so that what is inserted moves none that is still to come.
    std::vector<Transmission> transmissions;
    for (std::size_t i = sequence.size() + 1; i-- > 0;) {
        transmissions.clear();
        if (!leg_is_unobstructed(*path, sequence, i, nullptr, transmissions, rejection)) {
            return std::nullopt;
        }
        insert(*path, i, transmissions);
    }
    return path;
}

bool PathVerifier::reaches_edge(std::span<const FacetId> sequence,
                                std::span<const Vec3> images,
                                const geometry::Wedge& wedge,
                                const Vec3& point) const {
    const auto path = construct(sequence, images, point);
    if (!path) {
        return false;
    }
    std::vector<Transmission> transmissions;
    for (std::size_t i = sequence.size() + 1; i-- > 0;) {
        const geometry::Wedge* edge = i == sequence.size() ? &wedge : nullptr;
        if (!leg_is_unobstructed(*path, sequence, i, edge, transmissions, nullptr) ||
            !transmissions.empty()) {
            return false;
        }
    }
    return true;
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
    const double margin = 2.0 * surface.deviation + slack;
    scene_.bvh.traverse(
        [&](const geometry::Aabb& box) {
            for (int k = 0; k < 3; ++k) {
                const auto index = static_cast<std::size_t>(k);
                if (point[k] < static_cast<double>(box.lower[index]) - margin ||
                    point[k] > static_cast<double>(box.upper[index]) + margin) {
                    return false;
                }
            }
            return true;
        },
        [&](TriangleId id) {
            if (scene_.facets.of_triangle[id] == facet) {
                const geometry::Triangle& triangle = scene_.mesh().triangles[id];
                std::array<glm::dvec2, 3> corner;
                for (std::size_t k = 0; k < 3; ++k) {
                    corner[k] = project(scene_.mesh().positions[triangle[k]], axis);
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

// Whether the facet has a part above another's plane, on the given side, at this point of its
// border.
bool PathVerifier::extends_above(
    FacetId other, double side, FacetId facet, const Vec3& point, double slack) const {
    const geometry::Facet& base = scene_.facets.facets[other];
    const double flatness = base.deviation + scene_.facets.tolerance;
    bool extends = false;
    visit_triangles_at(facet, point, slack, [&](TriangleId id, Containment where) {
        for (const geometry::VertexId vertex : scene_.mesh().triangles[id]) {
            const double height = side * base.plane.distance(scene_.mesh().positions[vertex]);
            extends = extends || (where != Containment::outside && height > flatness);
        }
    });
    return extends;
}

// Sound goes from one facet to the next only if each lies on the reflecting side of the other. For
// a leg that ends in both planes, in the edge that they share, its ends do not decide that: without
// this test a listener at the source would receive a reflection from every outer edge of a box.
bool PathVerifier::turns_at_outer_edge(std::span<const FacetId> sequence,
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
             !extends_above(first, side_of(first, images[i]), second, to, slack)) ||
            (lies_in(second, from) &&
             !extends_above(second, side_of(second, images[i + 1]), first, from, slack))) {
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
    return {.facet = facet, .height = std::abs(plane.distance(other_end))};
}

// Whether a triangle that the leg meets at parameter `t` from its end, at most `max_t`, belongs to
// the surface that reflects there: it is of the facet itself; it meets the facet in the reflection
// point, which is known up to rounding and up to the facet's deviation from its plane; or it is a
// layer coincident with the facet.
bool PathVerifier::belongs_to_reflection(const LegEnd& end,
                                         TriangleId triangle,
                                         double t,
                                         double max_t) const {
    if (end.facet == nullptr) {
        return false;
    }
    const geometry::Facets& facets = scene_.facets;
    if (facets.of_triangle[triangle] == *end.facet) {
        return true;
    }
    const geometry::Facet& surface = facets.facets[*end.facet];
    const double height = t * end.height;
    const double joint = surface.deviation + rounding_slack(end.height);
    return t <= max_t && (height <= joint || (height <= joint + facets.tolerance &&
                                              is_coincident_layer(scene_, surface, triangle)));
}

// Consecutive reflections on layers of one surface have a leg between them, where no path fits.
// Parallel layers are told by their planes, those of narrow facets, which rounding tilts, by their
// triangles.
bool PathVerifier::runs_between_layers(std::span<const FacetId> sequence,
                                       const SpecularPath& path) const {
    const geometry::Facets& facets = scene_.facets;
    for (std::size_t i = 0; i + 1 < sequence.size(); ++i) {
        const geometry::Facet& first = facets.facets[sequence[i]];
        const geometry::Facet& second = facets.facets[sequence[i + 1]];
        const Vec3& from = path.points[i + 1];
        const Vec3& to = path.points[i + 2];
        const double max_distance = max_layer_distance(facets, first, second);
        const bool are_close = std::abs(first.plane.distance(to)) <= max_distance &&
                               std::abs(second.plane.distance(from)) <= max_distance;
        if (are_close && (are_coincident_at(facets, first, from, second, to) ||
                          is_coincident_layer(scene_, first, path.triangles[i + 1]) ||
                          is_coincident_layer(scene_, second, path.triangles[i]))) {
            return true;
        }
    }
    return false;
}

// Whether a triangle that a leg to a wedge meets at `t` belongs to the surfaces at the edge: it is
// of a face or a layer of one, in whose planes the leg ends; or it meets the edge in the leg's end.
bool PathVerifier::belongs_to_edge(const geometry::Wedge& wedge,
                                   TriangleId triangle,
                                   const Vec3& from,
                                   const Vec3& to,
                                   double t,
                                   double max_t) const {
    const geometry::Facets& facets = scene_.facets;
    for (const geometry::WedgeFace& face : wedge.faces) {
        if (belongs_to_reflection(end_of_leg(&face.facet, from), triangle, 1.0 - t, max_t)) {
            return true;
        }
    }
    const Vec3 offset = from + t * (to - from) - wedge.begin;
    const Vec3 across = offset - glm::dot(offset, wedge.direction) * wedge.direction;
    const double reach =
        facets.facets[facets.of_triangle[triangle]].deviation + kEdgeTolerances * facets.tolerance;
    return 1.0 - t <= max_t && glm::dot(across, across) <= reach * reach;
}

// `edge`: the wedge in which the leg ends, or null. `rejection`: set if the leg is obstructed; may
// be null.
bool PathVerifier::leg_is_unobstructed(const SpecularPath& path,
                                       std::span<const FacetId> sequence,
                                       std::size_t leg,
                                       const geometry::Wedge* edge,
                                       std::vector<Transmission>& transmissions,
                                       Rejection* rejection) const {
    const Vec3 from = path.points[leg];
    const Vec3 to = path.points[leg + 1];
    const LegEnd start = end_of_leg(leg > 0 ? &sequence[leg - 1] : nullptr, to);
    const LegEnd finish = end_of_leg(leg < sequence.size() ? &sequence[leg] : nullptr, from);
    const double length = glm::distance(from, to);
    const double max_t = contact_radius() / length;
    const auto blocks = [&](TriangleId id, double t) {
        if (belongs_to_reflection(start, id, t, max_t) ||
            belongs_to_reflection(finish, id, 1.0 - t, max_t) ||
            (edge != nullptr && belongs_to_edge(*edge, id, from, to, t, max_t))) {
            return false;
        }
        const FacetId facet = scene_.facets.of_triangle[id];
        if ((!is_transmissive(facet) && !may_be_covered(facet)) ||
            leg_lies_in_plane(facet, from, to)) {
            if (rejection != nullptr) {
                *rejection = {Rejection::Reason::blocked, id};
            }
            return true;
        }
        transmissions.push_back({t, facet, id});
        return false;
    };
    if (scene_.bvh.any_hit({from, to}, blocks)) {
        return false;
    }
    remove_covered(transmissions, from, to);
    if (std::any_of(transmissions.begin(), transmissions.end(), [&](const Transmission& crossed) {
            return !is_transmissive(crossed.facet);
        })) {
        if (rejection != nullptr) {
            *rejection = {Rejection::Reason::blocked_by_layer};
        }
        return false;
    }
    deduplicate(transmissions, length);
    return true;
}

// Of coincident layers that the leg crosses, the triangle with the lowest number counts, whether it
// is transmissive or not.
void PathVerifier::remove_covered(std::vector<Transmission>& transmissions,
                                  const Vec3& from,
                                  const Vec3& to) const {
    if (transmissions.size() < 2) {
        return;
    }
    const auto& facets = scene_.facets;
    const auto point_of = [&](const Transmission& crossed) {
        return from + crossed.t * (to - from);
    };
    std::sort(transmissions.begin(),
              transmissions.end(),
              [](const Transmission& a, const Transmission& b) { return a.triangle < b.triangle; });
    std::vector<Transmission> counted;
    for (const Transmission& crossed : transmissions) {
        const bool is_covered =
            std::any_of(counted.begin(), counted.end(), [&](const Transmission& earlier) {
                return earlier.facet != crossed.facet &&
                       are_coincident_at(facets,
                                         facets.facets[earlier.facet],
                                         point_of(earlier),
                                         facets.facets[crossed.facet],
                                         point_of(crossed));
            });
        if (!is_covered) {
            counted.push_back(crossed);
        }
    }
    transmissions = std::move(counted);
}

bool PathVerifier::leg_lies_in_plane(FacetId facet, const Vec3& from, const Vec3& to) const {
    const Plane& plane = scene_.facets.facets[facet].plane;
    const double slack = rounding_slack(glm::distance(from, to));
    return std::abs(plane.distance(from)) <= slack && std::abs(plane.distance(to)) <= slack;
}

// Sound passes a facet once, whichever of its triangles are touched, and so an edge of two facets.
void PathVerifier::deduplicate(std::vector<Transmission>& transmissions, double length) const {
    std::sort(transmissions.begin(),
              transmissions.end(),
              [](const Transmission& a, const Transmission& b) {
                  return std::tie(a.facet, a.triangle) < std::tie(b.facet, b.triangle);
              });
    const auto of_one_facet = [](const Transmission& a, const Transmission& b) {
        return a.facet == b.facet;
    };
    transmissions.erase(std::unique(transmissions.begin(), transmissions.end(), of_one_facet),
                        transmissions.end());
    std::stable_sort(transmissions.begin(),
                     transmissions.end(),
                     [](const Transmission& a, const Transmission& b) { return a.t < b.t; });
    const double slack = rounding_slack(length);
    const auto at_one_point = [&](const Transmission& a, const Transmission& b) {
        return (b.t - a.t) * length <= slack;
    };
    transmissions.erase(std::unique(transmissions.begin(), transmissions.end(), at_one_point),
                        transmissions.end());
}

void PathVerifier::insert(SpecularPath& path,
                          std::size_t leg,
                          std::span<const Transmission> transmissions) {
    if (path.transmitted.empty() && !transmissions.empty()) {
        path.transmitted.assign(path.triangles.size(), 0);
    }
    const Vec3 from = path.points[leg];
    const Vec3 way = path.points[leg + 1] - from;
    auto position = static_cast<std::ptrdiff_t>(leg);
    for (const Transmission& transmission : transmissions) {
        path.triangles.insert(path.triangles.begin() + position, transmission.triangle);
        path.transmitted.insert(path.transmitted.begin() + position, 1);
        path.points.insert(path.points.begin() + position + 1, from + transmission.t * way);
        ++position;
    }
}

}  // namespace earshot::frustum
