// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/visibility/label_layout.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

namespace earshot::test {

/// Twice the signed area of a triangle.
inline double area_of(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// Whether two segments cross at a point that is inside of both, by more than rounding.
inline bool segments_cross(const glm::dvec2& a,
                           const glm::dvec2& b,
                           const glm::dvec2& c,
                           const glm::dvec2& d) {
    constexpr double kRounding = 1e-7;  // of areas of pictures of at most some 1000 pixels
    const auto parts = [](double first, double second) {
        return (first > kRounding && second < -kRounding) ||
               (first < -kRounding && second > kRounding);
    };
    return parts(area_of(a, b, c), area_of(a, b, d)) && parts(area_of(c, d, a), area_of(c, d, b));
}

/// A label box of unlimited width, as a segment's clip finds it.
inline bool line_enters_box(const glm::dvec2& from,
                            const glm::dvec2& to,
                            const visibility::Label& label,
                            double height) {
    constexpr double kRounding = 1e-7;
    const double top = label.box.y - height / 2.0 + kRounding;
    const double bottom = label.box.y + height / 2.0 - kRounding;
    constexpr int kSteps = 2000;
    for (int step = 0; step <= kSteps; ++step) {
        const glm::dvec2 at = from + (to - from) * (static_cast<double>(step) / kSteps);
        const double outward = label.is_left ? label.box.x - at.x : at.x - label.box.x;
        if (at.y > top && at.y < bottom && outward > kRounding) {
            return true;
        }
    }
    return false;
}

/// Leader lines do not cross, boxes do not overlap, and no line runs through another's box.
inline testing::AssertionResult labels_are_apart(const visibility::LabelLayout& layout,
                                                 double height) {
    for (std::size_t i = 0; i < layout.labels.size(); ++i) {
        for (std::size_t k = 0; k < layout.labels.size(); ++k) {
            if (i == k || !layout.labels[i] || !layout.labels[k]) {
                continue;
            }
            const visibility::Label& a = *layout.labels[i];
            const visibility::Label& b = *layout.labels[k];
            const std::array<std::array<glm::dvec2, 2>, 2> lines_of_a = {
                {{a.anchor, a.exit}, {a.exit, a.box}}};
            const std::array<std::array<glm::dvec2, 2>, 2> lines_of_b = {
                {{b.anchor, b.exit}, {b.exit, b.box}}};
            for (const auto& [from, to] : lines_of_a) {
                for (const auto& [c, d] : lines_of_b) {
                    if (segments_cross(from, to, c, d)) {
                        return testing::AssertionFailure()
                               << "lines " << i << ", " << k << " cross";
                    }
                }
                if (line_enters_box(from, to, b, height)) {
                    return testing::AssertionFailure() << "line " << i << " is in box " << k;
                }
            }
            if (a.is_left == b.is_left && std::abs(a.box.y - b.box.y) < height - 1e-9) {
                return testing::AssertionFailure() << "boxes " << i << ", " << k << " overlap";
            }
        }
    }
    return testing::AssertionSuccess();
}

/// No box holds part of the drawing, and the ends of the leader lines lie outside of it.
inline testing::AssertionResult boxes_clear_drawing(const visibility::LabelLayout& layout,
                                                    const visibility::IdImage& image,
                                                    const visibility::LabelOptions& options) {
    for (std::size_t pixel = 0; pixel < image.objects.size(); ++pixel) {
        if (image.objects[pixel] == visibility::kBackground) {
            continue;
        }
        const auto column = static_cast<double>(pixel % image.width);
        const auto row = static_cast<double>(pixel / image.width);
        for (std::size_t i = 0; i < layout.labels.size(); ++i) {
            if (!layout.labels[i]) {
                continue;
            }
            const visibility::Label& label = *layout.labels[i];
            const double near = label.box.y - options.box_height / 2.0 - options.margin + 1e-9;
            const double far = label.box.y + options.box_height / 2.0 + options.margin - 1e-9;
            const bool is_level = row + 1.0 > near && row < far;
            const double gap = label.is_left ? column - label.box.x : label.box.x - (column + 1.0);
            if (is_level && gap < options.margin - 1e-9) {
                return testing::AssertionFailure()
                       << "box " << i << " is " << gap << " from pixel " << column << ", " << row;
            }
        }
    }
    return testing::AssertionSuccess();
}

/// The mean of the middles of an object's pixels. Precondition: it has some.
inline glm::dvec2 middle_of(const visibility::IdImage& image, std::uint32_t object) {
    glm::dvec2 sum(0.0);
    double count = 0.0;
    for (std::size_t pixel = 0; pixel < image.objects.size(); ++pixel) {
        if (image.objects[pixel] == object) {
            sum += glm::dvec2(static_cast<double>(pixel % image.width) + 0.5,
                              static_cast<double>(pixel / image.width) + 0.5);
            count += 1.0;
        }
    }
    return sum / count;
}

}  // namespace earshot::test
