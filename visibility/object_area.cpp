// SPDX-License-Identifier: MIT
#include "earshot/visibility/internal/object_area.h"

#include "earshot/base/assert.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace earshot::visibility {
namespace {

/// Squared distances from each place of a row to the nearest zero of a sampled function plus its
/// value, Felzenszwalb and Huttenlocher 2012: the lower envelope of parabolas. Whole numbers.
class RowTransform {
public:
    void run(std::vector<double>& values) {
        const std::size_t n = values.size();
        vertices_.assign(n, 0);
        bounds_.assign(n + 1, 0.0);
        std::size_t last = 0;
        bounds_[0] = -std::numeric_limits<double>::infinity();
        bounds_[1] = std::numeric_limits<double>::infinity();
        const auto crossing = [&](std::size_t q, std::size_t p) {
            const auto x = static_cast<double>(q), y = static_cast<double>(p);
            return ((values[q] + x * x) - (values[p] + y * y)) / (2.0 * (x - y));
        };
        for (std::size_t q = 1; q < n; ++q) {
            while (crossing(q, vertices_[last]) <= bounds_[last]) {
                --last;
            }
            bounds_[last + 1] = crossing(q, vertices_[last]);
            vertices_[++last] = q;
            bounds_[last + 1] = std::numeric_limits<double>::infinity();
        }
        result_.resize(n);
        std::size_t k = 0;
        for (std::size_t q = 0; q < n; ++q) {
            while (bounds_[k + 1] < static_cast<double>(q)) {
                ++k;
            }
            const double offset = static_cast<double>(q) - static_cast<double>(vertices_[k]);
            result_[q] = offset * offset + values[vertices_[k]];
        }
        values = result_;
    }

private:
    std::vector<std::size_t> vertices_;
    std::vector<double> bounds_, result_;
};

}  // namespace

ObjectArea::ObjectArea(const IdImage& image,
                       std::uint32_t object,
                       std::span<const std::size_t> pixels)
    : image_width_(image.width), left_(image.width), top_(pixels.front() / image.width) {
    std::size_t right = 0;
    for (const std::size_t pixel : pixels) {
        left_ = std::min(left_, pixel % image.width);
        right = std::max(right, pixel % image.width);
    }
    columns_ = right - left_ + 3;
    rows_ = pixels.back() / image.width - top_ + 3;
    // Larger than any squared distance, and small enough for exact sums.
    const double far = 4.0 * static_cast<double>(columns_ * columns_ + rows_ * rows_);
    squared_.assign(columns_ * rows_, 0.0);
    for (const std::size_t pixel : pixels) {
        EARSHOT_ASSERT(image.objects[pixel] == object);
        squared_[index(pixel)] = far;
    }
    transform();
}

double ObjectArea::distance_outside(std::size_t pixel) const noexcept {
    return std::sqrt(squared_[index(pixel)]);
}

std::size_t ObjectArea::index(std::size_t pixel) const noexcept {
    return (pixel / image_width_ - top_ + 1) * columns_ + (pixel % image_width_ - left_ + 1);
}

void ObjectArea::transform() {
    RowTransform row_transform;
    std::vector<double> line(rows_);
    for (std::size_t column = 0; column < columns_; ++column) {
        for (std::size_t row = 0; row < rows_; ++row) {
            line[row] = squared_[row * columns_ + column];
        }
        row_transform.run(line);
        for (std::size_t row = 0; row < rows_; ++row) {
            squared_[row * columns_ + column] = line[row];
        }
    }
    for (std::size_t row = 0; row < rows_; ++row) {
        const auto begin = squared_.begin() + static_cast<std::ptrdiff_t>(row * columns_);
        line.assign(begin, begin + static_cast<std::ptrdiff_t>(columns_));
        row_transform.run(line);
        std::copy(line.begin(), line.end(), begin);
    }
}

}  // namespace earshot::visibility
