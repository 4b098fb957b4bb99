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

class Loop {
public:
    Loop(const MovingScene& scene, std::span<const VertexId> loop, const Vec3& direction) {
        // Two directions across; the plane that they span is off a right angle by rounding alone.
        const Vec3 sizes = glm::abs(direction);
        const Vec3 axis = sizes.x <= sizes.y && sizes.x <= sizes.z ? Vec3(1.0, 0.0, 0.0)
                          : sizes.y <= sizes.z                     ? Vec3(0.0, 1.0, 0.0)
                                                                   : Vec3(0.0, 0.0, 1.0);
        const Vec3 right = glm::normalize(glm::cross(axis, direction));
        const Vec3 up = glm::cross(direction, right);
        // From a corner that moves along, since a common motion changes nothing.
        const auto seen = [&](const Vec3& point, const Vec3& origin) {
            const Vec3 offset = point - origin;
            const Vec3 size = glm::abs(offset);
            largest_ = std::max({largest_, size.x, size.y, size.z});
            return Vec2(glm::dot(offset, right), glm::dot(offset, up));
        };
        for (const VertexId vertex : loop) {
            points_.push_back({seen(scene.begin[vertex], scene.begin[loop[0]]),
                               seen(scene.end[vertex], scene.end[loop[0]])});
        }
        room_ = 0x1p-46 * largest_ + 1e-290;
        for (std::uint32_t i = 0; i < points_.size(); ++i) {
            const MovingPoint& a = points_[i];
            const MovingPoint& b = points_[next(i)];
            boxes_.push_back({glm::min(glm::min(a.begin, a.end), glm::min(b.begin, b.end)),
                              glm::max(glm::max(a.begin, a.end), glm::max(b.begin, b.end))});
        }
    }

    bool meets_itself() const {
        std::vector<std::uint32_t> order(points_.size());
        std::iota(order.begin(), order.end(), 0U);
        std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
            return std::pair(boxes_[a].lower.x, a) < std::pair(boxes_[b].lower.x, b);
        });
        // A loop whose edges mostly lie over each other is given up.
        std::size_t left = 64 * points_.size();
        for (std::size_t i = 0; i < order.size(); ++i) {
            const Box& box = boxes_[order[i]];
            for (std::size_t k = i + 1; k < order.size(); ++k) {
                const Box& other = boxes_[order[k]];
                if (other.lower.x > box.upper.x + room_) {
                    break;
                }
                if (left-- == 0 ||
                    (other.lower.y <= box.upper.y + room_ && box.lower.y <= other.upper.y + room_ &&
                     !are_apart(order[i], order[k]))) {
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

    bool are_apart(std::uint32_t a, std::uint32_t b) const noexcept {
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
        return are_apart_along(across(one), one, other) ||
               are_apart_along(across(other), one, other) ||
               std::any_of(kFixed.begin(), kFixed.end(), [&](const Vec2& direction) {
                   return are_apart_along(direction, one, other);
               });
    }

    bool are_apart_along(const Vec2& direction,
                         const std::array<const MovingPoint*, 2>& one,
                         const std::array<const MovingPoint*, 2>& other) const noexcept {
        const double room = 4.0 * room_ * (std::abs(direction.x) + std::abs(direction.y)) + 1e-290;
        const auto side = [&](Vec2 MovingPoint::*time) {
            const double a = glm::dot(one[0]->*time, direction);
            const double b = glm::dot(one[1]->*time, direction);
            const double c = glm::dot(other[0]->*time, direction);
            const double d = glm::dot(other[1]->*time, direction);
            return std::min(a, b) - std::max(c, d) > room   ? 1
                   : std::min(c, d) - std::max(a, b) > room ? -1
                                                            : 0;
        };
        const int begin = side(&MovingPoint::begin);
        return begin != 0 && begin == side(&MovingPoint::end);
    }

    /// Whether edges from a point to two others do not lie over each other.
    bool only_share_an_end(const MovingPoint& at,
                           const MovingPoint& a,
                           const MovingPoint& b) const noexcept {
        const Vec2 to_a = a.half_way() - at.half_way();
        const Vec2 to_b = b.half_way() - at.half_way();
        const Vec2 direction = to_a / glm::length(to_a) - to_b / glm::length(to_b);
        const double room = 4.0 * room_ * (std::abs(direction.x) + std::abs(direction.y)) + 1e-290;
        const auto are_on_both_sides = [&](Vec2 MovingPoint::*time) {
            return glm::dot(a.*time - at.*time, direction) > room &&
                   glm::dot(b.*time - at.*time, direction) < -room;
        };
        if (are_on_both_sides(&MovingPoint::begin) && are_on_both_sides(&MovingPoint::end)) {
            return true;
        }
        const Vec2 a0 = a.begin - at.begin, b0 = b.begin - at.begin;
        const Vec2 a1 = a.end - at.end, b1 = b.end - at.end;
        const double area_room = 16.0 * room_ * largest_ + 1e-290;
        const double begin = cross(a0, b0);
        const double middle = 0.5 * (cross(a0, b1) + cross(a1, b0));
        const double end = cross(a1, b1);
        return (begin > area_room && middle > area_room && end > area_room) ||
               (begin < -area_room && middle < -area_room && end < -area_room);
    }

    std::vector<MovingPoint> points_;
    std::vector<Box> boxes_;  // swept edges, each from a point to the next
    double largest_ = 0.0;
    double room_ = 0.0;  // far above what rounding does to a place
};

}  // namespace

bool meets_itself(const MovingScene& scene, std::span<const VertexId> loop, const Vec3& direction) {
    return Loop(scene, loop, direction).meets_itself();
}

}  // namespace earshot::collision
