// SPDX-License-Identifier: MIT
#include "earshot/frustum/internal/image_tree.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace earshot::frustum {

using geometry::FacetId;
using geometry::Vec3;

std::uint32_t ImageTree::child(std::uint32_t parent, FacetId facet, const SceneView& scene) {
    const std::uint64_t key = (static_cast<std::uint64_t>(parent) << 32) | facet;
    const auto [place, is_new] =
        index_of_.try_emplace(key, static_cast<std::uint32_t>(images_.size()));
    if (is_new) {
        const ImageSource before = images_[parent];
        const double factor =
            scene.max_pressure_factor.empty() ? 1.0 : scene.max_pressure_factor[facet];
        images_.push_back({.parent = parent,
                           .facet = facet,
                           .order = before.order + 1,
                           .position = scene.facets.facets[facet].plane.mirror(before.position),
                           .max_pressure_factor = before.max_pressure_factor * factor});
    }
    return place->second;
}

// Images with one number of mirrors are in order once their parents are: level by level.
std::vector<std::uint32_t> ImageTree::sort() {
    std::vector<std::uint32_t> order(images_.size());
    std::iota(order.begin(), order.end(), 0U);
    std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
        return images_[a].order < images_[b].order;
    });
    std::vector<std::uint32_t> rank(images_.size(), 0);
    for (auto begin = order.begin(); begin != order.end();) {
        const std::uint32_t level = images_[*begin].order;
        const auto end = std::find_if(
            begin, order.end(), [&](std::uint32_t i) { return images_[i].order != level; });
        std::sort(begin, end, [&](std::uint32_t a, std::uint32_t b) {
            return std::pair(rank[images_[a].parent], images_[a].facet) <
                   std::pair(rank[images_[b].parent], images_[b].facet);
        });
        for (; begin != end; ++begin) {
            rank[*begin] = static_cast<std::uint32_t>(begin - order.begin());
        }
    }
    std::vector<ImageSource> sorted(images_.size());
    for (std::size_t i = 0; i < images_.size(); ++i) {
        sorted[rank[i]] = images_[i];
        sorted[rank[i]].parent = rank[images_[i].parent];
    }
    images_ = std::move(sorted);
    index_of_.clear();
    for (std::uint32_t i = 1; i < images_.size(); ++i) {
        index_of_.emplace((static_cast<std::uint64_t>(images_[i].parent) << 32) | images_[i].facet,
                          i);
    }
    return rank;
}

std::vector<FacetId> ImageTree::sequence(std::uint32_t index) const {
    std::vector<FacetId> facets(images_[index].order);
    for (std::size_t i = facets.size(); i-- > 0; index = images_[index].parent) {
        facets[i] = images_[index].facet;
    }
    return facets;
}

std::vector<Vec3> ImageTree::positions(std::uint32_t index) const {
    std::vector<Vec3> found(images_[index].order + 1);
    for (std::size_t i = found.size(); i-- > 0; index = images_[index].parent) {
        found[i] = images_[index].position;
    }
    return found;
}

}  // namespace earshot::frustum
