// SPDX-License-Identifier: MIT
#include "earshot/frustum/internal/subpath_tree.h"

#include "earshot/base/parallel.h"
#include "earshot/geometry/facets.h"

#include <glm/common.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace earshot::frustum {

using geometry::Aabb;
using geometry::Vec3;

namespace {

constexpr std::size_t kWidth = SubpathBlock::kWidth;

/// Relative to the coordinates: a bound of the rounding of a box in the axes of a frustum, with a
/// margin of four (docs/algorithms/frustum.md).
constexpr double kBoxRounding = 0x1p-17;

/// In (u, v): a bound of the rounding of quotients near the aperture.
constexpr double kQuotientRounding = 0x1p-20;

/// The centres of a subpath's bounds.
using Place = std::array<float, 6>;

Place place_of(const SubpathBounds& bounds) noexcept {
    Place place;
    for (std::size_t k = 0; k < 3; ++k) {
        place[k] = 0.5F * (bounds.aperture.lower[k] + bounds.aperture.upper[k]);
        place[3 + k] = 0.5F * (bounds.image.lower[k] + bounds.image.upper[k]);
    }
    return place;
}

/// Positions along a Morton curve through the places of subpaths, of ten bits per coordinate.
class MortonCurve {
public:
    explicit MortonCurve(std::span<const SubpathBounds> subpaths) {
        lower_ = place_of(subpaths.front());
        Place upper = lower_;
        for (const SubpathBounds& bounds : subpaths) {
            const Place place = place_of(bounds);
            for (std::size_t k = 0; k < place.size(); ++k) {
                lower_[k] = std::min(lower_[k], place[k]);
                upper[k] = std::max(upper[k], place[k]);
            }
        }
        float size = 0.0F;
        for (std::size_t k = 0; k < upper.size(); ++k) {
            size = std::max(size, upper[k] - lower_[k]);
        }
        scale_ = size > 0.0F ? static_cast<float>(kSteps - 1) / size : 0.0F;
        for (std::size_t step = 0; step < kSteps; ++step) {
            for (unsigned bit = 0; bit < kBits; ++bit) {
                spread_[step] |= ((std::uint64_t{step} >> bit) & 1U) << (lower_.size() * bit);
            }
        }
    }

    std::uint64_t position(const SubpathBounds& bounds) const noexcept {
        const Place place = place_of(bounds);
        std::uint64_t code = 0;
        for (std::size_t k = 0; k < place.size(); ++k) {
            const auto step = static_cast<std::size_t>(scale_ * (place[k] - lower_[k]));
            code |= spread_[std::min(step, kSteps - 1)] << k;
        }
        return code;
    }

private:
    static constexpr unsigned kBits = 10;
    static constexpr std::size_t kSteps = std::size_t{1} << kBits;

    Place lower_{};
    float scale_ = 0.0F;
    std::array<std::uint64_t, kSteps> spread_{};  // bits of a step, six places apart
};

/// The numbers of the subpaths along the curve, so that neighbours are close.
std::vector<std::uint32_t> sorted_along_curve(std::span<const SubpathBounds> subpaths) {
    const MortonCurve curve(subpaths);
    std::vector<std::pair<std::uint64_t, std::uint32_t>> positions;
    positions.reserve(subpaths.size());
    for (const SubpathBounds& bounds : subpaths) {
        positions.emplace_back(curve.position(bounds),
                               static_cast<std::uint32_t>(positions.size()));
    }
    std::sort(positions.begin(), positions.end());
    std::vector<std::uint32_t> numbers;
    numbers.reserve(positions.size());
    for (const auto& position : positions) {
        numbers.push_back(position.second);
    }
    return numbers;
}

void set_box(SubpathBlock::Box& box, std::size_t lane, const Aabb& value) {
    for (std::size_t k = 0; k < 3; ++k) {
        box.lower[k][lane] = value.lower[k];
        box.upper[k][lane] = value.upper[k];
    }
}

}  // namespace

ConnectingLegs::ConnectingLegs(const Frustum& reflected,
                               const geometry::Plane& plane,
                               double position_error,
                               double max_coordinate,
                               double longest) noexcept {
    const Vec3* rows[] = {&reflected.right, &reflected.up, &reflected.forward};
    double farthest = 0.0;
    for (int k = 0; k < 3; ++k) {
        farthest = std::max(farthest, std::abs(reflected.apex[k]));
        apex[k] = static_cast<float>(reflected.apex[k]);
        normal[k] = static_cast<float>(reflected.side * plane.normal[k]);
        for (int axis = 0; axis < 3; ++axis) {
            axes[axis][k] = static_cast<float>((*rows[axis])[k]);
        }
    }
    for (int k = 0; k < 2; ++k) {
        lower[k] = geometry::round_down(reflected.rect.lower[k] - kQuotientRounding);
        upper[k] = geometry::round_up(reflected.rect.upper[k] + kQuotientRounding);
    }
    offset = static_cast<float>(reflected.side * plane.offset);
    margin = geometry::round_up(kBoxRounding * (max_coordinate + farthest) + position_error);
    min_depth = geometry::round_down(reflected.min_depth);
    max_length = geometry::round_up(longest);
}

SubpathTree::SubpathTree(std::span<const SubpathBounds> subpaths) {
    if (subpaths.empty()) {
        return;
    }
    for (const SubpathBounds& bounds : subpaths) {
        max_coordinate_ = std::max({max_coordinate_,
                                    bounds.aperture.max_abs_coordinate(),
                                    bounds.image.max_abs_coordinate()});
    }
    numbers_ = sorted_along_curve(subpaths);
    std::vector<SubpathBounds> nodes;
    nodes.reserve(subpaths.size());
    for (const std::uint32_t number : numbers_) {
        nodes.push_back(subpaths[number]);
    }
    while (!nodes.empty()) {
        nodes = add_level(nodes);
    }
}

// Returns the nodes of the level above; none above a level of one block.
std::vector<SubpathBounds> SubpathTree::add_level(std::span<const SubpathBounds> nodes) {
    levels_.push_back({blocks_.size(), nodes.size()});
    std::vector<SubpathBounds> above(chunk_count(nodes.size(), kWidth));
    blocks_.resize(blocks_.size() + above.size(), SubpathBlock{});
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        SubpathBlock& block = blocks_[levels_.back().first_block + i / kWidth];
        set_box(block.aperture, i % kWidth, nodes[i].aperture);
        set_box(block.image, i % kWidth, nodes[i].image);
        above[i / kWidth].aperture.include(nodes[i].aperture);
        above[i / kWidth].image.include(nodes[i].image);
    }
    if (above.size() == 1) {
        above.clear();
    }
    return above;
}

}  // namespace earshot::frustum
