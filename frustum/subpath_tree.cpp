// SPDX-License-Identifier: MIT
#include "earshot/frustum/internal/subpath_tree.h"

#include "earshot/base/parallel.h"
#include "earshot/geometry/facets.h"

#include <glm/common.hpp>

#include <algorithm>
#include <array>
#include <cmath>

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

/// Where a subpath lies for the hierarchy: images are about twice as far from an image source as
/// the apertures before them, so that their distances count half.
struct Place {
    std::array<float, 6> coordinate;
    std::uint32_t number;
};

Place place_of(const SubpathBounds& bounds, std::size_t number) {
    Place place;
    for (std::size_t k = 0; k < 3; ++k) {
        place.coordinate[k] = 0.5F * (bounds.aperture.lower[k] + bounds.aperture.upper[k]);
        place.coordinate[3 + k] = 0.25F * (bounds.image.lower[k] + bounds.image.upper[k]);
    }
    place.number = static_cast<std::uint32_t>(number);
    return place;
}

std::size_t longest_axis(std::span<const Place> places) {
    std::array<float, 6> lower = places.front().coordinate;
    std::array<float, 6> upper = lower;
    for (const Place& place : places) {
        for (std::size_t k = 0; k < lower.size(); ++k) {
            lower[k] = std::min(lower[k], place.coordinate[k]);
            upper[k] = std::max(upper[k], place.coordinate[k]);
        }
    }
    std::size_t longest = 0;
    for (std::size_t k = 1; k < lower.size(); ++k) {
        if (upper[k] - lower[k] > upper[longest] - lower[longest]) {
            longest = k;
        }
    }
    return longest;
}

/// Sorts subpaths so that every node of the complete tree over them has neighbours: at medians
/// along the longest extent, at whole children of the node.
void sort_by_medians(std::span<Place> places) {
    if (places.size() <= kWidth) {
        return;
    }
    std::size_t child = kWidth;
    while (child * kWidth < places.size()) {
        child *= kWidth;
    }
    const std::size_t left = child * ((chunk_count(places.size(), child) + 1) / 2);
    const std::size_t axis = longest_axis(places);
    std::nth_element(places.begin(),
                     places.begin() + static_cast<std::ptrdiff_t>(left),
                     places.end(),
                     [axis](const Place& a, const Place& b) {
                         return a.coordinate[axis] < b.coordinate[axis] ||
                                (a.coordinate[axis] == b.coordinate[axis] && a.number < b.number);
                     });
    sort_by_medians(places.first(left));
    sort_by_medians(places.subspan(left));
}

void set_box(SubpathBlock::Box& box, std::size_t lane, const Aabb& value) {
    for (std::size_t k = 0; k < 3; ++k) {
        box.lower[k][lane] = value.lower[k];
        box.upper[k][lane] = value.upper[k];
    }
}

double max_abs(const Aabb& box) {
    double largest = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
        largest = std::max({largest,
                            std::abs(static_cast<double>(box.lower[k])),
                            std::abs(static_cast<double>(box.upper[k]))});
    }
    return largest;
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
    std::vector<Place> places;
    places.reserve(subpaths.size());
    for (std::size_t i = 0; i < subpaths.size(); ++i) {
        places.push_back(place_of(subpaths[i], i));
        max_coordinate_ =
            std::max({max_coordinate_, max_abs(subpaths[i].aperture), max_abs(subpaths[i].image)});
    }
    sort_by_medians(places);
    std::vector<SubpathBounds> nodes;
    nodes.reserve(subpaths.size());
    numbers_.reserve(subpaths.size());
    for (const Place& place : places) {
        numbers_.push_back(place.number);
        nodes.push_back(subpaths[place.number]);
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
