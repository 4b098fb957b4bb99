// SPDX-License-Identifier: MIT
#include "earshot/visibility/internal/split_plane_search.h"

#include "earshot/base/random.h"
#include "earshot/visibility/internal/volume_behind_plane.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

namespace earshot::visibility {

using geometry::Vec3;

namespace {

/// A split that leaves a smaller part of a leaf's volume on one side is refused: of a sliver of
/// 1e-9 the rounding of the volume is 1e-6.
constexpr double kMinVolumeFraction = 1e-9;

/// With fewer pieces, threads take longer to start than to work.
constexpr std::size_t kMinPiecesForThreads = 20000;

constexpr std::size_t kPlaneGroups = 4;
constexpr std::size_t kTasksPerLeaf = 3 + kPlaneGroups;

/// Unit normals that differ by less are parallel.
constexpr double kParallel = 1e-9;

void keep_best(std::optional<SplitCandidate>& best, const SplitCandidate& proposal) {
    if (!best || proposal.saving > best->saving) {
        best = proposal;
    }
}

/// The extent of an object's samples along an axis: the object is visible behind planes of offset
/// >= first and before planes of offset <= last.
struct ObjectExtent {
    double first = std::numeric_limits<double>::infinity();
    double last = -std::numeric_limits<double>::infinity();
    double low = 0.0, high = 0.0;  // the ends that set first and last
};

/// The search in one leaf.
class LeafSearch {
public:
    LeafSearch(const CellBuildContext& build, const CellOptions& options, const CellLeaf& leaf)
        : build_(build),
          leaf_(leaf),
          index_in_set_(std::make_unique_for_overwrite<std::uint32_t[]>(build.costs.size())) {
        for (std::size_t i = 0; i < leaf.set.size(); ++i) {
            index_in_set_[leaf.set[i]] = static_cast<std::uint32_t>(i);
        }
        choose_triangle_planes(options);
    }

    std::optional<SplitCandidate> run(std::size_t task) const {
        return task < 3 ? best_along(static_cast<int>(task)) : best_of_triangles(task - 3);
    }

private:
    /// What splitting by a plane saves, given the costs of the objects hidden behind it and before
    /// it. Empty for slivers.
    std::optional<double> saving(const VolumeBehindPlane& behind,
                                 double offset,
                                 double hidden_behind,
                                 double hidden_before) const {
        const double volume = behind.volume(offset);
        if (std::min(volume, leaf_.volume - volume) < kMinVolumeFraction * leaf_.volume) {
            return std::nullopt;
        }
        const double fraction = behind.viewer_fraction(offset, volume);
        return fraction * hidden_behind +
               std::max(0.0, leaf_.viewer_fraction - fraction) * hidden_before;
    }

    std::vector<ObjectExtent> extents_along(const Vec3& normal) const;
    std::optional<SplitCandidate> best_along(int axis) const;
    std::optional<SplitCandidate> best_of_triangles(std::size_t group) const;
    void choose_triangle_planes(const CellOptions& options);

    const CellBuildContext& build_;
    const CellLeaf& leaf_;
    // Of an object in the leaf's set; entries of other objects are never read or written.
    std::unique_ptr<std::uint32_t[]> index_in_set_;
    std::vector<CellNode> triangle_planes_;
};

/// One per object of the leaf's set.
std::vector<ObjectExtent> LeafSearch::extents_along(const Vec3& normal) const {
    std::vector<ObjectExtent> extents(leaf_.set.size());
    for (const SamplePiece& piece : leaf_.pieces) {
        const VisibilitySample& sample = build_.samples[piece.sample];
        const Extent extent(sample, piece, normal, build_.slack);
        for (const ObjectId object : sample.objects) {
            if (object == kNoObject) {
                continue;
            }
            ObjectExtent& all = extents[index_in_set_[object]];
            if (extent.first < all.first) {
                all.first = extent.first;
                all.low = extent.low;
            }
            if (extent.last > all.last) {
                all.last = extent.last;
                all.high = extent.high;
            }
        }
    }
    return extents;
}

/// The sets on the two sides of a plane change only where the plane passes an object's first or
/// last end, and in between the average cost is monotonic in the fraction behind. So the best plane
/// of an axis goes through one of these ends, two per object, and the ends of all other pieces need
/// not be tried.
std::optional<SplitCandidate> LeafSearch::best_along(int axis) const {
    Vec3 normal(0.0);
    normal[axis] = 1.0;
    const auto extents = extents_along(normal);
    // Objects by their first and by their last end, and the costs of those visible later or
    // earlier.
    std::vector<std::pair<double, double>> first, last;
    std::vector<double> offsets;
    for (std::size_t i = 0; i < extents.size(); ++i) {
        const double cost = build_.costs[leaf_.set[i]];
        first.emplace_back(extents[i].first, cost);
        last.emplace_back(extents[i].last, cost);
        offsets.push_back(extents[i].low);
        offsets.push_back(extents[i].high);
    }
    std::sort(first.begin(), first.end());
    std::sort(last.begin(), last.end());
    std::sort(offsets.begin(), offsets.end());
    offsets.erase(std::unique(offsets.begin(), offsets.end()), offsets.end());
    std::vector<double> later(first.size() + 1, 0.0);
    for (std::size_t i = first.size(); i-- > 0;) {
        later[i] = later[i + 1] + first[i].second;
    }
    const VolumeBehindPlane behind(leaf_, build_.viewers, normal);
    std::optional<SplitCandidate> best;
    std::size_t begun = 0;
    std::size_t ended = 0;
    double earlier = 0.0;
    for (const double offset : offsets) {
        while (begun < first.size() && first[begun].first <= offset) {
            ++begun;
        }
        while (ended < last.size() && last[ended].first < offset) {
            earlier += last[ended++].second;
        }
        if (const auto saved = saving(behind, offset, later[begun], earlier)) {
            keep_best(best, {{normal, offset, 0, 0}, *saved});
        }
    }
    return best;
}

std::optional<SplitCandidate> LeafSearch::best_of_triangles(std::size_t group) const {
    constexpr int kBehind = 1;
    constexpr int kBefore = 2;
    std::vector<CellNode> planes;
    for (std::size_t i = group; i < triangle_planes_.size(); i += kPlaneGroups) {
        planes.push_back(triangle_planes_[i]);
    }
    std::vector<std::uint8_t> seen(planes.size() * leaf_.set.size(), 0);
    for (const SamplePiece& piece : leaf_.pieces) {
        const VisibilitySample& sample = build_.samples[piece.sample];
        for (std::size_t i = 0; i < planes.size(); ++i) {
            const Extent extent(sample, piece, planes[i].normal, build_.slack);
            const int sides = (extent.first <= planes[i].offset ? kBehind : 0) |
                              (extent.last >= planes[i].offset ? kBefore : 0);
            for (const ObjectId object : sample.objects) {
                if (object != kNoObject) {
                    seen[i * leaf_.set.size() + index_in_set_[object]] |=
                        static_cast<std::uint8_t>(sides);
                }
            }
        }
    }
    std::optional<SplitCandidate> best;
    for (std::size_t i = 0; i < planes.size(); ++i) {
        double hidden_behind = 0.0;
        double hidden_before = 0.0;
        for (std::size_t k = 0; k < leaf_.set.size(); ++k) {
            const double cost = build_.costs[leaf_.set[k]];
            const int sides = seen[i * leaf_.set.size() + k];
            hidden_behind += (sides & kBehind) == 0 ? cost : 0.0;
            hidden_before += (sides & kBefore) == 0 ? cost : 0.0;
        }
        const VolumeBehindPlane behind(leaf_, build_.viewers, planes[i].normal);
        if (const auto saved = saving(behind, planes[i].offset, hidden_behind, hidden_before)) {
            keep_best(best, {planes[i], *saved});
        }
    }
    return best;
}

/// The plane of a triangle, its normal oriented so that equal planes compare equal. Empty for a
/// triangle without area.
std::optional<CellNode> plane_of(const geometry::MeshView& mesh, geometry::TriangleId triangle) {
    const auto& [a, b, c] = mesh.triangles[triangle];
    const Vec3 corner = mesh.positions[a];
    Vec3 normal = glm::cross(mesh.positions[b] - corner, mesh.positions[c] - corner);
    const double length = glm::length(normal);
    if (!(length > 0.0) || !std::isfinite(length)) {
        return std::nullopt;
    }
    normal /= length;
    for (int axis = 0; axis < 3; ++axis) {
        if (std::abs(normal[axis]) > kParallel) {
            normal = normal[axis] < 0.0 ? -normal : normal;
            break;
        }
    }
    return CellNode{normal, glm::dot(normal, corner), 0, 0};
}

void LeafSearch::choose_triangle_planes(const CellOptions& options) {
    const std::size_t wanted = options.max_triangle_planes;
    const std::size_t triangles = leaf_.triangles.size();
    // Many triangles lie in few planes: there are more draws than planes wanted.
    const std::size_t draws = triangles <= 2 * wanted ? triangles : 2 * wanted;
    for (std::size_t draw = 0; draw < draws && triangle_planes_.size() < wanted; ++draw) {
        const std::size_t place =
            draws == triangles ? draw : random_bits(options.seed, leaf_.key, draw) % triangles;
        const auto plane = plane_of(options.mesh, leaf_.triangles[place]);
        const auto is_same = [&](const CellNode& other) {
            return glm::length(other.normal - plane->normal) <= kParallel &&
                   std::abs(other.offset - plane->offset) <= build_.slack;
        };
        if (plane && std::none_of(triangle_planes_.begin(), triangle_planes_.end(), is_same)) {
            triangle_planes_.push_back(*plane);
        }
    }
}

}  // namespace

std::vector<std::optional<SplitCandidate>> best_split_planes(
    const CellBuildContext& build,
    const CellOptions& options,
    std::span<const CellLeaf* const> leaves,
    Executor& executor) {
    std::vector<LeafSearch> searches;
    std::size_t pieces = 0;
    for (const CellLeaf* leaf : leaves) {
        searches.emplace_back(build, options, *leaf);
        pieces += leaf->pieces.size();
    }
    std::vector<std::optional<SplitCandidate>> found(kTasksPerLeaf * leaves.size());
    Executor& used = pieces < kMinPiecesForThreads ? Executor::serial() : executor;
    used.for_each(found.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            found[i] = searches[i / kTasksPerLeaf].run(i % kTasksPerLeaf);
        }
    });
    std::vector<std::optional<SplitCandidate>> best(leaves.size());
    for (std::size_t i = 0; i < found.size(); ++i) {
        if (found[i]) {
            keep_best(best[i / kTasksPerLeaf], *found[i]);
        }
    }
    return best;
}

CellNode spatial_median_plane(const CellLeaf& leaf) {
    const ViewRegion box = leaf.shape.box();
    int axis = 0;
    for (int k = 1; k < 3; ++k) {
        axis = box.size()[k] > box.size()[axis] ? k : axis;
    }
    CellNode plane;
    plane.normal[axis] = 1.0;
    plane.offset = box.lower[axis] + 0.5 * box.size()[axis];
    return plane;
}

}  // namespace earshot::visibility
