// SPDX-License-Identifier: MIT
#include "earshot/base/assert.h"
#include "earshot/bvh/internal/builders.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

namespace earshot::bvh {

using geometry::Aabb;

namespace {

constexpr std::size_t kBins = 16;

/// From this depth on, ranges are halved by count: 2^31 primitives end kMaxDepth - 32 + 31 levels
/// down, whatever their boxes look like.
constexpr std::size_t kHalvingDepth = kMaxDepth - 32;

/// Ranges up to this size are built by one task.
constexpr std::size_t kTaskSize = 8192;

/// A box with its index, moved about together so that passes over a range read memory in order.
struct Primitive {
    Aabb box;
    std::uint32_t index = 0;
};

/// Twice the centre of a box along an axis.
double centre(const Aabb& box, std::size_t axis) {
    return static_cast<double>(box.lower[axis]) + static_cast<double>(box.upper[axis]);
}

struct Range {
    std::size_t begin = 0, end = 0;
    std::size_t size() const { return end - begin; }
};

/// What a pass over a range finds: the box, and where centres lie.
struct Extent {
    Aabb box;
    std::array<double, 3> lower{}, upper{};  // of centre()
};

struct Bin {
    Aabb box;
    std::size_t count = 0;
};

/// Maps centres to bins along one axis.
struct Binning {
    std::size_t axis = 0;
    double lower = 0.0;
    double scale = 0.0;  // 0: all centres coincide
    std::size_t bins = kBins;

    std::size_t bin_of(const Aabb& box) const {
        const auto bin = static_cast<std::size_t>((centre(box, axis) - lower) * scale);
        return std::min(bin, bins - 1);
    }
};

struct Split {
    Binning binning;
    std::size_t first_right_bin = 0;
    double cost = std::numeric_limits<double>::infinity();  // of both sides, times the half area
};

class Splitter {
public:
    Splitter(std::vector<Primitive>& primitives, const BuildOptions& options)
        : primitives_(primitives),
          leaf_size_(static_cast<std::size_t>(options.leaf_size)),
          traversal_cost_(options.traversal_cost) {}

    Extent extent_of(Range range) const {
        Extent extent;
        extent.lower.fill(std::numeric_limits<double>::infinity());
        extent.upper.fill(-std::numeric_limits<double>::infinity());
        for (std::size_t i = range.begin; i < range.end; ++i) {
            const Aabb& box = primitives_[i].box;
            extent.box.include(box);
            for (std::size_t axis = 0; axis < 3; ++axis) {
                const double c = centre(box, axis);
                extent.lower[axis] = c < extent.lower[axis] ? c : extent.lower[axis];
                extent.upper[axis] = c > extent.upper[axis] ? c : extent.upper[axis];
            }
        }
        return extent;
    }

    /// Where the range is cut in two; its end if it is to be a leaf. Reorders the range.
    std::size_t partition(Range range, const Extent& extent, std::size_t depth) {
        const Aabb& box = extent.box;
        if (range.size() == 1) {
            return range.end;
        }
        if (depth >= kHalvingDepth) {
            return range.size() <= leaf_size_ ? range.end : halve(range, box);
        }
        const Split split = find_split(range, extent);
        const double leaf_cost = static_cast<double>(range.size()) * box.half_area();
        const double split_cost = traversal_cost_ * box.half_area() + split.cost;
        if (range.size() <= leaf_size_ && !(split_cost < leaf_cost)) {
            return range.end;
        }
        if (split.first_right_bin == 0) {
            return halve(range, box);
        }
        const auto first = primitives_.begin();
        const auto middle =
            std::partition(first + static_cast<std::ptrdiff_t>(range.begin),
                           first + static_cast<std::ptrdiff_t>(range.end),
                           [&](const Primitive& primitive) {
                               return split.binning.bin_of(primitive.box) < split.first_right_bin;
                           });
        return static_cast<std::size_t>(middle - first);
    }

    /// Appends the descendants of nodes[root] in depth-first order.
    void build(std::vector<Node>& nodes, std::size_t root, Range range, std::size_t depth) {
        EARSHOT_ASSERT(depth <= kMaxDepth);
        const Extent extent = extent_of(range);
        nodes[root].box = extent.box;
        const std::size_t middle = partition(range, extent, depth);
        if (middle == range.end) {
            nodes[root].first = static_cast<std::uint32_t>(range.begin);
            nodes[root].count = static_cast<std::uint32_t>(range.size());
            return;
        }
        const std::size_t left = nodes.size();
        nodes.resize(left + 2);
        nodes[root].first = static_cast<std::uint32_t>(left);
        build(nodes, left, {range.begin, middle}, depth + 1);
        build(nodes, left + 1, {middle, range.end}, depth + 1);
    }

private:
    // Wald 2007, sections 3.1 to 3.3: bins over the centres, swept from both sides.
    Split find_split(Range range, const Extent& extent) const {
        std::array<Binning, 3> binnings;
        // Most ranges are small, and their time is the sweep's.
        const std::size_t bin_count = std::min(kBins, 2 * range.size());
        std::array<std::array<Bin, kBins>, 3> bins;
        for (auto& along_axis : bins) {
            std::fill_n(along_axis.begin(), bin_count, Bin{});
        }
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const double width = extent.upper[axis] - extent.lower[axis];
            const double scale = static_cast<double>(bin_count) / width;
            binnings[axis] = {
                axis, extent.lower[axis], std::isfinite(scale) ? scale : 0.0, bin_count};
        }
        for (std::size_t i = range.begin; i < range.end; ++i) {
            const Aabb& box = primitives_[i].box;
            for (std::size_t axis = 0; axis < 3; ++axis) {
                Bin& bin = bins[axis][binnings[axis].bin_of(box)];
                bin.box.include(box);
                ++bin.count;
            }
        }
        Split best;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            if (binnings[axis].scale > 0.0) {
                sweep(bins[axis], binnings[axis], best);
            }
        }
        return best;
    }

    static void sweep(const std::array<Bin, kBins>& bins, const Binning& binning, Split& best) {
        std::array<double, kBins> right_cost{};
        Aabb box;
        std::size_t count = 0;
        for (std::size_t i = binning.bins; i-- > 1;) {
            box.include(bins[i].box);
            count += bins[i].count;
            right_cost[i] = static_cast<double>(count) * box.half_area();
        }
        const std::size_t all = count + bins[0].count;
        box = Aabb::empty();
        count = 0;
        for (std::size_t i = 1; i < binning.bins; ++i) {
            box.include(bins[i - 1].box);
            count += bins[i - 1].count;
            const double cost = static_cast<double>(count) * box.half_area() + right_cost[i];
            if (count > 0 && count < all && cost < best.cost) {
                best = {binning, i, cost};
            }
        }
    }

    /// Half the range on either side, by centre along the longest axis, then by index.
    std::size_t halve(Range range, const Aabb& box) {
        std::size_t axis = 0;
        for (std::size_t k = 1; k < 3; ++k) {
            if (box.upper[k] - box.lower[k] > box.upper[axis] - box.lower[axis]) {
                axis = k;
            }
        }
        const std::size_t middle = range.begin + range.size() / 2;
        const auto first = primitives_.begin();
        std::nth_element(first + static_cast<std::ptrdiff_t>(range.begin),
                         first + static_cast<std::ptrdiff_t>(middle),
                         first + static_cast<std::ptrdiff_t>(range.end),
                         [&](const Primitive& a, const Primitive& b) {
                             const double ca = centre(a.box, axis);
                             const double cb = centre(b.box, axis);
                             return ca != cb ? ca < cb : a.index < b.index;
                         });
        return middle;
    }

    std::vector<Primitive>& primitives_;
    std::size_t leaf_size_;
    double traversal_cost_;
};

/// The top of the tree, cut until ranges are small enough for a task each.
struct TopNode {
    Range range{};
    std::size_t depth = 0;
    Aabb box{};
    std::size_t left = 0;  // index of the left child; 0: a task
    std::size_t task = 0;
};

std::vector<TopNode> build_top(Splitter& splitter, std::size_t count, std::size_t& tasks) {
    std::vector<TopNode> top(1);
    top[0].range = {0, count};
    for (std::size_t i = 0; i < top.size(); ++i) {
        TopNode node = top[i];
        if (node.range.size() > kTaskSize) {
            const Extent extent = splitter.extent_of(node.range);
            node.box = extent.box;
            const std::size_t middle = splitter.partition(node.range, extent, node.depth);
            node.left = top.size();
            top.push_back({.range = {node.range.begin, middle}, .depth = node.depth + 1});
            top.push_back({.range = {middle, node.range.end}, .depth = node.depth + 1});
        } else {
            node.task = tasks++;
        }
        top[i] = node;
    }
    return top;
}

/// Joins the top and the tasks' trees in depth-first order.
struct Joiner {
    const std::vector<TopNode>& top;
    const std::vector<std::vector<Node>>& trees;
    std::vector<Node>& nodes;

    void place(std::size_t source, std::size_t target) {
        const TopNode& node = top[source];
        if (node.left != 0) {
            const std::size_t left = nodes.size();
            nodes.resize(left + 2);
            nodes[target] = {.box = node.box, .first = static_cast<std::uint32_t>(left)};
            place(node.left, left);
            place(node.left + 1, left + 1);
            return;
        }
        // A task's nodes follow its root, which goes to the slot beside its sibling.
        const std::vector<Node>& tree = trees[node.task];
        const auto shift = static_cast<std::uint32_t>(nodes.size() - 1);
        const auto shifted = [&](Node copy) {
            copy.first += copy.is_leaf() ? 0 : shift;
            return copy;
        };
        nodes[target] = shifted(tree[0]);
        std::transform(tree.begin() + 1, tree.end(), std::back_inserter(nodes), shifted);
    }
};

}  // namespace

Tree build_binned_sah(std::span<const Aabb> boxes,
                      const BuildOptions& options,
                      Executor& executor) {
    std::vector<Primitive> primitives(boxes.size());
    for (std::size_t i = 0; i < boxes.size(); ++i) {
        primitives[i] = {boxes[i], static_cast<std::uint32_t>(i)};
    }
    Splitter splitter(primitives, options);
    std::size_t tasks = 0;
    const std::vector<TopNode> top = build_top(splitter, boxes.size(), tasks);
    std::vector<const TopNode*> of_task(tasks);
    for (const TopNode& node : top) {
        if (node.left == 0) {
            of_task[node.task] = &node;
        }
    }
    std::vector<std::vector<Node>> trees(tasks);
    executor.for_each(tasks, 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t task = begin; task < end; ++task) {
            trees[task].resize(1);
            splitter.build(trees[task], 0, of_task[task]->range, of_task[task]->depth);
        }
    });
    std::vector<Node> nodes(1);
    nodes.reserve(2 * boxes.size());
    Joiner{top, trees, nodes}.place(0, 0);
    nodes.shrink_to_fit();
    std::vector<std::uint32_t> indices;
    indices.reserve(primitives.size());
    for (const Primitive& primitive : primitives) {
        indices.push_back(primitive.index);
    }
    return Tree::from_nodes(std::move(nodes), std::move(indices));
}

}  // namespace earshot::bvh
