// SPDX-License-Identifier: MIT
#include "earshot/frustum/internal/edge_links.h"

#include "earshot/base/math.h"
#include "earshot/frustum/internal/separation.h"
#include "earshot/geometry/overlap.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace earshot::frustum {

using geometry::Interval;
using geometry::TriangleId;
using geometry::Vec3;
using geometry::Wedge;

namespace {

/// Of the first edge, where samples decide.
constexpr std::size_t kSamples = 8;
/// An edge this close to the plane of a face is seen along the face, in slacks of rounding: as
/// where the sides of first-order paths are found.
constexpr double kGrazingSlacks = 8.0;
/// How far off an edge a way begins that leaves it, in contact radii: beyond the surfaces that meet
/// there.
constexpr double kStartRadii = 4.0;

/// All four ends of two parts.
std::array<Vec3, 4> ends_of(const EdgePart& first, const EdgePart& second) {
    return {first.wedge.point_at(first.part.min),
            first.wedge.point_at(first.part.max),
            second.wedge.point_at(second.part.min),
            second.wedge.point_at(second.part.max)};
}

/// Points in a plane, with two of its directions for axes.
class PlaneView {
public:
    PlaneView(const Vec3& origin, const Vec3& normal, const Vec3& along)
        : origin_(origin), normal_(normal), x_(along), y_(glm::cross(normal, along)) {}

    glm::dvec2 project(const Vec3& point) const {
        return {glm::dot(point - origin_, x_), glm::dot(point - origin_, y_)};
    }
    double height(const Vec3& point) const { return glm::dot(point - origin_, normal_); }

private:
    Vec3 origin_, normal_, x_, y_;
};

/// What a triangle has in common with a plane, up to `slack` from it.
std::vector<glm::dvec2> section(const std::array<Vec3, 3>& corners,
                                const PlaneView& plane,
                                double slack) {
    std::vector<glm::dvec2> points;
    for (std::size_t k = 0; k < 3; ++k) {
        const Vec3& a = corners[k];
        const Vec3& b = corners[(k + 1) % 3];
        const double at_a = plane.height(a), at_b = plane.height(b);
        if (std::abs(at_a) <= slack) {
            points.push_back(plane.project(a));
        } else if (std::abs(at_b) > slack && (at_a < 0.0) != (at_b < 0.0)) {
            points.push_back(plane.project(a + (at_a / (at_a - at_b)) * (b - a)));
        }
    }
    return points;
}

/// Visits the triangles whose boxes meet one about the points.
template <typename Visit>
void for_each_triangle_about(const SceneView& scene,
                             std::span<const Vec3> points,
                             double slack,
                             const Visit& visit) {
    Vec3 lower = points.front(), upper = lower;
    for (const Vec3& point : points) {
        lower = glm::min(lower, point);
        upper = glm::max(upper, point);
    }
    const geometry::BoxRegion about(lower - Vec3(slack), upper + Vec3(slack));
    scene.bvh.traverse([&](const geometry::Aabb& box) { return about.may_touch(box); },
                       [&](TriangleId id) { return visit(id); });
}

}  // namespace

// The parts of an edge that lie in the sector of another wedge and in neither of its faces.
std::vector<Interval> EdgeLinks::in_air(const Wedge& about, const EdgePart& part) const {
    const double slack = verifier_.rounding_slack(glm::distance(about.begin, part.wedge.begin) +
                                                  about.length() + part.wedge.length());
    const Vec3 second_normal =
        math::cos(about.open_angle) * about.normal - math::sin(about.open_angle) * about.tangent;
    std::vector<double> places{part.part.min, part.part.max};
    for (const Vec3& normal : {about.normal, second_normal}) {
        const double at_begin = glm::dot(normal, part.wedge.point_at(part.part.min) - about.begin);
        const double at_end = glm::dot(normal, part.wedge.point_at(part.part.max) - about.begin);
        if ((at_begin < -slack && at_end > slack) || (at_begin > slack && at_end < -slack)) {
            places.push_back(part.part.min +
                             at_begin / (at_begin - at_end) * (part.part.max - part.part.min));
        }
    }
    std::sort(places.begin(), places.end());
    std::vector<Interval> found;
    for (std::size_t i = 0; i + 1 < places.size(); ++i) {
        const double middle = 0.5 * (places[i] + places[i + 1]);
        const geometry::WedgePoint at =
            geometry::wedge_coordinates(about, part.wedge.point_at(middle));
        const double grazing = kGrazingSlacks * slack;
        if (at.radius <= grazing || at.angle * at.radius <= grazing ||
            (about.open_angle - at.angle) * at.radius <= grazing) {
            continue;
        }
        if (!found.empty() && found.back().max == places[i]) {
            found.back().max = places[i + 1];
        } else {
            found.push_back({places[i], places[i + 1]});
        }
    }
    return found;
}

// Conservative: false where a triangle could not be told apart from the hull. What only touches the
// hull from outside, as the faces of the wedges do, is met by ways at its border alone.
bool EdgeLinks::hull_is_free(const EdgePart& first, const EdgePart& second) const {
    const std::array<Vec3, 4> ends = ends_of(first, second);
    const double slack = verifier_.rounding_slack(glm::distance(ends[0], ends[1]) +
                                                  glm::distance(ends[0], ends[2])) +
                         scene_.facets.tolerance;
    const Vec3 along = geometry::normalized(ends[1] - ends[0]);
    // The plane of the first edge and of the end of the second that is farther from its line.
    const Vec3 across = glm::cross(along, ends[2] - ends[0]);
    const Vec3 other = glm::cross(along, ends[3] - ends[0]);
    const Vec3 normal =
        geometry::normalized(glm::dot(across, across) < glm::dot(other, other) ? other : across);
    const PlaneView plane(ends[0], normal, along);
    const bool is_flat =
        std::abs(plane.height(ends[2])) <= slack && std::abs(plane.height(ends[3])) <= slack;
    std::array<glm::dvec2, 4> outline{};
    std::transform(ends.begin(), ends.end(), outline.begin(), [&](const Vec3& end) {
        return plane.project(end);
    });
    bool is_free = true;
    for_each_triangle_about(scene_, ends, slack, [&](TriangleId id) {
        const auto corners = scene_.bvh.corners(id);
        const std::array<Vec3, 3> triangle{corners[0], corners[1], corners[2]};
        if (is_flat) {
            const auto cut = section(triangle, plane, slack);
            is_free = cut.empty() || are_separate(outline, cut, slack);
        } else {
            is_free = are_separate(ends, triangle, slack);
        }
        return is_free;
    });
    return is_free;
}

namespace {

/// Slices that see the same of the second edge, one beside the other, are one link.
void add_slice(const EdgeLink& slice, std::vector<EdgeLink>& links) {
    for (EdgeLink& link : links) {
        if (link.first.max == slice.first.min && link.second.min == slice.second.min &&
            link.second.max == slice.second.max) {
            link.first.max = slice.first.max;
            return;
        }
    }
    links.push_back(slice);
}

}  // namespace

// Slices of the first edge, each of which sees what its middle sees.
void EdgeLinks::sample_air(const EdgePart& first, const EdgePart& second, Found& found) const {
    found.is_sampled = true;
    const Vec3 target = second.wedge.point_at(0.5 * (second.part.min + second.part.max));
    const double size = (first.part.max - first.part.min) / static_cast<double>(kSamples);
    for (std::size_t i = 0; i < kSamples; ++i) {
        const double begin = first.part.min + size * static_cast<double>(i);
        const double end = first.part.min + size * static_cast<double>(i + 1);
        const Vec3 on_edge = first.wedge.point_at(begin + 0.5 * size);
        const Vec3 start = on_edge + kStartRadii * verifier_.contact_radius() *
                                         geometry::direction_between(on_edge, target);
        const geometry::WedgePoint at = geometry::wedge_coordinates(second.wedge, start);
        if (!intervals_.may_reach(nullptr, start, at, second.wedge)) {
            continue;
        }
        for (const Interval& seen : intervals_.find({}, {&start, 1}, second.wedge, second.part)) {
            const Interval part{std::max(seen.min, second.part.min),
                                std::min(seen.max, second.part.max)};
            if (part.min < part.max) {
                add_slice({{begin, end}, part}, found.links);
            }
        }
    }
}

EdgeLinks::Found EdgeLinks::through_air(const EdgePart& first, const EdgePart& second) const {
    Found found;
    for (const Interval& of_first : in_air(second.wedge, first)) {
        for (const Interval& of_second : in_air(first.wedge, second)) {
            const EdgePart a{first.wedge, of_first};
            const EdgePart b{second.wedge, of_second};
            if (hull_is_free(a, b)) {
                found.links.push_back({of_first, of_second});
            } else {
                sample_air(a, b, found);
            }
        }
    }
    return found;
}

namespace {

/// The face of a facet as a plane drawing: what stands on it, and its outline.
class FaceDrawing {
public:
    FaceDrawing(const SceneView& scene,
                const geometry::WedgeFace& face,
                std::span<const Vec3> ends,
                double slack)
        : facet_(scene.facets.facets[face.facet]),
          plane_(ends[0],
                 face.is_front ? facet_.plane.normal : -facet_.plane.normal,
                 geometry::normalized(ends[1] - ends[0])),
          slack_(slack) {
        std::transform(ends.begin(), ends.end(), quad_.begin(), [&](const Vec3& end) {
            return plane_.project(end);
        });
        for (const geometry::Loop& loop : facet_.loops) {
            for (std::size_t i = 0; i < loop.size(); ++i) {
                outline_.push_back(
                    {plane_.project(loop[i]), plane_.project(loop[(i + 1) % loop.size()])});
            }
        }
        for (const auto& side : outline_) {
            add_if_met({side.begin(), side.end()});
        }
        // What has a point above the face, and meets its plane, stands on it.
        const double reach = slack + facet_.deviation + scene.facets.tolerance;
        for_each_triangle_about(scene, ends, reach, [&](TriangleId id) {
            const auto corners = scene.bvh.corners(id);
            const std::array<Vec3, 3> triangle{corners[0], corners[1], corners[2]};
            if (std::any_of(triangle.begin(), triangle.end(), [&](const Vec3& corner) {
                    return plane_.height(corner) > reach;
                })) {
                add_if_met(section(triangle, plane_, reach));
            }
            return true;
        });
    }

    bool is_free() const { return obstacles_.empty(); }
    std::span<const glm::dvec2> quad() const { return quad_; }

    /// Whether a straight way between two points of the outline runs in the facet past everything.
    bool is_open(const glm::dvec2& from, const glm::dvec2& to) const {
        // Not the outline at the ends of the way.
        constexpr double kInset = 1e-6;
        const std::array way{from + kInset * (to - from), to + kInset * (from - to)};
        return contains(0.5 * (from + to)) &&
               std::all_of(obstacles_.begin(), obstacles_.end(), [&](const auto& obstacle) {
                   return are_separate(way, obstacle, 0.0);
               });
    }

    /// By the number of sides to the right.
    bool contains(const glm::dvec2& point) const {
        bool is_inside = false;
        for (const auto& [a, b] : outline_) {
            if ((a.y > point.y) != (b.y > point.y) &&
                point.x < a.x + (point.y - a.y) / (b.y - a.y) * (b.x - a.x)) {
                is_inside = !is_inside;
            }
        }
        return is_inside;
    }

private:
    void add_if_met(std::vector<glm::dvec2> points) {
        if (!points.empty() && !are_separate(quad_, points, slack_)) {
            obstacles_.push_back(std::move(points));
        }
    }

    const geometry::Facet& facet_;
    PlaneView plane_;
    double slack_;
    std::array<glm::dvec2, 4> quad_{};
    std::vector<std::array<glm::dvec2, 2>> outline_;
    std::vector<std::vector<glm::dvec2>> obstacles_;  // points of convex hulls
};

}  // namespace

EdgeLinks::Found EdgeLinks::along_face(const EdgePart& first,
                                       const EdgePart& second,
                                       const geometry::WedgeFace& face) const {
    const std::array<Vec3, 4> ends = ends_of(first, second);
    const double slack = verifier_.rounding_slack(glm::distance(ends[0], ends[1]) +
                                                  glm::distance(ends[0], ends[2])) +
                         scene_.facets.tolerance;
    const FaceDrawing drawing(scene_, face, ends, slack);
    const auto quad = drawing.quad();
    Found found;
    if (drawing.is_free()) {
        if (drawing.contains(0.25 * (quad[0] + quad[1] + quad[2] + quad[3]))) {
            found.links.push_back({first.part, second.part});
        }
        return found;
    }
    found.is_sampled = true;
    const auto place = [&](const Interval& part, std::size_t slice) {
        return part.min +
               (part.max - part.min) * (static_cast<double>(slice) / static_cast<double>(kSamples));
    };
    for (std::size_t i = 0; i < kSamples; ++i) {
        bool was_open = false;
        for (std::size_t k = 0; k < kSamples; ++k) {
            const double half = 0.5 / static_cast<double>(kSamples);
            const double a = static_cast<double>(i) / static_cast<double>(kSamples) + half;
            const double b = static_cast<double>(k) / static_cast<double>(kSamples) + half;
            const bool is_open = drawing.is_open(quad[0] + a * (quad[1] - quad[0]),
                                                 quad[2] + b * (quad[3] - quad[2]));
            if (is_open && was_open) {
                found.links.back().second.max = place(second.part, k + 1);
            } else if (is_open) {
                found.links.push_back({{place(first.part, i), place(first.part, i + 1)},
                                       {place(second.part, k), place(second.part, k + 1)}});
            }
            was_open = is_open;
        }
    }
    return found;
}

}  // namespace earshot::frustum
