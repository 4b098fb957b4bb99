// SPDX-License-Identifier: MIT
#include "earshot/visibility/view_cells.h"

#include "earshot/base/error.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <functional>
#include <numeric>
#include <string>
#include <utility>

namespace earshot::visibility {

using geometry::Segment;
using geometry::Vec3;

namespace {

[[noreturn]] void fail(const char* what) {
    throw Error("view cells", what, "build them again");
}

/// Signed, in multiples of the normal's length.
double height(const CellNode& node, const Vec3& point) noexcept {
    return glm::dot(node.normal, point) - node.offset;
}

// Segments are followed down by recursion.
constexpr std::uint32_t kMaxDepth = 4096;

/// Every leaf once, and every node but the root once and after its parent.
void check_tree(std::span<const CellNode> nodes, std::size_t leaves) {
    if (leaves == 0 || leaves > ViewCells::kMaxLeaves || nodes.size() + 1 != leaves) {
        fail("the numbers of nodes and leaves do not fit each other");
    }
    std::vector<std::uint8_t> has_node(nodes.size(), 0);
    std::vector<std::uint8_t> has_leaf(leaves, 0);
    std::vector<std::uint32_t> depth(nodes.size(), 0);
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        if (depth[i] >= kMaxDepth) {
            fail("the tree is too deep");
        }
        for (const std::uint32_t child : {nodes[i].back, nodes[i].front}) {
            const bool is_leaf = (child & kCellLeaf) != 0;
            const std::size_t index = child & ~kCellLeaf;
            if (is_leaf ? index >= leaves : index <= i || index >= nodes.size()) {
                fail("a node refers to a child that does not exist");
            }
            if (std::exchange((is_leaf ? has_leaf : has_node)[index], 1) != 0) {
                fail("two nodes refer to the same child");
            }
            if (!is_leaf) {
                depth[index] = depth[i] + 1;
            }
        }
    }
}

/// A block of a grid that is still to be divided.
struct Block {
    std::array<std::uint32_t, 3> begin, end;
};

class GridMaker {
public:
    GridMaker(const ViewRegion& region, const std::array<std::uint32_t, 3>& counts)
        : region_(region), counts_(counts) {}

    /// Divides a block in the middle of its longest side, counted in cells; returns its word.
    std::uint32_t divide(const Block& block) {
        int axis = 0;
        for (int k = 1; k < 3; ++k) {
            axis = width(block, k) > width(block, axis) ? k : axis;
        }
        if (width(block, axis) == 1) {
            return kCellLeaf + (block.begin[2] * counts_[1] + block.begin[1]) * counts_[0] +
                   block.begin[0];
        }
        const auto k = static_cast<std::size_t>(axis);
        const std::uint32_t middle = block.begin[k] + width(block, axis) / 2;
        const auto index = static_cast<std::uint32_t>(nodes.size());
        CellNode& node = nodes.emplace_back();
        node.normal[axis] = 1.0;
        node.offset = region_.lower[axis] + region_.size()[axis] * middle / counts_[k];
        Block back = block;
        back.end[k] = middle;
        Block front = block;
        front.begin[k] = middle;
        const std::uint32_t behind = divide(back);
        const std::uint32_t before = divide(front);
        nodes[index].back = behind;
        nodes[index].front = before;
        return index;
    }

    std::vector<CellNode> nodes;

private:
    static std::uint32_t width(const Block& block, int axis) noexcept {
        const auto k = static_cast<std::size_t>(axis);
        return block.end[k] - block.begin[k];
    }

    ViewRegion region_;
    std::array<std::uint32_t, 3> counts_;
};

}  // namespace

ViewCells::ViewCells(const ViewRegion& region) : ViewCells(region, {}, {region.volume()}) {}

ViewCells::ViewCells(const ViewRegion& region,
                     std::vector<CellNode> nodes,
                     std::vector<double> volumes)
    : region_(region), nodes_(std::move(nodes)), leaf_volumes_(std::move(volumes)) {
    validate(region_);
    check_tree(nodes_, leaf_volumes_.size());
    cell_of_leaf_.resize(leaf_volumes_.size());
    std::iota(cell_of_leaf_.begin(), cell_of_leaf_.end(), CellId{0});
    sum_volumes();
}

ViewCells ViewCells::grid(const ViewRegion& region, const std::array<std::uint32_t, 3>& counts) {
    std::size_t cells = 1;
    for (const std::uint32_t count : counts) {
        // Each factor is below 2^24 + 1, so that no product overflows.
        cells *= count > kMaxLeaves || cells > kMaxLeaves ? 0 : count;
    }
    if (cells == 0 || cells > kMaxLeaves) {
        throw Error("view cells",
                    "a grid has no cells, or more than " + std::to_string(kMaxLeaves),
                    "choose other counts");
    }
    GridMaker maker(region, counts);
    maker.divide({{0, 0, 0}, counts});
    return {region,
            std::move(maker.nodes),
            std::vector<double>(cells, region.volume() / static_cast<double>(cells))};
}

ViewCells ViewCells::merged(std::vector<CellId> cell_of_leaf) const {
    std::vector<std::uint8_t> occurs(leaves(), 0);
    if (cell_of_leaf.size() != leaves()) {
        fail("there is not a cell per leaf");
    }
    for (const CellId cell : cell_of_leaf) {
        if (cell >= leaves()) {
            fail("a leaf's cell has too large a number");
        }
        occurs[cell] = 1;
    }
    if (!std::is_sorted(occurs.begin(), occurs.end(), std::greater<>())) {
        fail("the numbers of cells are not consecutive");
    }
    ViewCells result = *this;
    result.cell_of_leaf_ = std::move(cell_of_leaf);
    result.sum_volumes();
    return result;
}

void ViewCells::sum_volumes() {
    const CellId last = *std::max_element(cell_of_leaf_.begin(), cell_of_leaf_.end());
    volumes_.assign(std::size_t{last} + 1, 0.0);
    for (std::size_t leaf = 0; leaf < leaves(); ++leaf) {
        volumes_[cell_of_leaf_[leaf]] += leaf_volumes_[leaf];
    }
}

std::optional<LeafId> ViewCells::leaf_at(const Vec3& point) const noexcept {
    if (!region_.contains(point)) {
        return std::nullopt;
    }
    std::uint32_t child = nodes_.empty() ? kCellLeaf : 0;
    while ((child & kCellLeaf) == 0) {
        const CellNode& node = nodes_[child];
        child = height(node, point) < 0.0 ? node.back : node.front;
    }
    return child & ~kCellLeaf;
}

std::optional<CellId> ViewCells::cell_at(const Vec3& point) const noexcept {
    const std::optional<LeafId> leaf = leaf_at(point);
    return leaf ? std::optional(cell_of_leaf_[*leaf]) : std::nullopt;
}

void ViewCells::pierced(const Segment& segment, std::vector<CellId>& cells) const {
    cells.clear();
    if (const geometry::Interval inside = clip(segment, region_); !inside.is_empty()) {
        add_pierced(nodes_.empty() ? kCellLeaf : 0, segment, inside, cells);
    }
    std::sort(cells.begin(), cells.end());
    cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
}

void ViewCells::add_pierced(std::uint32_t child,
                            const Segment& segment,
                            const geometry::Interval& part,
                            std::vector<CellId>& cells) const {
    if ((child & kCellLeaf) != 0) {
        cells.push_back(cell_of_leaf_[child & ~kCellLeaf]);
        return;
    }
    const CellNode& node = nodes_[child];
    const double from = height(node, segment.from);
    const double to = height(node, segment.to);
    if ((from < 0.0) == (to < 0.0)) {
        add_pierced(from < 0.0 ? node.back : node.front, segment, part, cells);
        return;
    }
    const double crossing = from / (from - to);
    const auto [first, second] =
        from < 0.0 ? std::pair(node.back, node.front) : std::pair(node.front, node.back);
    if (crossing >= part.min) {
        add_pierced(first, segment, {part.min, std::min(crossing, part.max)}, cells);
    }
    if (crossing <= part.max) {
        add_pierced(second, segment, {std::max(crossing, part.min), part.max}, cells);
    }
}

}  // namespace earshot::visibility
