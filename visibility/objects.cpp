// SPDX-License-Identifier: MIT
#include "earshot/visibility/objects.h"

#include "earshot/base/assert.h"
#include "earshot/base/error.h"
#include "earshot/bvh/deformable_bvh.h"

#include <algorithm>
#include <numeric>

namespace earshot::visibility {

using geometry::TriangleId;

Objects Objects::triangles(std::size_t count) {
    std::vector<ObjectId> each(count);
    std::iota(each.begin(), each.end(), ObjectId{0});
    return Objects(std::move(each));
}

Objects Objects::groups(const geometry::MeshView& mesh,
                        std::size_t max_triangles,
                        Executor& executor) {
    EARSHOT_ASSERT(max_triangles > 0);
    const bvh::BuildOptions options = {
        .max_leaf_size = static_cast<int>(std::min<std::size_t>(max_triangles, 4))};
    const bvh::DeformableBvh hierarchy(
        bvh::triangle_boxes(mesh, executor), {.build = options}, executor);
    const bvh::Tree& tree = hierarchy.binary_tree();
    std::vector<ObjectId> object_of_triangle(mesh.triangles.size(), 0);
    if (tree.nodes().empty()) {
        return Objects({});
    }
    // The primitives of a subtree are consecutive. Children have higher indices than their parents.
    struct Range {
        std::size_t begin, count;
    };
    std::vector<Range> below(tree.nodes().size());
    for (std::size_t i = tree.nodes().size(); i-- > 0;) {
        const bvh::Node& node = tree.nodes()[i];
        below[i] = node.is_leaf() ? Range{node.first, node.count}
                                  : Range{below[node.first].begin,
                                          below[node.first].count + below[node.first + 1].count};
    }
    ObjectId objects = 0;
    std::vector<std::uint32_t> stack = {0};
    while (!stack.empty()) {
        const bvh::Node& node = tree.nodes()[stack.back()];
        const Range range = below[stack.back()];
        stack.pop_back();
        if (range.count > max_triangles && !node.is_leaf()) {
            stack.push_back(node.first + 1);
            stack.push_back(node.first);
            continue;
        }
        for (const std::uint32_t primitive : tree.primitives().subspan(range.begin, range.count)) {
            object_of_triangle[primitive] = objects;
        }
        ++objects;
    }
    return Objects(std::move(object_of_triangle));
}

Objects::Objects(std::vector<ObjectId> object_of_triangle)
    : object_of_triangle_(std::move(object_of_triangle)) {
    const std::size_t triangles = object_of_triangle_.size();
    first_.assign(2, 0);
    for (const ObjectId object : object_of_triangle_) {
        if (object >= triangles) {
            throw Error("objects", "there are fewer triangles than objects", "group them again");
        }
        if (first_.size() < std::size_t{object} + 2) {
            first_.resize(std::size_t{object} + 2, 0);
        }
        ++first_[object + 1];
    }
    if (std::find(first_.begin() + 1, first_.end(), 0U) != first_.end() && triangles > 0) {
        throw Error("objects", "an object has no triangles", "group them again");
    }
    first_.resize(triangles > 0 ? first_.size() : 1);
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    members_.resize(triangles);
    std::vector<std::size_t> next(first_.begin(), first_.end());
    for (std::size_t i = 0; i < triangles; ++i) {
        members_[next[object_of_triangle_[i]]++] = static_cast<TriangleId>(i);
    }
}

}  // namespace earshot::visibility
