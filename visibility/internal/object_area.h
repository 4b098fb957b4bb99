// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/visibility/label_layout.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace earshot::visibility {

/// The part of an image that holds an object, with a frame of pixels that do not belong to it.
class ObjectArea {
public:
    /// `pixels`: all pixels of the object, ascending. Precondition: there is one.
    ObjectArea(const IdImage& image, std::uint32_t object, std::span<const std::size_t> pixels);

    /// From the middle of a pixel of the object to that of the nearest one outside.
    double distance_outside(std::size_t pixel) const noexcept;

private:
    std::size_t index(std::size_t pixel) const noexcept;
    void transform();

    std::size_t image_width_, left_, top_, columns_ = 0, rows_ = 0;
    std::vector<double> squared_;
};

}  // namespace earshot::visibility
