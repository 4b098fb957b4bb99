// SPDX-License-Identifier: MIT
#include "earshot/bvh/all_hits.h"

#include "earshot/bvh/better_hit.h"
#include "earshot/bvh/ray.h"

#include <algorithm>

namespace earshot::bvh {

using geometry::Hit;
using geometry::PreparedRay;
using geometry::TriangleId;

namespace {

bool worse_hit(const Hit& a, const Hit& b) noexcept {
    return better_hit(b, a);
}

std::optional<Hit> hit_of(const PreparedRay& ray, const geometry::MeshView& mesh, TriangleId id) {
    const auto [a, b, c] = geometry::corners(mesh, id);
    auto hit = ray.hit(a, b, c, ray.t_max());
    if (hit) {
        hit->triangle = id;
    }
    return hit;
}

}  // namespace

OrderedHits::OrderedHits(const Tree& tree, const geometry::MeshView& mesh, const geometry::Ray& ray)
    : tree_(tree), mesh_(mesh), ray_(ray, max_abs_coordinate(tree)) {
    if (!tree.nodes().empty() && ray_.is_valid()) {
        push_node(0);
    }
}

std::optional<Hit> OrderedHits::next() {
    // A node that begins at the distance of a hit may hold another of lower index.
    while (!nodes_.empty() && (hits_.empty() || nodes_.front().t_near <= hits_.front().t)) {
        const std::uint32_t node = nodes_.front().node;
        std::pop_heap(nodes_.begin(), nodes_.end(), is_farther);
        nodes_.pop_back();
        expand(node);
    }
    if (hits_.empty()) {
        return std::nullopt;
    }
    std::pop_heap(hits_.begin(), hits_.end(), worse_hit);
    const Hit best = hits_.back();
    hits_.pop_back();
    return best;
}

void OrderedHits::push_node(std::uint32_t node) {
    const auto interval = ray_.box_interval(tree_.nodes()[node].box, ray_.t_max());
    if (interval.is_empty()) {
        return;
    }
    nodes_.push_back({node, interval.min});
    std::push_heap(nodes_.begin(), nodes_.end(), is_farther);
}

void OrderedHits::expand(std::uint32_t index) {
    const Node& node = tree_.nodes()[index];
    if (!node.is_leaf()) {
        push_node(node.first);
        push_node(node.first + 1);
        return;
    }
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
        if (const auto hit = hit_of(ray_, mesh_, tree_.primitives()[i])) {
            hits_.push_back(*hit);
            std::push_heap(hits_.begin(), hits_.end(), worse_hit);
        }
    }
}

std::vector<Hit> all_hits(const Tree& tree,
                          const geometry::MeshView& mesh,
                          const geometry::Ray& ray) {
    const PreparedRay prepared(ray, max_abs_coordinate(tree));
    std::vector<Hit> hits;
    if (!prepared.is_valid()) {
        return hits;
    }
    traverse(
        tree,
        [&](const Node& node) {
            return !prepared.box_interval(node.box, prepared.t_max()).is_empty();
        },
        [&](TriangleId id) {
            if (const auto hit = hit_of(prepared, mesh, id)) {
                hits.push_back(*hit);
            }
            return true;
        });
    std::sort(hits.begin(), hits.end(), better_hit<Hit>);
    return hits;
}

}  // namespace earshot::bvh
