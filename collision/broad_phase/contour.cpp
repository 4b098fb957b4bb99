// SPDX-License-Identifier: MIT
#include "earshot/collision/broad_phase/internal/contour.h"

#include <glm/common.hpp>
#include <glm/ext/vector_double2.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <vector>

namespace earshot::collision {

using geometry::Vec3;
using geometry::VertexId;
using Vec2 = glm::dvec2;

namespace {

struct MovingPoint {
    Vec2 begin, end;

    Vec2 half_way() const noexcept { return begin + end; }  // doubled: only directions count
};

struct Box {
    Vec2 lower, upper;
};

double cross(const Vec2& a, const Vec2& b) noexcept {
    return a.x * b.y - a.y * b.x;
}

/// A contour projected onto a plane, and how it moves there.
class ProjectedContour {
public:
    ProjectedContour(const MovingScene& scene,
                     std::span<const VertexId> loop,
                     const Vec3& direction) {
        // 1. A basis of the plane of projection, orthogonal to the direction up to rounding.
        const Vec3 sizes = glm::abs(direction);
        const Vec3 axis = sizes.x <= sizes.y && sizes.x <= sizes.z ? Vec3(1.0, 0.0, 0.0)
                          : sizes.y <= sizes.z                     ? Vec3(0.0, 1.0, 0.0)
                                                                   : Vec3(0.0, 0.0, 1.0);
        const Vec3 right = glm::normalize(glm::cross(axis, direction));
        const Vec3 up = glm::cross(direction, right);
        // 2. Projected positions relative to the first vertex: a common motion changes nothing.
        const auto project = [&](const Vec3& point, const Vec3& origin) {
            const Vec3 offset = point - origin;
            const Vec3 size = glm::abs(offset);
            largest_ = std::max({largest_, size.x, size.y, size.z});
            return Vec2(glm::dot(offset, right), glm::dot(offset, up));
        };
        for (const VertexId vertex : loop) {
            points_.push_back({project(scene.begin[vertex], scene.begin[loop[0]]),
                               project(scene.end[vertex], scene.end[loop[0]])});
        }
        error_ = 0x1p-46 * largest_ + 1e-290;
        // 3. Boxes of the swept edges.
        for (std::uint32_t i = 0; i < points_.size(); ++i) {
            const MovingPoint& a = points_[i];
            const MovingPoint& b = points_[next(i)];
            boxes_.push_back({glm::min(glm::min(a.begin, a.end), glm::min(b.begin, b.end)),
                              glm::max(glm::max(a.begin, a.end), glm::max(b.begin, b.end))});
        }
    }

    bool self_intersects() const {
        std::vector<std::uint32_t> order(points_.size());
        std::iota(order.begin(), order.end(), 0U);
        std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
            return std::pair(boxes_[a].lower.x, a) < std::pair(boxes_[b].lower.x, b);
        });
        // Sweep and prune along x. A contour whose boxes overlap too often is given up.
        std::size_t budget = 64 * points_.size();
        for (std::size_t i = 0; i < order.size(); ++i) {
            const Box& box = boxes_[order[i]];
            for (std::size_t k = i + 1; k < order.size(); ++k) {
                const Box& other = boxes_[order[k]];
                if (other.lower.x > box.upper.x + error_) {
                    break;
                }
                if (budget-- == 0 ||
                    (other.lower.y <= box.upper.y + error_ &&
                     box.lower.y <= other.upper.y + error_ && !disjoint(order[i], order[k]))) {
                    return true;
                }
            }
        }
        return false;
    }

private:
    std::uint32_t next(std::uint32_t i) const noexcept {
        return i + 1 == points_.size() ? 0 : i + 1;
    }

    bool disjoint(std::uint32_t a, std::uint32_t b) const noexcept {
        if (next(a) == b) {
            return only_share_an_end(points_[b], points_[a], points_[next(b)]);
        }
        if (next(b) == a) {
            return only_share_an_end(points_[a], points_[b], points_[next(a)]);
        }
        const std::array<const MovingPoint*, 2> one{&points_[a], &points_[next(a)]};
        const std::array<const MovingPoint*, 2> other{&points_[b], &points_[next(b)]};
        const auto across = [](const std::array<const MovingPoint*, 2>& edge) {
            const Vec2 along = edge[1]->half_way() - edge[0]->half_way();
            return Vec2(-along.y, along.x);
        };
        constexpr std::array<Vec2, 8> kFixed{Vec2(1.0, 0.0),
                                             {0.0, 1.0},
                                             {1.0, 1.0},
                                             {1.0, -1.0},
                                             {1.0, 2.0},
                                             {2.0, 1.0},
                                             {1.0, -2.0},
                                             {2.0, -1.0}};
        return disjoint_along(across(one), one, other) ||
               disjoint_along(across(other), one, other) ||
               std::any_of(kFixed.begin(), kFixed.end(), [&](const Vec2& direction) {
                   return disjoint_along(direction, one, other);
               });
    }

    bool disjoint_along(const Vec2& direction,
                        const std::array<const MovingPoint*, 2>& one,
                        const std::array<const MovingPoint*, 2>& other) const noexcept {
        const double error =
            4.0 * error_ * (std::abs(direction.x) + std::abs(direction.y)) + 1e-290;
        const auto side = [&](Vec2 MovingPoint::*time) {
            const double a = glm::dot(one[0]->*time, direction);
            const double b = glm::dot(one[1]->*time, direction);
            const double c = glm::dot(other[0]->*time, direction);
            const double d = glm::dot(other[1]->*time, direction);
            return std::min(a, b) - std::max(c, d) > error   ? 1
                   : std::min(c, d) - std::max(a, b) > error ? -1
                                                             : 0;
        };
        const int begin = side(&MovingPoint::begin);
        return begin != 0 && begin == side(&MovingPoint::end);
    }

    /// Whether the edges from one point to two others share that point only.
    bool only_share_an_end(const MovingPoint& at,
                           const MovingPoint& a,
                           const MovingPoint& b) const noexcept {
        const Vec2 to_a = a.half_way() - at.half_way();
        const Vec2 to_b = b.half_way() - at.half_way();
        const Vec2 direction = to_a / glm::length(to_a) - to_b / glm::length(to_b);
        const double error =
            4.0 * error_ * (std::abs(direction.x) + std::abs(direction.y)) + 1e-290;
        const auto are_on_both_sides = [&](Vec2 MovingPoint::*time) {
            return glm::dot(a.*time - at.*time, direction) > error &&
                   glm::dot(b.*time - at.*time, direction) < -error;
        };
        if (are_on_both_sides(&MovingPoint::begin) && are_on_both_sides(&MovingPoint::end)) {
            return true;
        }
        const Vec2 a0 = a.begin - at.begin, b0 = b.begin - at.begin;
        const Vec2 a1 = a.end - at.end, b1 = b.end - at.end;
        const double area_error = 16.0 * error_ * largest_ + 1e-290;
        const double begin = cross(a0, b0);
        const double middle = 0.5 * (cross(a0, b1) + cross(a1, b0));
        const double end = cross(a1, b1);
        return (begin > area_error && middle > area_error && end > area_error) ||
               (begin < -area_error && middle < -area_error && end < -area_error);
    }

    std::vector<MovingPoint> points_;
    std::vector<Box> boxes_;  // swept edges, each from a point to the next
    double largest_ = 0.0;
    double error_ = 0.0;  // far above the rounding error of a projected position
};

}  // namespace

bool contour_self_intersects(const MovingScene& scene,
                             std::span<const VertexId> loop,
                             const Vec3& direction) {
    return ProjectedContour(scene, loop, direction).self_intersects();
}

}  // namespace earshot::collision
