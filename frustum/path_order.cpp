// SPDX-License-Identifier: MIT
#include "earshot/frustum/internal/path_order.h"

#include "earshot/frustum/internal/coincident_layers.h"
#include "earshot/frustum/internal/facet_index.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <tuple>

namespace earshot::frustum {

using geometry::Vec3;

namespace {

// By listener, length, order, triangles.
bool comes_first(const SpecularPath& a, const SpecularPath& b) {
    const auto key = [](const SpecularPath& path) {
        return std::tuple(path.listener, path.length, path.triangles.size());
    };
    return key(a) != key(b) ? key(a) < key(b) : a.triangles < b.triangles;
}

/// Coincident layers are told apart by rounding only: their images of a source lie
/// within twice the tolerance for their distance and as much for the tilt that it gives the planes
/// of walls a fraction of the scene wide, per reflection.
constexpr double kLayerDistance = 16.0;

/// Which paths are the same polyline in space as a given one.
class DuplicateTest {
public:
    DuplicateTest(const SpecularPath& path, const geometry::Facets& facets, double extent)
        : path_(path),
          facets_(facets),
          // Reflection points of one path found twice differ by the verifier's slack at a corner.
          slack_(64.0 * kRounding * (extent + path.length)),
          layer_distance_(kLayerDistance * facets.tolerance *
                          static_cast<double>(path.triangles.size())) {}

    double max_length_difference() const noexcept { return std::max(slack_, layer_distance_); }

    /// A reflection in the edge of two facets, or in a corner.
    bool same_points(const SpecularPath& other) const {
        return std::equal(
            path_.points.begin(),
            path_.points.end(),
            other.points.begin(),
            other.points.end(),
            [&](const Vec3& a, const Vec3& b) { return glm::distance(a, b) <= slack_; });
    }

    /// Each reflection on the same facet or on a layer coincident with it (a carpet, a poster), in
    /// the same order but for facets that meet in an edge or a corner: where the path turns in it,
    /// the layers lie before and behind one another. Images that agree make the paths the same line
    /// when they are unfolded, which crosses facets in another order only where these meet.
    bool same_layers(const SpecularPath& other) const {
        const std::size_t order = path_.triangles.size();
        if (other.triangles.size() != order || order == 0 ||
            glm::distance(image_of(path_), image_of(other)) > layer_distance_) {
            return false;
        }
        constexpr std::size_t kMaxShift = 2;  // three facets meet in a corner
        std::vector<bool> is_taken(order, false);
        for (std::size_t i = 0; i < order; ++i) {
            std::size_t match = i;
            if (is_taken[i] || !same_layer(i, other, i)) {
                match = i < kMaxShift ? 0 : i - kMaxShift;
                const std::size_t end = std::min(order, i + kMaxShift + 1);
                while (match < end && (is_taken[match] || !same_layer(i, other, match))) {
                    ++match;
                }
                if (match == end) {
                    return false;
                }
            }
            is_taken[match] = true;
        }
        return true;
    }

private:
    bool same_layer(std::size_t i, const SpecularPath& other, std::size_t j) const {
        const geometry::Facet& a = facet_of(path_.triangles[i]);
        const geometry::Facet& b = facet_of(other.triangles[j]);
        return &a == &b ||
               are_coincident_at(facets_, a, path_.points[i + 1], b, other.points[j + 1]);
    }

    const geometry::Facet& facet_of(geometry::TriangleId triangle) const {
        return facets_.facets[facets_.of_triangle[triangle]];
    }

    /// The image source: back along the last leg that has a length.
    static Vec3 image_of(const SpecularPath& path) {
        const Vec3& listener = path.points.back();
        Vec3 direction(0.0);
        for (std::size_t i = path.points.size() - 1; i > 0 && direction == Vec3(0.0); --i) {
            direction = path.points[i - 1] - path.points[i];
        }
        const double size = glm::length(direction);
        return size > 0.0 ? listener + (path.length / size) * direction : listener;
    }

    const SpecularPath& path_;
    const geometry::Facets& facets_;
    double slack_;
    double layer_distance_;
};

}  // namespace

void sort_and_deduplicate(std::vector<SpecularPath>& paths,
                          const geometry::Facets& facets,
                          double extent) {
    std::sort(paths.begin(), paths.end(), comes_first);
    std::vector<bool> repeated(paths.size(), false);
    for (std::size_t i = 0; i < paths.size(); ++i) {
        const DuplicateTest duplicate(paths[i], facets, extent);
        for (std::size_t j = i + 1; j < paths.size() && !repeated[i]; ++j) {
            if (paths[j].listener != paths[i].listener ||
                paths[j].length - paths[i].length > duplicate.max_length_difference()) {
                break;
            }
            if (!repeated[j] &&
                (duplicate.same_points(paths[j]) || duplicate.same_layers(paths[j]))) {
                repeated[paths[j].triangles < paths[i].triangles ? i : j] = true;
            }
        }
    }
    std::size_t kept = 0;
    for (std::size_t i = 0; i < paths.size(); ++i) {
        if (!repeated[i]) {
            if (kept != i) {
                paths[kept] = std::move(paths[i]);
            }
            ++kept;
        }
    }
    paths.resize(kept);
}

}  // namespace earshot::frustum
