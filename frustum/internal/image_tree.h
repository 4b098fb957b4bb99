// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/frustum/scene_view.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

namespace earshot::frustum {

/// An image of a point: the point mirrored in a sequence of facets.
struct ImageSource {
    std::uint32_t parent = 0;     ///< the image before the last mirror; of the point itself: itself
    geometry::FacetId facet = 0;  ///< the last mirror
    std::uint32_t order = 0;      ///< number of mirrors
    geometry::Vec3 position{0.0};
    double max_pressure_factor = 1.0;  ///< of the reflections
};

/// The images of one point, as a tree (Borish 1984), each once.
class ImageTree {
public:
    explicit ImageTree(const geometry::Vec3& point) : images_{{.position = point}} {}

    /// The image mirrored in one more facet, which is added if it is new.
    std::uint32_t child(std::uint32_t parent, geometry::FacetId facet, const SceneView& scene);

    /// Puts the images in order of their number of mirrors, then facet by facet, the point itself
    /// first. Returns the new index of each.
    std::vector<std::uint32_t> sort();

    std::size_t size() const noexcept { return images_.size(); }
    const ImageSource& operator[](std::uint32_t index) const noexcept { return images_[index]; }

    /// The mirrors of an image, the point's end first.
    std::vector<geometry::FacetId> sequence(std::uint32_t index) const;
    /// The point, and its image behind each mirror in turn.
    std::vector<geometry::Vec3> positions(std::uint32_t index) const;

private:
    std::vector<ImageSource> images_;
    std::unordered_map<std::uint64_t, std::uint32_t> index_of_;  // by parent and facet
};

}  // namespace earshot::frustum
