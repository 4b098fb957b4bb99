// SPDX-License-Identifier: MIT
#include "earshot/io/internal/picture_projection.h"

#include "earshot/base/math.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace earshot::io {

using geometry::Vec3;

namespace {

constexpr double kTurn = 0.62;  // of the isometric view about the vertical, radians
constexpr double kTilt = 0.60;  // below the horizon, radians
// Lines of view start this fraction of the extent before a surface, which is far more than the
// rounding of points on it and less than what a drawing resolves (1 / kSize).
constexpr double kOffset = 1e-4;

}  // namespace

PictureProjection::PictureProjection(Projection projection)
    : is_plan_(projection == Projection::plan) {
    if (is_plan_) {
        right_ = {1.0, 0.0, 0.0};
        up_ = {0.0, 0.0, -1.0};
        towards_ = {0.0, 1.0, 0.0};
    } else {
        right_ = {math::cos(kTurn), 0.0, -math::sin(kTurn)};
        towards_ = {math::sin(kTurn) * math::cos(kTilt),
                    math::sin(kTilt),
                    math::cos(kTurn) * math::cos(kTilt)};
        up_ = glm::cross(towards_, right_);
    }
}

Vec3 PictureProjection::in_view(const Vec3& point) const noexcept {
    return {glm::dot(point, right_), glm::dot(point, up_), glm::dot(point, towards_)};
}

void PictureProjection::include(std::span<const Vec3> points) {
    for (const Vec3& point : points) {
        low_ = glm::min(low_, in_view(point));
        high_ = glm::max(high_, in_view(point));
    }
}

double PictureProjection::extent() const noexcept {
    return std::max({high_.x - low_.x, high_.y - low_.y, high_.z - low_.z});
}

double PictureProjection::scale() const noexcept {
    const double longer = std::max(high_.x - low_.x, high_.y - low_.y);
    return longer > 0.0 ? kSize / longer : 1.0;
}

glm::dvec2 PictureProjection::project(const Vec3& point) const noexcept {
    const Vec3 at = in_view(point);
    return {(at.x - low_.x) * scale(), (high_.y - at.y) * scale()};
}

geometry::Segment PictureProjection::line_of_view(const Vec3& point) const noexcept {
    const double offset = kOffset * extent();
    const double length = is_plan_ ? cut_ - point.y : 2.0 * extent();
    return {.from = point + towards_ * offset,
            .to = point + towards_ * std::max(length, 2.0 * offset)};
}

visibility::View PictureProjection::view() const noexcept {
    const auto pixels = [](double units) {
        return static_cast<std::size_t>(std::max(1.0, std::ceil(units / kUnitsPerPixel)));
    };
    visibility::View view{
        .width = pixels(width()), .height = pixels(height()), .forward = -towards_};
    view.parallel_width = static_cast<double>(view.width) * kUnitsPerPixel / scale();
    return view;
}

Vec3 PictureProjection::viewpoint() const noexcept {
    // The upper left corners of the item buffer and of the drawing coincide.
    const visibility::View image = view();
    const double half = kUnitsPerPixel / 2.0 / scale();
    const double x = low_.x + static_cast<double>(image.width) * half;
    const double y = high_.y - static_cast<double>(image.height) * half;
    const double depth = is_plan_ ? cut_ : high_.z + extent();
    return x * right_ + y * up_ + depth * towards_;
}

}  // namespace earshot::io
