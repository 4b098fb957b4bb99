// SPDX-License-Identifier: MIT
#include "earshot/visibility/internal/volume_behind_plane.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <utility>

namespace earshot::visibility {

using geometry::Vec3;

namespace {

/// The mean over a triangle of the depth of its points below a level, 0 for points above: the
/// integral over lower levels of the fraction of the triangle that is below.
double mean_depth(const std::array<double, 3>& heights, double level) noexcept {
    const auto& [low, middle, high] = heights;
    if (level <= low) {
        return 0.0;
    }
    const double mean = level - (low + middle + high) / 3.0;
    if (level >= high) {
        return mean;
    }
    if (level <= middle) {
        const double up = level - low;
        return up * up * up / (3.0 * (middle - low) * (high - low));
    }
    const double down = high - level;
    return mean + down * down * down / (3.0 * (high - middle) * (high - low));
}

}  // namespace

VolumeBehindPlane::VolumeBehindPlane(const CellLeaf& leaf,
                                     std::span<const Viewer> viewers,
                                     const Vec3& normal)
    : leaf_(leaf), has_viewers_(!viewers.empty()) {
    std::vector<double> heights;
    for (const Vec3& corner : leaf.shape.corners()) {
        heights.push_back(glm::dot(normal, corner));
    }
    lowest_ = *std::min_element(heights.begin(), heights.end());
    highest_ = *std::max_element(heights.begin(), heights.end());
    const auto corners = leaf.shape.corners();
    for (const CellFace& face : leaf.shape.faces()) {
        const auto& ring = face.corners;
        for (std::size_t i = 2; i < ring.size(); ++i) {
            const Vec3 twice_area = glm::cross(corners[ring[i - 1]] - corners[ring[0]],
                                               corners[ring[i]] - corners[ring[0]]);
            Patch patch = {{heights[ring[0]] - lowest_,
                            heights[ring[i - 1]] - lowest_,
                            heights[ring[i]] - lowest_},
                           0.5 * glm::dot(normal, twice_area)};
            std::sort(patch.heights.begin(), patch.heights.end());
            if (patch.area != 0.0) {
                patches_.push_back(patch);
            }
        }
    }
    if (has_viewers_) {
        std::vector<std::pair<double, std::uint32_t>> places;
        for (const std::uint32_t viewer : leaf.viewers) {
            places.emplace_back(glm::dot(normal, viewers[viewer].position), viewer);
        }
        std::sort(places.begin(), places.end());
        viewer_sums_.push_back(0.0);
        for (const auto& [height, viewer] : places) {
            viewer_heights_.push_back(height);
            viewer_sums_.push_back(viewer_sums_.back() + viewers[viewer].fraction);
        }
    }
}

double VolumeBehindPlane::volume(double offset) const noexcept {
    if (offset <= lowest_) {
        return 0.0;
    }
    if (offset >= highest_) {
        return leaf_.volume;
    }
    // Gauss's theorem with the field (depth below the plane) * normal, whose divergence is -1
    // behind the plane and which vanishes on it.
    const double level = offset - lowest_;
    double sum = 0.0;
    for (const Patch& patch : patches_) {
        sum -= patch.area * mean_depth(patch.heights, level);
    }
    return std::clamp(sum, 0.0, leaf_.volume);
}

double VolumeBehindPlane::viewer_fraction(double offset, double volume_behind) const noexcept {
    if (!has_viewers_) {
        return leaf_.volume > 0.0 ? leaf_.viewer_fraction * (volume_behind / leaf_.volume) : 0.0;
    }
    const auto place = std::lower_bound(viewer_heights_.begin(), viewer_heights_.end(), offset);
    return viewer_sums_[static_cast<std::size_t>(place - viewer_heights_.begin())];
}

}  // namespace earshot::visibility
