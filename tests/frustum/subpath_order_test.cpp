// SPDX-License-Identifier: MIT
#include "earshot/frustum/internal/subpath_order.h"

#include "earshot/base/random.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <utility>
#include <vector>

namespace earshot::frustum {
namespace {

using Numbers = std::vector<std::uint32_t>;
using Points = std::vector<std::array<float, 3>>;

constexpr std::size_t kLeaf = 8;

/// A balanced k-d tree by sorting: parts of `size`, the last one shorter, are halved along their
/// widest axis, down to leaves.
void sort_into_leaves(const Points& points, Numbers& numbers, std::size_t begin, std::size_t size) {
    const std::size_t end = std::min(numbers.size(), begin + size);
    if (size <= kLeaf || begin >= end) {
        return;
    }
    const auto first = numbers.begin() + static_cast<std::ptrdiff_t>(begin);
    const auto last = numbers.begin() + static_cast<std::ptrdiff_t>(end);
    if (end - begin > size / 2) {
        std::size_t axis = 0;
        float widest = -1.0F;
        for (std::size_t k = 0; k < 3; ++k) {
            const auto [low, high] =
                std::minmax_element(first, last, [&](std::uint32_t a, std::uint32_t b) {
                    return points[a][k] < points[b][k];
                });
            const float width = points[*high][k] - points[*low][k];
            if (width > widest) {
                widest = width;
                axis = k;
            }
        }
        std::sort(first, last, [&](std::uint32_t a, std::uint32_t b) {
            return std::pair(points[a][axis], a) < std::pair(points[b][axis], b);
        });
    }
    sort_into_leaves(points, numbers, begin, size / 2);
    sort_into_leaves(points, numbers, begin + size / 2, size / 2);
}

/// The numbers in each leaf, sorted.
Numbers with_sorted_leaves(Numbers numbers) {
    for (std::size_t begin = 0; begin < numbers.size(); begin += kLeaf) {
        const std::size_t end = std::min(numbers.size(), begin + kLeaf);
        std::sort(numbers.begin() + static_cast<std::ptrdiff_t>(begin),
                  numbers.begin() + static_cast<std::ptrdiff_t>(end));
    }
    return numbers;
}

float coordinate(std::uint64_t seed, std::size_t i, std::size_t k) {
    const double at = random_between(seed, k, i, -20.0, 20.0);
    switch (seed % 4) {
        case 0:
            return static_cast<float>(at);
        case 1:
            return static_cast<float>(static_cast<int>(at / 4.0));  // many are equal
        case 2:
            return k == 1 ? static_cast<float>(at) * 1e-44F : 0.0F;  // almost none differ
        default:
            return i % 9 == 0 ? static_cast<float>(at) * 1e30F : -0.0F;  // far away, or together
    }
}

// Images and apertures are weighed, so either of them alone tells the order.
TEST(SubpathOrder, LeavesAreThoseOfABalancedTreeMadeBySorting) {
    for (const std::size_t count : {1U, 8U, 9U, 63U, 64U, 511U, 512U, 1023U, 1025U, 2100U, 9000U}) {
        for (std::uint64_t seed = 0; seed < 8; ++seed) {
            std::vector<SubpathBounds> subpaths(count);
            Points points(count);
            Numbers expected;
            for (std::size_t i = 0; i < count; ++i) {
                for (std::size_t k = 0; k < 3; ++k) {
                    points[i][k] = coordinate(seed, i, k);
                    for (auto* box : {&subpaths[i].aperture, &subpaths[i].image}) {
                        const bool is_moved = (box == &subpaths[i].image) == (seed < 4);
                        box->lower[k] = box->upper[k] = is_moved ? points[i][k] : 1.0F;
                    }
                    points[i][k] *= seed < 4 ? 2.0F : 0.8F;
                }
                expected.push_back(static_cast<std::uint32_t>(i));
            }
            sort_into_leaves(points, expected, 0, std::bit_ceil(count));
            for (const int threads : {1, 3}) {
                Executor executor(threads);
                EXPECT_EQ(with_sorted_leaves(order_subpaths(subpaths, executor)),
                          with_sorted_leaves(expected))
                    << count << " seed " << seed;
            }
        }
    }
}

}  // namespace
}  // namespace earshot::frustum
