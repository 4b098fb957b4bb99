// SPDX-License-Identifier: MIT
#include "earshot/visibility/internal/plane_search.h"

#include "earshot/base/random.h"
#include "earshot/visibility/internal/share_behind.h"

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
constexpr double kLeastPart = 1e-9;

/// Below this much work threads take longer to start than to do it.
constexpr std::size_t kPiecesWorthThreads = 20000;

constexpr std::size_t kPlaneGroups = 4;
constexpr std::size_t kTasksPerLeaf = 3 + kPlaneGroups;

/// Unit normals that differ by less are parallel.
constexpr double kParallel = 1e-9;

void keep_better(std::optional<Proposal>& best, const Proposal& proposal) {
    if (!best || proposal.saving > best->saving) {
        best = proposal;
    }
}

/// How far the sights of an object reach along an axis: it is seen behind planes of offset >= first
/// and before those of offset <= last.
struct ObjectReach {
    double first = std::numeric_limits<double>::infinity();
    double last = -std::numeric_limits<double>::infinity();
    double low = 0.0, high = 0.0;  // the ends that set first and last
};

/// The search in one leaf.
class LeafSearch {
public:
    LeafSearch(const CellBuild& build, const CellOptions& options, const CellLeaf& leaf)
        : build_(build),
          leaf_(leaf),
          place_(std::make_unique_for_overwrite<std::uint32_t[]>(build.costs.size())) {
        for (std::size_t i = 0; i < leaf.set.size(); ++i) {
            place_[leaf.set[i]] = static_cast<std::uint32_t>(i);
        }
        choose_triangle_planes(options);
    }

    std::optional<Proposal> run(std::size_t task) const {
        return task < 3 ? best_along(static_cast<int>(task)) : best_of_triangles(task - 3);
    }

private:
    /// What dividing by a plane saves, if what is not seen behind it and before it would cost so
    /// much. Empty for slivers.
    std::optional<double> saving(const ShareBehind& behind,
                                 double offset,
                                 double unseen_behind,
                                 double unseen_before) const {
        const double volume = behind.volume(offset);
        if (std::min(volume, leaf_.volume - volume) < kLeastPart * leaf_.volume) {
            return std::nullopt;
        }
        const double share = behind.share(offset, volume);
        return share * unseen_behind + std::max(0.0, leaf_.share - share) * unseen_before;
    }

    std::vector<ObjectReach> reaches_along(const Vec3& normal) const;
    std::optional<Proposal> best_along(int axis) const;
    std::optional<Proposal> best_of_triangles(std::size_t group) const;
    void choose_triangle_planes(const CellOptions& options);

    const CellBuild& build_;
    const CellLeaf& leaf_;
    // Of an object in the leaf's set; those of other objects are never looked at, or written.
    std::unique_ptr<std::uint32_t[]> place_;
    std::vector<CellNode> triangle_planes_;
};

/// One per object of the leaf's set.
std::vector<ObjectReach> LeafSearch::reaches_along(const Vec3& normal) const {
    std::vector<ObjectReach> reaches(leaf_.set.size());
    for (const SightPiece& piece : leaf_.pieces) {
        const Sight& sight = build_.sights[piece.sight];
        const Reach reach(sight, piece, normal, build_.slack);
        for (const ObjectId object : sight.objects) {
            if (object == kNoObject) {
                continue;
            }
            ObjectReach& all = reaches[place_[object]];
            if (reach.first < all.first) {
                all.first = reach.first;
                all.low = reach.low;
            }
            if (reach.last > all.last) {
                all.last = reach.last;
                all.high = reach.high;
            }
        }
    }
    return reaches;
}

/// Which sets a plane at x leaves on its sides changes where an object's first or last end is
/// passed, and in between the average cost is a monotonous function of the share behind. So the
/// best plane of an axis goes through one of these ends, two per object, and the ends of all other
/// pieces need not be tried.
std::optional<Proposal> LeafSearch::best_along(int axis) const {
    Vec3 normal(0.0);
    normal[axis] = 1.0;
    const auto reaches = reaches_along(normal);
    // Objects by their first and by their last end, and the costs of those seen later or earlier.
    std::vector<std::pair<double, double>> first, last;
    std::vector<double> offsets;
    for (std::size_t i = 0; i < reaches.size(); ++i) {
        const double cost = build_.costs[leaf_.set[i]];
        first.emplace_back(reaches[i].first, cost);
        last.emplace_back(reaches[i].last, cost);
        offsets.push_back(reaches[i].low);
        offsets.push_back(reaches[i].high);
    }
    std::sort(first.begin(), first.end());
    std::sort(last.begin(), last.end());
    std::sort(offsets.begin(), offsets.end());
    offsets.erase(std::unique(offsets.begin(), offsets.end()), offsets.end());
    std::vector<double> later(first.size() + 1, 0.0);
    for (std::size_t i = first.size(); i-- > 0;) {
        later[i] = later[i + 1] + first[i].second;
    }
    const ShareBehind behind(leaf_, build_.viewers, normal);
    std::optional<Proposal> best;
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
            keep_better(best, {{normal, offset, 0, 0}, *saved});
        }
    }
    return best;
}

std::optional<Proposal> LeafSearch::best_of_triangles(std::size_t group) const {
    constexpr int kBehind = 1;
    constexpr int kBefore = 2;
    std::vector<CellNode> planes;
    for (std::size_t i = group; i < triangle_planes_.size(); i += kPlaneGroups) {
        planes.push_back(triangle_planes_[i]);
    }
    std::vector<std::uint8_t> seen(planes.size() * leaf_.set.size(), 0);
    for (const SightPiece& piece : leaf_.pieces) {
        const Sight& sight = build_.sights[piece.sight];
        for (std::size_t i = 0; i < planes.size(); ++i) {
            const Reach reach(sight, piece, planes[i].normal, build_.slack);
            const int sides = (reach.first <= planes[i].offset ? kBehind : 0) |
                              (reach.last >= planes[i].offset ? kBefore : 0);
            for (const ObjectId object : sight.objects) {
                if (object != kNoObject) {
                    seen[i * leaf_.set.size() + place_[object]] |= static_cast<std::uint8_t>(sides);
                }
            }
        }
    }
    std::optional<Proposal> best;
    for (std::size_t i = 0; i < planes.size(); ++i) {
        double unseen_behind = 0.0;
        double unseen_before = 0.0;
        for (std::size_t k = 0; k < leaf_.set.size(); ++k) {
            const double cost = build_.costs[leaf_.set[k]];
            const int sides = seen[i * leaf_.set.size() + k];
            unseen_behind += (sides & kBehind) == 0 ? cost : 0.0;
            unseen_before += (sides & kBefore) == 0 ? cost : 0.0;
        }
        const ShareBehind behind(leaf_, build_.viewers, planes[i].normal);
        if (const auto saved = saving(behind, planes[i].offset, unseen_behind, unseen_before)) {
            keep_better(best, {planes[i], *saved});
        }
    }
    return best;
}

/// The plane of a triangle, its normal turned so that the same plane always looks the same. Empty
/// for a triangle without area.
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

std::vector<std::optional<Proposal>> best_planes(const CellBuild& build,
                                                 const CellOptions& options,
                                                 std::span<const CellLeaf* const> leaves,
                                                 Executor& executor) {
    std::vector<LeafSearch> searches;
    std::size_t pieces = 0;
    for (const CellLeaf* leaf : leaves) {
        searches.emplace_back(build, options, *leaf);
        pieces += leaf->pieces.size();
    }
    std::vector<std::optional<Proposal>> found(kTasksPerLeaf * leaves.size());
    Executor& used = pieces < kPiecesWorthThreads ? Executor::serial() : executor;
    used.for_each(found.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            found[i] = searches[i / kTasksPerLeaf].run(i % kTasksPerLeaf);
        }
    });
    std::vector<std::optional<Proposal>> best(leaves.size());
    for (std::size_t i = 0; i < found.size(); ++i) {
        if (found[i]) {
            keep_better(best[i / kTasksPerLeaf], *found[i]);
        }
    }
    return best;
}

CellNode middle_plane(const CellLeaf& leaf) {
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
