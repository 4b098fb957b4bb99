// SPDX-License-Identifier: MIT
#include "earshot/visibility/build_view_cells.h"

#include "earshot/base/error.h"
#include "earshot/base/halton.h"
#include "earshot/visibility/internal/split_plane_search.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <queue>
#include <string>
#include <utility>

namespace earshot::visibility {

using geometry::TriangleId;
using geometry::Vec3;

namespace {

// ViewCells accepts trees with up to 4096 nodes between the root and a leaf.
constexpr int kMaxDepth = 4096;

void check_options(const ViewRegion& region, const CellOptions& options) {
    validate(region);
    const Vec3 size = region.size();
    if (!(size.x > 0.0 && size.y > 0.0 && size.z > 0.0 && region.volume() > 0.0)) {
        throw Error("region", "it has no volume", "make it thicker");
    }
    if (options.max_cells == 0 || options.max_cells > ViewCells::kMaxLeaves) {
        throw Error(
            "view cells",
            "the number of cells is 0, or more than " + std::to_string(ViewCells::kMaxLeaves),
            "choose another");
    }
    if (!(options.min_saving >= 0.0) || options.max_poor_splits < 1) {
        throw Error("view cells",
                    "a limit of poor splits is negative, or their number is 0",
                    "choose other limits");
    }
}

/// Sample points of the density of viewers, evenly distributed in the region, with their fractions.
std::vector<Viewer> viewers_of(const ViewRegion& region, const CellOptions& options) {
    std::vector<Viewer> viewers;
    if (!options.density) {
        return viewers;
    }
    constexpr std::array<std::uint32_t, 3> kBases = {2, 3, 5};
    double sum = 0.0;
    for (std::size_t i = 0; i < options.density_points; ++i) {
        Viewer viewer;
        for (int axis = 0; axis < 3; ++axis) {
            const double fraction = radical_inverse(i + 1, kBases[static_cast<std::size_t>(axis)]);
            viewer.position[axis] = region.lower[axis] + region.size()[axis] * fraction;
        }
        viewer.fraction = options.density(viewer.position);
        if (!std::isfinite(viewer.fraction) || viewer.fraction < 0.0) {
            throw Error("density", "it is negative or not finite somewhere", "give one from 0");
        }
        sum += viewer.fraction;
        viewers.push_back(viewer);
    }
    if (!(sum > 0.0) || !std::isfinite(sum)) {
        throw Error("density", "no viewers are in the region", "give one that is not 0 there");
    }
    for (Viewer& viewer : viewers) {
        viewer.fraction /= sum;
    }
    return viewers;
}

/// The triangles whose boxes intersect a region, except for the excluded triangles.
std::vector<TriangleId> triangles_near(const geometry::MeshView& mesh,
                                       const ViewRegion& region,
                                       const ExclusionMask& excluded) {
    std::vector<TriangleId> triangles;
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        const auto& [a, b, c] = mesh.triangles[i];
        const auto& positions = mesh.positions;
        const Vec3 lower = glm::min(positions[a], glm::min(positions[b], positions[c]));
        const Vec3 upper = glm::max(positions[a], glm::max(positions[b], positions[c]));
        const auto id = static_cast<TriangleId>(i);
        if (!excluded.contains(id) && !glm::any(glm::lessThan(upper, region.lower)) &&
            !glm::any(glm::greaterThan(lower, region.upper))) {
            triangles.push_back(id);
        }
    }
    return triangles;
}

class CellBuilder {
public:
    CellBuilder(const ViewRegion& region, const CellOptions& options, Executor& executor)
        : options_(options), executor_(executor) {
        context_.region = region;
        context_.slack = plane_slack(region);
        context_.viewers = viewers_of(region, options);
    }

    BuiltCells run(std::span<const FreeSegment> segments, const Objects& objects);

private:
    /// A leaf that may be split. The leaf with the largest priority is split first, among equal
    /// priorities the leaf with the lowest number.
    struct QueueEntry {
        double priority;
        LeafId leaf;
        bool operator<(const QueueEntry& other) const {
            return std::pair(priority, other.leaf) < std::pair(other.priority, leaf);
        }
    };
    /// The link to a leaf: one of the two children of a node.
    struct ChildLink {
        std::size_t node;
        bool is_front;
    };

    void make_root(std::span<const FreeSegment> segments, const Objects& objects);
    void split(LeafId id);
    LeafId grow_tree(LeafId id, CellNode plane);
    void distribute_pieces(const CellLeaf& leaf,
                           const CellNode& plane,
                           CellLeaf& back,
                           CellLeaf& front);
    void distribute_triangles(const CellLeaf& leaf,
                              const CellNode& plane,
                              CellLeaf& back,
                              CellLeaf& front) const;
    void compute_cost(CellLeaf& leaf) const;
    void find_splits(std::span<const LeafId> ids);
    bool may_be_split(const CellLeaf& leaf) const;

    CellOptions options_;
    Executor& executor_;
    CellBuildContext context_;
    std::vector<CellLeaf> leaves_;
    std::vector<SplitCandidate> candidates_;  // per leaf: its best split
    std::vector<ChildLink> links_;            // per leaf: the link to it
    std::vector<CellNode> nodes_;
    std::priority_queue<QueueEntry> queue_;
    std::vector<std::uint8_t> object_sides_;  // per object, for distribute_pieces
    double cost_ = 0.0;
    std::vector<CellSplit> splits_;
};

void CellBuilder::make_root(std::span<const FreeSegment> segments, const Objects& objects) {
    context_.costs = object_costs(objects, options_.cost);
    object_sides_.assign(objects.size(), 0);
    CellLeaf root{.shape = CellShape(context_.region)};
    for (const FreeSegment& free : segments) {
        const geometry::Interval inside = clip(free.segment, context_.region);
        if (!free.is_valid() || inside.is_empty()) {
            continue;
        }
        VisibilitySample sample = {free.segment.from, free.segment.to - free.segment.from};
        const std::array<TriangleId, 2> ends = {free.at_from, free.at_to};
        for (std::size_t k = 0; k < 2; ++k) {
            if (ends[k] != kNoTriangle) {
                sample.objects[k] = objects.of(ends[k]);
                object_sides_[sample.objects[k]] = 1;
            }
        }
        root.pieces.push_back(
            {static_cast<std::uint32_t>(context_.samples.size()), inside.min, inside.max});
        context_.samples.push_back(sample);
    }
    for (ObjectId object = 0; object < objects.size(); ++object) {
        if (std::exchange(object_sides_[object], 0) != 0) {
            root.set.push_back(object);
        }
    }
    if (options_.rule == CellRule::cost && options_.max_triangle_planes > 0) {
        root.triangles = triangles_near(options_.mesh, context_.region, options_.excluded);
    }
    root.viewers.resize(context_.viewers.size());
    for (std::size_t i = 0; i < root.viewers.size(); ++i) {
        root.viewers[i] = static_cast<std::uint32_t>(i);
    }
    compute_cost(root);
    cost_ = root.viewer_fraction * root.set_cost;
    leaves_.push_back(std::move(root));
}

/// Computes the volume, the viewer fraction and the cost of a leaf from its shape, set and viewers.
void CellBuilder::compute_cost(CellLeaf& leaf) const {
    leaf.volume = leaf.shape.volume();
    leaf.set_cost = set_cost(leaf.set, context_.costs);
    leaf.viewer_fraction = context_.viewers.empty() ? leaf.volume / context_.region.volume() : 0.0;
    for (const std::uint32_t viewer : leaf.viewers) {
        leaf.viewer_fraction += context_.viewers[viewer].fraction;
    }
}

bool CellBuilder::may_be_split(const CellLeaf& leaf) const {
    return leaf.depth < kMaxDepth &&
           (options_.rule == CellRule::middle ||
            (leaf.poor_splits < options_.max_poor_splits &&
             leaf.pieces.size() >= options_.min_segments && !leaf.set.empty()));
}

void CellBuilder::find_splits(std::span<const LeafId> ids) {
    std::vector<LeafId> ids_to_split;
    std::vector<const CellLeaf*> leaves;
    for (const LeafId id : ids) {
        if (may_be_split(leaves_[id])) {
            ids_to_split.push_back(id);
            leaves.push_back(&leaves_[id]);
        }
    }
    candidates_.resize(leaves_.size());
    if (options_.rule == CellRule::middle) {
        for (const LeafId id : ids_to_split) {
            candidates_[id] = {spatial_median_plane(leaves_[id]), 0.0};
            queue_.push({leaves_[id].volume, id});
        }
        return;
    }
    const auto best = best_split_planes(context_, options_, leaves, executor_);
    for (std::size_t i = 0; i < ids_to_split.size(); ++i) {
        if (best[i]) {
            candidates_[ids_to_split[i]] = *best[i];
            queue_.push({best[i]->saving, ids_to_split[i]});
        }
    }
}

/// Distributes the pieces of a leaf to the sides of the plane that they reach, clipped where they
/// cross the plane, and distributes the objects accordingly.
void CellBuilder::distribute_pieces(const CellLeaf& leaf,
                                    const CellNode& plane,
                                    CellLeaf& back,
                                    CellLeaf& front) {
    constexpr int kBack = 1;
    constexpr int kFront = 2;
    for (const SamplePiece& piece : leaf.pieces) {
        const VisibilitySample& sample = context_.samples[piece.sample];
        const Extent extent(sample, piece, plane.normal, context_.slack);
        const int sides =
            (extent.first <= plane.offset ? kBack : 0) | (extent.last >= plane.offset ? kFront : 0);
        SamplePiece back_piece = piece;
        SamplePiece front_piece = piece;
        if (sides == (kBack | kFront) && extent.low < plane.offset && extent.high > plane.offset) {
            const double fraction_at_plane =
                (plane.offset - extent.at_begin) / (extent.at_end - extent.at_begin);
            const double crossing = piece.begin + fraction_at_plane * (piece.end - piece.begin);
            const bool is_forward = extent.at_begin < extent.at_end;
            (is_forward ? back_piece.end : back_piece.begin) = crossing;
            (is_forward ? front_piece.begin : front_piece.end) = crossing;
        }
        if ((sides & kBack) != 0) {
            back.pieces.push_back(back_piece);
        }
        if ((sides & kFront) != 0) {
            front.pieces.push_back(front_piece);
        }
        for (const ObjectId object : sample.objects) {
            if (object != kNoObject) {
                object_sides_[object] |= static_cast<std::uint8_t>(sides);
            }
        }
    }
    for (const ObjectId object : leaf.set) {
        const int sides = std::exchange(object_sides_[object], 0);
        if ((sides & kBack) != 0) {
            back.set.push_back(object);
        }
        if ((sides & kFront) != 0) {
            front.set.push_back(object);
        }
    }
}

void CellBuilder::distribute_triangles(const CellLeaf& leaf,
                                       const CellNode& plane,
                                       CellLeaf& back,
                                       CellLeaf& front) const {
    for (const TriangleId triangle : leaf.triangles) {
        double lowest = std::numeric_limits<double>::infinity();
        double highest = -lowest;
        for (const geometry::VertexId vertex : options_.mesh.triangles[triangle]) {
            const double height =
                glm::dot(plane.normal, options_.mesh.positions[vertex]) - plane.offset;
            lowest = std::min(lowest, height);
            highest = std::max(highest, height);
        }
        // The planes of triangles that lie in the split plane are no further candidates.
        if (lowest < -context_.slack) {
            back.triangles.push_back(triangle);
        }
        if (highest > context_.slack) {
            front.triangles.push_back(triangle);
        }
    }
}

/// Replaces a leaf in the tree by a node with two children: that leaf and a new leaf. Returns the
/// number of the new leaf.
LeafId CellBuilder::grow_tree(LeafId id, CellNode plane) {
    const auto node = static_cast<std::uint32_t>(nodes_.size());
    const auto added = static_cast<LeafId>(leaves_.size());
    plane.back = kCellLeaf + id;
    plane.front = kCellLeaf + added;
    if (node > 0) {
        CellNode& parent = nodes_[links_[id].node];
        (links_[id].is_front ? parent.front : parent.back) = node;
    }
    nodes_.push_back(plane);
    links_[id] = {node, false};
    links_.push_back({node, true});
    return added;
}

void CellBuilder::split(LeafId id) {
    CellLeaf& leaf = leaves_[id];
    const CellNode plane = candidates_[id].plane;
    const auto node = static_cast<std::uint32_t>(nodes_.size());
    auto children = leaf.shape.split(plane, node, context_.slack);
    if (!children) {
        return;  // the leaf is thinner than the slack
    }
    CellLeaf back{.shape = std::move(children->back)};
    CellLeaf front{.shape = std::move(children->front)};
    distribute_pieces(leaf, plane, back, front);
    distribute_triangles(leaf, plane, back, front);
    for (const std::uint32_t viewer : leaf.viewers) {
        const Vec3& position = context_.viewers[viewer].position;
        (glm::dot(plane.normal, position) < plane.offset ? back : front).viewers.push_back(viewer);
    }
    compute_cost(back);
    compute_cost(front);
    // The sets of the children are subsets of the leaf's, so that an increase would be a rounding
    // error.
    const double saving =
        std::max(0.0,
                 leaf.viewer_fraction * leaf.set_cost - back.viewer_fraction * back.set_cost -
                     front.viewer_fraction * front.set_cost);
    const bool is_poor_split = saving < options_.min_saving * cost_;
    for (CellLeaf* child : {&back, &front}) {
        child->depth = leaf.depth + 1;
        child->poor_splits = is_poor_split ? leaf.poor_splits + 1 : 0;
        child->key = 2 * std::uint64_t{node} + (child == &front ? 2 : 1);
    }
    cost_ -= saving;
    splits_.push_back(
        {id, options_.rule == CellRule::cost ? candidates_[id].saving : saving, cost_});
    const LeafId added = grow_tree(id, plane);
    leaf = std::move(back);
    leaves_.push_back(std::move(front));
    find_splits(std::array{id, added});
}

BuiltCells CellBuilder::run(std::span<const FreeSegment> segments, const Objects& objects) {
    make_root(segments, objects);
    links_.push_back({0, false});
    const double region_cost = cost_;
    find_splits(std::array{LeafId{0}});
    while (!queue_.empty() && leaves_.size() < options_.max_cells &&
           !(options_.interrupt && options_.interrupt())) {
        const LeafId next = queue_.top().leaf;
        queue_.pop();
        split(next);
        if (options_.progress != nullptr) {
            options_.progress->report("view cells", leaves_.size(), options_.max_cells);
        }
    }
    if (options_.progress != nullptr) {
        options_.progress->report("view cells", options_.max_cells, options_.max_cells);
    }
    std::vector<double> volumes;
    BuiltCells built{.cells = ViewCells(context_.region),
                     .sets = {},
                     .viewer_fractions = {},
                     .region_cost = region_cost,
                     .splits = std::move(splits_)};
    for (CellLeaf& leaf : leaves_) {
        volumes.push_back(leaf.volume);
        built.sets.push_back(std::move(leaf.set));
        built.viewer_fractions.push_back(leaf.viewer_fraction);
    }
    built.cells = ViewCells(context_.region, std::move(nodes_), std::move(volumes));
    return built;
}

}  // namespace

BuiltCells build_view_cells(const ViewRegion& region,
                            std::span<const FreeSegment> segments,
                            const Objects& objects,
                            const CellOptions& options,
                            Executor& executor) {
    check_options(region, options);
    return CellBuilder(region, options, executor).run(segments, objects);
}

}  // namespace earshot::visibility
