// SPDX-License-Identifier: MIT
#include "earshot/frustum/internal/edge_intervals.h"

#include "earshot/frustum/internal/facet_index.h"
#include "earshot/frustum/internal/reflection_point.h"
#include "earshot/geometry/predicates.h"
#include "earshot/geometry/vector.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace earshot::frustum {

using geometry::FacetId;
using geometry::Interval;
using geometry::Plane;
using geometry::TriangleId;
using geometry::Vec3;
using geometry::Wedge;

namespace {

/// Places on an edge this many rounding slacks apart are one: what is between is below the
/// precision of either.
constexpr double kPlaceSlacks = 64.0;

/// In the plane of a fan: metres from the edge's line towards the source, and along the edge.
struct FanPoint {
    double r = 0.0;
    double z = 0.0;
};

}  // namespace

/// One leg of all ways over an edge.
struct EdgeIntervals::Fan {
    Vec3 source{0.0};               // the image that the leg comes from
    Vec3 begin{0.0}, end{0.0};      // the image of the edge that it goes to
    Vec3 along{0.0}, across{0.0};   // unit vectors: along the edge, and from its line to the source
    FanPoint apex;                  // the source
    double length = 0.0;            // of the edge
    const FacetId* from = nullptr;  // the facets at the leg's ends, null: source, edge
    const FacetId* to = nullptr;

    FanPoint project(const Vec3& point) const noexcept {
        return {glm::dot(point - begin, across), glm::dot(point - begin, along)};
    }
    /// The place on the edge behind a point as seen from the source.
    std::optional<double> place_behind(const FanPoint& point) const noexcept {
        const double depth = apex.r - point.r;
        if (!(depth > 0.0)) {
            return std::nullopt;
        }
        return apex.z + (point.z - apex.z) * (apex.r / depth);
    }
    void add(const FanPoint& point, std::vector<double>& places) const {
        const auto place = place_behind(point);
        if (place && *place > 0.0 && *place < length) {
            places.push_back(*place);
        }
    }
    /// Where an edge of a triangle or outline meets the plane of the fan, exact in whether it does.
    template <typename Visit>
    void cross(const Vec3& a, const Vec3& b, Visit&& visit) const {
        const double before = geometry::determinant3d(source, begin, end, a);
        const double after = geometry::determinant3d(source, begin, end, b);
        if (before == 0.0) {
            visit(project(a));
        }
        if (after == 0.0) {
            visit(project(b));
        }
        if ((before < 0.0 && after > 0.0) || (before > 0.0 && after < 0.0)) {
            visit(project(a + (before / (before - after)) * (b - a)));
        }
    }
};

// The sector is told by heights over the faces' planes where rounding counts.
bool EdgeIntervals::may_reach(std::span<const FacetId> sequence,
                              const Vec3& image,
                              const Wedge& wedge) const {
    const geometry::WedgePoint point = geometry::wedge_coordinates(wedge, image);
    const double slack = verifier_.rounding_slack(glm::distance(image, wedge.begin));
    const double grazing = kGrazingSlacks * slack;
    if (point.radius <= grazing) {
        return false;
    }
    // Angles that lie outside of [0, open angle] by rounding graze a face, too.
    if (point.angle * point.radius <= grazing ||
        (wedge.open_angle - point.angle) * point.radius <= grazing) {
        return false;
    }
    if (sequence.empty()) {
        return true;
    }
    // A facet in whose plane the edge lies would reflect in the edge itself.
    const Plane& last = scene_.facets.facets[sequence.back()].plane;
    const double flatness = scene_.facets.tolerance + slack;
    return std::abs(last.distance(wedge.begin)) > flatness ||
           std::abs(last.distance(wedge.end)) > flatness;
}

std::vector<EdgeIntervals::Fan> EdgeIntervals::fans(std::span<const FacetId> sequence,
                                                    std::span<const Vec3> images,
                                                    const Wedge& wedge) const {
    std::vector<Fan> fans(sequence.size() + 1);
    Vec3 begin = wedge.begin;
    Vec3 end = wedge.end;
    for (std::size_t leg = sequence.size() + 1; leg-- > 0;) {
        Fan& fan = fans[leg];
        fan.source = images[leg];
        fan.begin = begin;
        fan.end = end;
        fan.length = glm::distance(begin, end);
        fan.along = (end - begin) / fan.length;
        const Vec3 offset = fan.source - begin;
        fan.across = geometry::normalized(offset - glm::dot(offset, fan.along) * fan.along);
        fan.apex = fan.project(fan.source);
        fan.from = leg > 0 ? &sequence[leg - 1] : nullptr;
        fan.to = leg < sequence.size() ? &sequence[leg] : nullptr;
        if (leg > 0) {
            const Plane& plane = scene_.facets.facets[sequence[leg - 1]].plane;
            begin = plane.mirror(begin);
            end = plane.mirror(end);
        }
    }
    return fans;
}

// Through which part of the fan's plane the facet lets sound pass.
void EdgeIntervals::add_window(const Fan& fan, FacetId facet, std::vector<double>& places) const {
    for (const geometry::Loop& loop : scene_.facets.facets[facet].loops) {
        for (std::size_t i = 0; i < loop.size(); ++i) {
            fan.cross(loop[i], loop[(i + 1) % loop.size()], [&](const FanPoint& point) {
                fan.add(point, places);
            });
        }
    }
}

// Where the plane of a facet at one end of the leg meets the edge, or the plane of the facet at the
// other end: beyond, the facets are met in another order.
void EdgeIntervals::add_plane(const Fan& fan, FacetId facet, std::vector<double>& places) const {
    const Plane& plane = scene_.facets.facets[facet].plane;
    const double at_begin = plane.distance(fan.begin);
    const double at_end = plane.distance(fan.end);
    if ((at_begin < 0.0) != (at_end < 0.0)) {
        places.push_back(fan.length * (at_begin / (at_begin - at_end)));
    }
    if (fan.from == nullptr || fan.to == nullptr || *fan.to != facet) {
        return;
    }
    // h + a r + b z = 0 for both planes.
    const Plane& other = scene_.facets.facets[*fan.from].plane;
    const double h1 = at_begin, h2 = other.distance(fan.begin);
    const double a1 = glm::dot(plane.normal, fan.across), b1 = glm::dot(plane.normal, fan.along);
    const double a2 = glm::dot(other.normal, fan.across), b2 = glm::dot(other.normal, fan.along);
    const double determinant = a1 * b2 - a2 * b1;
    if (determinant != 0.0) {
        fan.add({(b1 * h2 - b2 * h1) / determinant, (a2 * h1 - a1 * h2) / determinant}, places);
    }
}

// The segment in which the triangle cuts the fan's plane: its ends, and where it passes the edge or
// the planes in which the leg begins and ends.
void EdgeIntervals::add_obstacle(const Fan& fan,
                                 TriangleId triangle,
                                 std::vector<double>& places) const {
    const auto corner = scene_.bvh.corners(triangle);
    std::array<FanPoint, 9> cut;
    std::size_t count = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        fan.cross(
            corner[k], corner[(k + 1) % 3], [&](const FanPoint& point) { cut[count++] = point; });
    }
    const auto add_crossing = [&](double before, double after, std::size_t i, std::size_t j) {
        if ((before < 0.0) != (after < 0.0)) {
            const double t = before / (before - after);
            fan.add({cut[i].r + t * (cut[j].r - cut[i].r), cut[i].z + t * (cut[j].z - cut[i].z)},
                    places);
        }
    };
    const auto height = [&](const FacetId* facet, const FanPoint& point) {
        return scene_.facets.facets[*facet].plane.distance(fan.begin + point.r * fan.across +
                                                           point.z * fan.along);
    };
    for (std::size_t i = 0; i < count; ++i) {
        fan.add(cut[i], places);
        for (std::size_t j = i + 1; j < count; ++j) {
            add_crossing(cut[i].r, cut[j].r, i, j);
            for (const FacetId* facet : {fan.from, fan.to}) {
                if (facet != nullptr) {
                    add_crossing(height(facet, cut[i]), height(facet, cut[j]), i, j);
                }
            }
        }
    }
}

void EdgeIntervals::add_obstacles(const Fan& fan,
                                  const Wedge& wedge,
                                  std::vector<double>& places) const {
    // The part of space that contains the leg: the fan, grown by more than the rounding of what
    // bounds it, between the planes of the facets at its ends.
    const double slack =
        verifier_.rounding_slack(fan.apex.r + fan.length) + scene_.facets.tolerance;
    const Vec3 normal = glm::cross(fan.along, fan.across);
    std::array<Plane, 7> planes;
    std::size_t count = 0;
    const auto add = [&](const Vec3& outward, const Vec3& point) {
        planes[count++] = {outward, glm::dot(outward, point) + slack};
    };
    add(normal, fan.begin);
    add(-normal, fan.begin);
    add(-fan.across, fan.begin);
    add(geometry::normalized(glm::cross(normal, fan.source - fan.begin)), fan.begin);
    add(geometry::normalized(glm::cross(fan.source - fan.end, normal)), fan.end);
    if (fan.from != nullptr) {
        // The image behind the facet lies on its far side.
        const Plane& plane = scene_.facets.facets[*fan.from].plane;
        const double sign = plane.distance(fan.source) > 0.0 ? 1.0 : -1.0;
        planes[count++] = {sign * plane.normal, sign * plane.offset + slack};
    }
    if (fan.to != nullptr) {
        const Plane& plane = scene_.facets.facets[*fan.to].plane;
        const double sign = plane.distance(fan.source) > 0.0 ? -1.0 : 1.0;
        planes[count++] = {sign * plane.normal, sign * plane.offset + slack};
    }
    // Of the box, the corner that lies deepest behind each plane.
    scene_.bvh.traverse(
        [&](const geometry::Aabb& box) {
            for (std::size_t i = 0; i < count; ++i) {
                double depth = -planes[i].offset;
                for (std::size_t k = 0; k < 3; ++k) {
                    const double n = planes[i].normal[static_cast<int>(k)];
                    depth += n * static_cast<double>(n > 0.0 ? box.lower[k] : box.upper[k]);
                }
                if (depth > 0.0) {
                    return false;
                }
            }
            return true;
        },
        [&](TriangleId id) {
            const FacetId facet = scene_.facets.of_triangle[id];
            const bool is_at_end = (fan.from != nullptr && facet == *fan.from) ||
                                   (fan.to != nullptr && facet == *fan.to) ||
                                   (fan.to == nullptr && (facet == wedge.faces[0].facet ||
                                                          facet == wedge.faces[1].facet));
            if (!is_at_end) {
                add_obstacle(fan, id, places);
            }
            return true;
        });
}

std::vector<Interval> EdgeIntervals::find(std::span<const FacetId> sequence,
                                          std::span<const Vec3> images,
                                          const Wedge& wedge) const {
    if (!may_reach(sequence, images[sequence.size()], wedge)) {
        return {};
    }
    const double length = wedge.length();
    std::vector<double> places{0.0, length};
    for (const Fan& fan : fans(sequence, images, wedge)) {
        for (const FacetId* facet : {fan.from, fan.to}) {
            if (facet != nullptr) {
                add_plane(fan, *facet, places);
            }
        }
        if (fan.to != nullptr) {
            add_window(fan, *fan.to, places);
        }
        add_obstacles(fan, wedge, places);
    }
    std::sort(places.begin(), places.end());
    const double same =
        kPlaceSlacks * verifier_.rounding_slack(length + glm::distance(images.back(), wedge.begin));
    std::vector<Interval> found;
    double from = 0.0;
    bool was_reached = false;
    for (const double place : places) {
        if (place - from <= same && place != length) {
            continue;
        }
        const bool is_reached =
            place - from > same &&
            verifier_.reaches_edge(sequence, images, wedge, wedge.point_at(0.5 * (from + place)));
        if (is_reached && was_reached) {
            found.back().max = place;
        } else if (is_reached) {
            found.push_back({from, place});
        }
        was_reached = is_reached;
        from = place;
    }
    return found;
}

}  // namespace earshot::frustum
