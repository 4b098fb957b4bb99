// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/random.h"

#include "triangle_oracle.h"
#include <cmath>
#include <cstdint>
#include <utility>

namespace earshot::test {

/// A pair of triangles with whole coordinates below 2^21.
struct WholePair {
    WholeCorners one{}, other{};

    /// The same pair times 2^exponent.
    std::pair<collision::Corners, collision::Corners> scaled(int exponent) const {
        const auto convert = [&](const WholeCorners& corners) {
            collision::Corners result;
            for (std::size_t i = 0; i < 3; ++i) {
                for (std::size_t k = 0; k < 3; ++k) {
                    result[i][static_cast<int>(k)] =
                        std::ldexp(static_cast<double>(corners[i][k]), exponent);
                }
            }
            return result;
        };
        return {convert(one), convert(other)};
    }
};

/// Random pairs in which contact is as likely as not, and pairs that lie in one plane, share
/// corners, have no area, touch in a corner or an edge, or miss that by one unit of 2^20.
inline WholePair hard_pair(std::uint64_t seed, std::uint64_t i) {
    std::uint64_t throws = 0;
    const auto below = [&](std::uint64_t n) {
        return static_cast<Whole>(random_bits(seed, i, throws++) % n);
    };
    const std::uint64_t size = i % 3 == 0 ? 4 : i % 3 == 1 ? 100 : 1U << 20U;
    WholePair pair;
    for (WholeCorners* corners : {&pair.one, &pair.other}) {
        for (WholeVec& corner : *corners) {
            corner = {below(size), below(size), below(size)};
        }
    }
    const auto middle = [](const WholeVec& a, const WholeVec& b) {
        return WholeVec{(a[0] + b[0]) / 2, (a[1] + b[1]) / 2, (a[2] + b[2]) / 2};
    };
    auto& [a, b] = pair;
    switch (i / 3 % 10) {
        case 0:  // one plane
            for (WholeCorners* corners : {&a, &b}) {
                for (WholeVec& corner : *corners) {
                    corner[2] = corner[0] + corner[1];
                }
            }
            break;
        case 1:
            b[below(3) != 0 ? 1 : 2] = a[static_cast<std::size_t>(below(3))];
            break;
        case 2:
            b[0] = a[1];
            b[1] = a[0];
            break;
        case 3:  // a segment
            b[2] = middle(b[0], b[1]);
            break;
        case 4:  // a point
            b[0] = below(2) != 0 ? middle(a[0], middle(a[1], a[2])) : middle(a[0], a[1]);
            b[1] = b[2] = b[0];
            break;
        case 5:  // a corner on an edge, near enough
            b[0] = middle(a[0], a[1]);
            break;
        case 6:  // a corner in the face, near enough
            b[0] = middle(a[0], middle(a[1], a[2]));
            break;
        case 7:  // two segments
            a[1] = a[0];
            b[2] = b[0];
            break;
        default:
            break;
    }
    return pair;
}

}  // namespace earshot::test
