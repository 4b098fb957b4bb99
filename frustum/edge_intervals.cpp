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

}  // namespace

/// Heights of points of a fan above the plane of a facet, on the side of the fan's source.
struct EdgeIntervals::PlaneOverFan {
    double at_begin = 0.0, per_r = 0.0, per_z = 0.0;
    bool is_passed = false;  // the leg comes from behind it; else it ends there

    double at(const FanPoint& point) const noexcept {
        return at_begin + per_r * point.r + per_z * point.z;
    }
};

/// One leg of all ways over an edge.
struct EdgeIntervals::Fan {
    Vec3 source{0.0};               // the image that the leg comes from
    Vec3 begin{0.0}, end{0.0};      // the image of the edge that it goes to
    Vec3 along{0.0}, across{0.0};   // unit vectors: along the edge, and from its line to the source
    Vec3 normal{0.0};               // of the fan's plane, along x across
    FanPoint apex;                  // the source
    double length = 0.0;            // of the edge
    double slack = 0.0;             // metres: bounds the error of heights
    const FacetId* from = nullptr;  // the facets at the leg's ends, null: source, edge
    const FacetId* to = nullptr;
    std::array<PlaneOverFan, 2> planes;  // of those facets
    std::size_t plane_count = 0;

    FanPoint project(const Vec3& point) const noexcept {
        return {glm::dot(point - begin, across), glm::dot(point - begin, along)};
    }
    /// Above the fan's plane.
    double height(const Vec3& point) const noexcept { return glm::dot(point - begin, normal); }
    /// The same, with the sign of its exact value and small relative error.
    double exact_height(const Vec3& point) const noexcept {
        return -geometry::determinant3d(source, begin, end, point) / (length * apex.r);
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
    /// `before`, `after`: heights of its ends.
    template <typename Visit>
    void cross(const Vec3& a, const Vec3& b, double before, double after, Visit&& visit) const {
        if ((before > slack && after > slack) || (before < -slack && after < -slack)) {
            return;
        }
        // Rounding moves the crossing by the slack over the slope.
        constexpr double kMinSlope = 0x1p-12;
        const double drop = before - after;
        if (!(std::abs(before) > slack && std::abs(after) > slack) ||
            drop * drop < kMinSlope * kMinSlope * glm::dot(b - a, b - a)) {
            before = exact_height(a);
            after = exact_height(b);
        }
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

/// Places on an edge.
struct EdgeIntervals::Places {
    std::vector<double> changes;    ///< at which what is reached may change
    std::vector<Interval> shadows;  ///< that are certain not to be reached
};

// The sector is told by heights over the faces' planes where rounding counts.
bool EdgeIntervals::may_reach(const FacetId* mirror,
                              const Vec3& image,
                              const geometry::WedgePoint& point,
                              const Wedge& wedge) const {
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
    if (mirror == nullptr) {
        return true;
    }
    // A facet in whose plane the edge lies would reflect in the edge itself.
    const Plane& last = scene_.facets.facets[*mirror].plane;
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
        fan.normal = glm::cross(fan.along, fan.across);
        fan.apex = fan.project(fan.source);
        // The plane is the less certain the closer the source is to the edge's line.
        const double distance = glm::length(offset);
        fan.slack = verifier_.rounding_slack(distance + fan.length) * (1.0 + distance / fan.apex.r);
        fan.from = leg > 0 ? &sequence[leg - 1] : nullptr;
        fan.to = leg < sequence.size() ? &sequence[leg] : nullptr;
        for (const FacetId* facet : {fan.from, fan.to}) {
            if (facet != nullptr) {
                const Plane& plane = scene_.facets.facets[*facet].plane;
                const double side = plane.distance(fan.source) > 0.0 ? 1.0 : -1.0;
                fan.planes[fan.plane_count++] = {side * plane.distance(begin),
                                                 side * glm::dot(plane.normal, fan.across),
                                                 side * glm::dot(plane.normal, fan.along),
                                                 facet == fan.from};
            }
        }
        if (leg > 0) {
            const Plane& plane = scene_.facets.facets[sequence[leg - 1]].plane;
            begin = plane.mirror(begin);
            end = plane.mirror(end);
        }
    }
    return fans;
}

// Through which part of the fan's plane the facet lets sound pass.
void EdgeIntervals::add_outline(const Fan& fan, FacetId facet, std::vector<double>& places) const {
    for (const geometry::Loop& loop : scene_.facets.facets[facet].loops) {
        double before = fan.height(loop.back());
        for (std::size_t i = 0; i < loop.size(); ++i) {
            const double after = fan.height(loop[i]);
            const Vec3& last = i > 0 ? loop[i - 1] : loop.back();
            fan.cross(last, loop[i], before, after, [&](const FanPoint& point) {
                fan.add(point, places);
            });
            before = after;
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
void EdgeIntervals::add_obstacle(const Fan& fan, TriangleId triangle, Places& places) const {
    const auto corner = scene_.bvh.corners(triangle);
    const std::array<double, 3> heights{
        fan.height(corner[0]), fan.height(corner[1]), fan.height(corner[2])};
    const auto [lowest, highest] = std::minmax({heights[0], heights[1], heights[2]});
    if (lowest > fan.slack || highest < -fan.slack) {
        return;
    }
    std::array<FanPoint, 9> cut;
    std::size_t count = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t next = (k + 1) % 3;
        fan.cross(corner[k], corner[next], heights[k], heights[next], [&](const FanPoint& point) {
            cut[count++] = point;
        });
    }
    const auto add_crossing = [&](double before, double after, std::size_t i, std::size_t j) {
        if ((before < 0.0) != (after < 0.0)) {
            const double t = before / (before - after);
            fan.add({cut[i].r + t * (cut[j].r - cut[i].r), cut[i].z + t * (cut[j].z - cut[i].z)},
                    places.changes);
        }
    };
    for (std::size_t i = 0; i < count; ++i) {
        fan.add(cut[i], places.changes);
        for (std::size_t j = i + 1; j < count; ++j) {
            add_crossing(cut[i].r, cut[j].r, i, j);
            for (std::size_t k = 0; k < fan.plane_count; ++k) {
                add_crossing(fan.planes[k].at(cut[i]), fan.planes[k].at(cut[j]), i, j);
            }
        }
    }
    // Off the plane by the slack, as rays are, the segment moves by the slack over the slope.
    constexpr double kMinSlope = 0x1p-8;
    const Vec3 a = corner[1] - corner[0], b = corner[2] - corner[0], c = b - a;
    const double size = std::max({glm::dot(a, a), glm::dot(b, b), glm::dot(c, c)});  // squared
    const double clear =
        std::min({std::abs(heights[0]), std::abs(heights[1]), std::abs(heights[2])});
    if (count == 2 && clear * clear > kMinSlope * kMinSlope * size) {
        add_shadow(fan, {cut[0], cut[1]}, places);
    }
}

// Between its ends the segment is in the way of every leg, if both lie within the leg by more than
// the reach within which the surfaces at its ends do not block.
void EdgeIntervals::add_shadow(const Fan& fan,
                               const std::array<FanPoint, 2>& segment,
                               Places& places) const {
    const double reach = 2.0 * verifier_.contact_radius();
    std::array<double, 2> behind{};
    for (std::size_t i = 0; i < 2; ++i) {
        const FanPoint& point = segment[i];
        for (std::size_t k = 0; k < fan.plane_count; ++k) {
            // Beyond the facet that the leg comes from, and before the one that it goes to.
            const double height = fan.planes[k].at(point);
            if ((fan.planes[k].is_passed ? -height : height) < reach) {
                return;
            }
        }
        const auto place = fan.place_behind(point);
        if (!place || point.r < reach || fan.apex.r - point.r < reach) {
            return;
        }
        behind[i] = *place;
    }
    constexpr double kSlacks = 0x1p12;
    const double margin =
        kSlacks * fan.slack * fan.apex.r / (fan.apex.r - std::max(segment[0].r, segment[1].r));
    const Interval shadow{std::min(behind[0], behind[1]) + margin,
                          std::max(behind[0], behind[1]) - margin};
    if (!shadow.is_empty()) {
        places.shadows.push_back(shadow);
    }
}

void EdgeIntervals::add_obstacles(const Fan& fan,
                                  const Wedge& wedge,
                                  const Interval& within,
                                  Places& places) const {
    // The part of space that contains the leg: the fan, grown by more than the rounding of what
    // bounds it, between the planes of the facets at its ends.
    const double slack =
        verifier_.rounding_slack(fan.apex.r + fan.length) + scene_.facets.tolerance;
    const Vec3& normal = fan.normal;
    const Vec3 first = fan.begin + within.min * fan.along;
    const Vec3 last = fan.begin + within.max * fan.along;
    std::array<Plane, 7> planes;
    std::size_t count = 0;
    const auto add = [&](const Vec3& outward, const Vec3& point) {
        planes[count++] = {outward, glm::dot(outward, point) + slack};
    };
    add(normal, fan.begin);
    add(-normal, fan.begin);
    add(-fan.across, fan.begin);
    add(geometry::normalized(glm::cross(normal, fan.source - first)), first);
    add(geometry::normalized(glm::cross(fan.source - last, normal)), last);
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

namespace {

/// Calls visit(from, to) for the intervals between ascending places that are longer than `same`.
template <typename Visit>
void for_each_interval(std::vector<double>& places, double same, Visit&& visit) {
    std::sort(places.begin(), places.end());
    double from = places.front();
    for (const double place : places) {
        if (place - from > same) {
            visit(from, place);
            from = place;
        }
    }
}

/// Ascending intervals of which none overlap.
void merge(std::vector<Interval>& intervals) {
    std::sort(intervals.begin(), intervals.end(), [](const Interval& a, const Interval& b) {
        return a.min < b.min;
    });
    std::size_t count = 0;
    for (const Interval& interval : intervals) {
        if (count > 0 && interval.min <= intervals[count - 1].max) {
            intervals[count - 1].max = std::max(intervals[count - 1].max, interval.max);
        } else {
            intervals[count++] = interval;
        }
    }
    intervals.resize(count);
}

}  // namespace

// Where the ways pass borders of facets that reflect, or meet them in another order.
std::vector<double> EdgeIntervals::mirror_places(std::span<const Fan> legs,
                                                 const Wedge& wedge) const {
    std::vector<double> places{0.0, wedge.length()};
    for (const Fan& fan : legs) {
        for (const FacetId* facet : {fan.from, fan.to}) {
            if (facet != nullptr) {
                add_plane(fan, *facet, places);
            }
        }
        if (fan.to != nullptr) {
            add_outline(fan, *fan.to, places);
        }
    }
    return places;
}

double EdgeIntervals::min_part(std::span<const Vec3> images, const Wedge& wedge) const {
    return kPlaceSlacks *
           verifier_.rounding_slack(wedge.length() + glm::distance(images.back(), wedge.begin));
}

Interval EdgeIntervals::window(std::span<const FacetId> sequence,
                               std::span<const Vec3> images,
                               const Wedge& wedge) const {
    const std::vector<Fan> legs = fans(sequence, images, wedge);
    std::vector<double> places = mirror_places(legs, wedge);
    Interval bounds{wedge.length(), 0.0};
    for_each_interval(places, min_part(images, wedge), [&](double from, double to) {
        if (verifier_.turns_in_facets(sequence, images, wedge.point_at(0.5 * (from + to)))) {
            bounds = {std::min(bounds.min, from), std::max(bounds.max, to)};
        }
    });
    return bounds;
}

std::vector<Interval> EdgeIntervals::find(std::span<const FacetId> sequence,
                                          std::span<const Vec3> images,
                                          const Wedge& wedge,
                                          const Interval& window) const {
    const std::vector<Fan> legs = fans(sequence, images, wedge);
    Places places{.changes = mirror_places(legs, wedge), .shadows = {}};
    places.changes.insert(places.changes.end(), {window.min, window.max});
    for (const Fan& fan : legs) {
        add_obstacles(fan, wedge, window, places);
    }
    merge(places.shadows);
    std::vector<Interval> found;
    auto shadow = places.shadows.begin();
    for_each_interval(places.changes, min_part(images, wedge), [&](double from, double to) {
        const double middle = 0.5 * (from + to);
        while (shadow != places.shadows.end() && shadow->max < middle) {
            ++shadow;
        }
        if (middle < window.min || middle > window.max ||
            (shadow != places.shadows.end() && shadow->min <= middle) ||
            !verifier_.reaches_edge(sequence, images, wedge, wedge.point_at(middle))) {
            return;
        }
        if (!found.empty() && found.back().max == from) {
            found.back().max = to;
        } else {
            found.push_back({from, to});
        }
    });
    return found;
}

std::vector<Interval> EdgeIntervals::find(std::span<const FacetId> sequence,
                                          std::span<const Vec3> images,
                                          const Wedge& wedge) const {
    const FacetId* mirror = sequence.empty() ? nullptr : &sequence.back();
    const Vec3& image = images[sequence.size()];
    if (!may_reach(mirror, image, geometry::wedge_coordinates(wedge, image), wedge)) {
        return {};
    }
    const Interval within =
        mirror == nullptr ? Interval{0.0, wedge.length()} : window(sequence, images, wedge);
    return within.is_empty() ? std::vector<Interval>{} : find(sequence, images, wedge, within);
}

}  // namespace earshot::frustum
