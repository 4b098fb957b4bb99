// SPDX-License-Identifier: MIT
#include "earshot/frustum/internal/edge_sides.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace earshot::frustum {

using geometry::FacetId;
using geometry::Interval;
using geometry::Vec3;
using geometry::Wedge;

namespace {

/// What is left of ascending parts without others.
std::vector<Interval> without(const std::vector<Interval>& parts,
                              const std::vector<Interval>& others) {
    std::vector<Interval> left;
    for (Interval part : parts) {
        for (const Interval& other : others) {
            if (other.max <= part.min || other.min >= part.max) {
                continue;
            }
            if (other.min > part.min) {
                left.push_back({part.min, other.min});
            }
            part.min = std::min(other.max, part.max);
        }
        if (part.min < part.max) {
            left.push_back(part);
        }
    }
    return left;
}

/// Images in layers of one surface lie within twice the tolerance for their distance, and as much
/// for the tilt that it gives the planes of walls a fraction of the scene wide, per reflection: as
/// for specular paths (path_order.cpp).
constexpr double kLayerDistance = 16.0;

EdgeEnd end_of(const Wedge& wedge, const ImageSource& image) {
    EdgeEnd end;
    end.image = geometry::wedge_coordinates(wedge, image.position);
    end.max_pressure_factor = image.max_pressure_factor;
    end.reflections = image.order;
    return end;
}

}  // namespace

EdgeSides::EdgeSides(const SceneView& scene,
                     const PathVerifier& verifier,
                     std::span<const Wedge> wedges,
                     ImageTree images,
                     std::span<const std::vector<Pair>> pairs,
                     Executor& executor)
    : scene_(scene),
      intervals_(scene, verifier),
      wedges_(wedges),
      images_(std::move(images)),
      first_(wedges.size() + 1, 0),
      parts_of_wedge_(wedges.size()),
      windows_of_wedge_(wedges.size()) {
    const std::vector<std::uint32_t> rank = images_.sort();
    // The images of each wedge, by counting.
    std::vector<std::size_t> begin(wedges.size() + 1, 0);
    for (const std::vector<Pair>& some : pairs) {
        for (const auto& [wedge, image] : some) {
            ++begin[wedge + 1];
        }
    }
    for (std::size_t i = 0; i < wedges.size(); ++i) {
        begin[i + 1] += begin[i];
    }
    std::vector<std::uint32_t> of_wedge(begin.back());
    std::vector<std::size_t> next(begin.begin(), begin.end() - 1);
    for (const std::vector<Pair>& some : pairs) {
        for (const auto& [wedge, image] : some) {
            of_wedge[next[wedge]++] = rank[image];
        }
    }
    // Each once, and only those that are seen from the air of the wedge.
    constexpr std::size_t kGrain = 64;
    std::vector<std::vector<EdgeCandidate>> of_chunk(chunk_count(wedges.size(), kGrain));
    executor.for_each(wedges.size(), kGrain, [&](std::size_t from, std::size_t to) {
        std::vector<EdgeCandidate>& found = of_chunk[from / kGrain];
        for (std::size_t w = from; w < to; ++w) {
            const auto first = of_wedge.begin() + static_cast<std::ptrdiff_t>(begin[w]);
            const auto last = of_wedge.begin() + static_cast<std::ptrdiff_t>(begin[w + 1]);
            std::sort(first, last);
            const std::size_t before = found.size();
            for (auto image = first; image != last; ++image) {
                if (image != first && image[0] == image[-1]) {
                    continue;
                }
                const ImageSource& source = images_[*image];
                const EdgeEnd end = end_of(wedges[w], source);
                const FacetId* mirror = source.order > 0 ? &source.facet : nullptr;
                if (intervals_.may_reach(mirror, source.position, end.image, wedges[w])) {
                    found.push_back({.end = end, .image = *image});
                }
            }
            first_[w + 1] = found.size() - before;
        }
    });
    for (std::size_t i = 0; i < wedges.size(); ++i) {
        first_[i + 1] += first_[i];
    }
    candidates_.reserve(first_.back());
    for (const std::vector<EdgeCandidate>& some : of_chunk) {
        candidates_.insert(candidates_.end(), some.begin(), some.end());
    }
}

std::size_t EdgeSides::bytes() const noexcept {
    constexpr std::size_t kPerImage = 64;  // of the index
    return candidates_.size() * sizeof(EdgeCandidate) +
           images_.size() * (sizeof(ImageSource) + kPerImage) +
           wedges_.size() * (sizeof(parts_of_wedge_[0]) + sizeof(windows_of_wedge_[0]));
}

std::span<const Interval> EdgeSides::parts(std::size_t wedge, std::size_t i) {
    decide(wedge, i);
    return parts_of_wedge_[wedge][candidates_[first_[wedge] + i].parts - 1];
}

Interval EdgeSides::window(std::size_t wedge, std::size_t i) {
    EdgeCandidate& candidate = candidates_[first_[wedge] + i];
    if (candidate.end.reflections == 0) {
        return {0.0, wedges_[wedge].length()};
    }
    std::vector<Interval>& windows = windows_of_wedge_[wedge];
    if (candidate.window == 0) {
        windows.push_back(intervals_.window(
            images_.sequence(candidate.image), images_.positions(candidate.image), wedges_[wedge]));
        candidate.window = static_cast<std::uint32_t>(windows.size());
    }
    return windows[candidate.window - 1];
}

void EdgeSides::decide(std::size_t wedge, std::size_t i) {
    EdgeCandidate& candidate = candidates_[first_[wedge] + i];
    if (candidate.parts != 0) {
        return;
    }
    const std::vector<FacetId> sequence = images_.sequence(candidate.image);
    const std::vector<Vec3> positions = images_.positions(candidate.image);
    const Interval within = window(wedge, i);
    std::vector<Interval> found;
    if (!within.is_empty()) {
        found = intervals_.find(sequence, positions, wedges_[wedge], within);
    }
    const double reach =
        kLayerDistance * scene_.facets.tolerance * static_cast<double>(sequence.size());
    for (std::size_t k = i; k-- > 0 && !found.empty();) {
        const EdgeCandidate& other = candidates_[first_[wedge] + k];
        if (other.end.reflections != candidate.end.reflections) {
            break;
        }
        if (glm::distance(images_[other.image].position, positions.back()) <= reach) {
            decide(wedge, k);
            found = without(found, parts_of_wedge_[wedge][other.parts - 1]);
        }
    }
    parts_of_wedge_[wedge].push_back(std::move(found));
    candidate.parts = static_cast<std::uint32_t>(parts_of_wedge_[wedge].size());
}

}  // namespace earshot::frustum
