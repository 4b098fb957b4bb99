// SPDX-License-Identifier: MIT
#include "earshot/visibility/internal/label_interior.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>

namespace earshot::visibility {

using glm::dvec2;

namespace {

bool is_convex(const dvec2& a, const dvec2& b, const dvec2& c) noexcept {
    return (b.x - a.x) * (c.y - a.y) < (c.x - a.x) * (b.y - a.y);
}

}  // namespace

InteriorSide::InteriorSide(std::vector<dvec2> points, bool is_left) : sign_(is_left ? 1.0 : -1.0) {
    for (dvec2& point : points) {
        point.x *= sign_;
    }
    std::sort(points.begin(), points.end(), [](const dvec2& a, const dvec2& b) {
        return a.y != b.y ? a.y < b.y : a.x < b.x;
    });
    // Andrew 1979: the lower hull, along y.
    for (const dvec2& point : points) {
        if (!hull_.empty() && hull_.back().y == point.y) {
            continue;
        }
        while (hull_.size() > 1 && !is_convex(hull_[hull_.size() - 2], hull_.back(), point)) {
            hull_.pop_back();
        }
        hull_.push_back(point);
    }
}

double InteriorSide::clear_x(double first, double last) const noexcept {
    double result = std::min(value(first), value(last));
    for (const dvec2& point : hull_) {
        if (point.y > first && point.y < last) {
            result = std::min(result, point.x);
        }
    }
    return sign_ * result;
}

double InteriorSide::value(double y) const noexcept {
    const auto next = std::upper_bound(
        hull_.begin(), hull_.end(), y, [](double at, const dvec2& point) { return at < point.y; });
    if (next == hull_.begin() || next == hull_.end()) {
        return next == hull_.begin() ? hull_.front().x : hull_.back().x;
    }
    const dvec2& a = *(next - 1);
    return a.x + (next->x - a.x) * ((y - a.y) / (next->y - a.y));
}

LabelInterior::LabelInterior(std::vector<dvec2> points)
    : points_(std::move(points)), left_(points_, true), right_(points_, false) {}

double LabelInterior::diagonal() const noexcept {
    dvec2 low = points_.front(), high = points_.front();
    for (const dvec2& point : points_) {
        low = glm::min(low, point);
        high = glm::max(high, point);
    }
    return glm::distance(low, high);
}

void LabelInterior::include_rows(double first, double last) {
    const double top = left_.top(), bottom = left_.bottom();
    if (first < top) {
        points_.emplace_back((left_.x(top) + right_.x(top)) / 2.0, first);
    }
    if (last > bottom) {
        points_.emplace_back((left_.x(bottom) + right_.x(bottom)) / 2.0, last);
    }
    left_ = InteriorSide(points_, true);
    right_ = InteriorSide(points_, false);
}

std::vector<dvec2> interior_points(const IdImage& image,
                                   std::span<const LabelledObject> objects,
                                   double margin) {
    std::vector<dvec2> points;
    const auto add = [&](double left, double top, double right, double bottom) {
        points.insert(points.end(),
                      {{left - margin, top - margin},
                       {left - margin, bottom + margin},
                       {right + margin, top - margin},
                       {right + margin, bottom + margin}});
    };
    for (std::size_t row = 0; row < image.height; ++row) {
        const auto begin = image.objects.begin() + static_cast<std::ptrdiff_t>(row * image.width);
        const auto end = begin + static_cast<std::ptrdiff_t>(image.width);
        const auto is_drawing = [](std::uint32_t object) { return object != kBackground; };
        const auto first = std::find_if(begin, end, is_drawing);
        if (first != end) {
            auto last = end - 1;
            while (!is_drawing(*last)) {
                --last;
            }
            const auto top = static_cast<double>(row);
            add(static_cast<double>(first - begin),
                top,
                static_cast<double>(last - begin) + 1.0,
                top + 1.0);
        }
    }
    for (const LabelledObject& object : objects) {
        if (object.anchor) {
            add(object.anchor->x, object.anchor->y, object.anchor->x, object.anchor->y);
        }
    }
    return points;
}

}  // namespace earshot::visibility
