// SPDX-License-Identifier: MIT
#include "earshot/bvh/internal/reinserter.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace earshot::bvh {

using geometry::Aabb;

namespace {

constexpr std::uint32_t kRoot = 0;

Aabb united(Aabb a, const Aabb& b) noexcept {
    a.include(b);
    return a;
}

}  // namespace

Reinserter::Reinserter(std::span<const Node> nodes)
    : nodes_(nodes.begin(), nodes.end()), parents_(nodes.size(), kRoot) {
    for (std::uint32_t i = 0; i < nodes_.size(); ++i) {
        adopt(i);
    }
}

/// Tells the children of a node where it stands.
void Reinserter::adopt(std::uint32_t index) {
    if (!nodes_[index].is_leaf()) {
        parents_[nodes_[index].first] = index;
        parents_[nodes_[index].first + 1] = index;
    }
}

// Bittner, Hapala and Havran 2013, section 3.3: nodes that are large themselves, larger than their
// content, and much larger than the smaller part of it; here a node is judged by its parent, which
// its removal shrinks.
std::vector<std::uint32_t> Reinserter::worst(std::size_t count, Executor& executor) const {
    struct Ranked {
        double badness;
        std::uint32_t index;
    };
    std::vector<Ranked> all(nodes_.size());
    constexpr std::size_t kGrain = 16384;
    executor.for_each(nodes_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const auto index = static_cast<std::uint32_t>(i);
            all[i] = {index == kRoot || parents_[i] == kRoot ? -1.0 : area(index), index};
        }
    });
    count = std::min(count, all.size());
    const auto is_worse = [](const Ranked& a, const Ranked& b) {
        return a.badness != b.badness ? a.badness > b.badness : a.index < b.index;
    };
    const auto end = all.begin() + static_cast<std::ptrdiff_t>(count);
    std::nth_element(all.begin(), end, all.end(), is_worse);
    std::vector<std::uint32_t> result;
    for (auto ranked = all.begin(); ranked != end; ++ranked) {
        if (ranked->badness > 0.0) {
            result.push_back(ranked->index);
        }
    }
    std::sort(result.begin(), result.end());
    return result;
}

// Meister and Bittner 2018, section 4.1: from the node upwards, and at every ancestor down into the
// other side. `gain` is what removal saves less what the ancestors of a place grow.
Reinserter::Move Reinserter::best_move(std::uint32_t from) const {
    const double own_area = area(from);
    const Aabb& box = nodes_[from].box;
    const std::uint32_t parent = parents_[from];
    Move best = {from, kRoot, 0.0};
    struct Open {
        double gain;
        std::uint32_t node;
    };
    std::vector<Open> open;
    std::uint32_t pivot = parent;
    std::uint32_t side = sibling(from);
    Aabb rest = nodes_[side].box;  // of the pivot without the node
    double gain = area(parent);
    while (true) {
        open.push_back({gain, side});
        while (!open.empty()) {
            const Open place = open.back();
            open.pop_back();
            if (!(place.gain - own_area > best.gain)) {
                continue;
            }
            const Node& node = nodes_[place.node];
            const double here = place.gain - united(node.box, box).half_area();
            if (here > best.gain) {
                best.to = place.node;
                best.gain = here;
            }
            if (!node.is_leaf()) {
                const double below = here + node.box.half_area();
                open.push_back({below, node.first});
                open.push_back({below, node.first + 1});
            }
        }
        if (pivot != parent) {
            rest.include(nodes_[side].box);
            gain += area(pivot) - rest.half_area();
            // Beside the ancestor itself, whose old box the two then fill again.
            const double here = gain - united(rest, box).half_area();
            if (pivot != kRoot && here > best.gain) {
                best.to = pivot;
                best.gain = here;
            }
        }
        if (pivot == kRoot) {
            break;
        }
        side = sibling(pivot);
        pivot = parents_[pivot];
    }
    const bool stays = best.to == kRoot || best.to == sibling(from) || best.to == parent;
    return stays ? Move{from, kRoot, 0.0} : best;
}

/// Takes a node out, so that its sibling takes their parent's place, and puts it beside another in
/// the pair of places that became free. False if an earlier move has touched one of these.
bool Reinserter::make(const Move& move) {
    const std::uint32_t parent = parents_[move.from];
    const std::uint32_t beside = sibling(move.from);
    const std::array<std::uint32_t, 5> touched = {
        move.to, parents_[move.to], move.from, beside, parent};
    if (std::any_of(touched.begin(), touched.end(), [&](auto i) { return is_touched_[i] != 0; }) ||
        is_touched_[parents_[parent]] != 0) {
        return false;
    }
    for (const std::uint32_t index : touched) {
        is_touched_[index] = 1;
    }
    is_touched_[parents_[parent]] = 1;
    const Node moved = nodes_[move.from];
    nodes_[parent] = nodes_[beside];
    adopt(parent);
    // The place beside which the node goes may be the sibling, now in its parent's place: best_move
    // has left that out.
    nodes_[beside] = nodes_[move.to];
    adopt(beside);
    nodes_[move.from] = moved;
    nodes_[move.to] = {.box = united(nodes_[beside].box, moved.box),
                       .first = std::min(move.from, beside)};
    adopt(move.to);
    refit_from(parents_[parent]);
    refit_from(parents_[move.to]);
    return true;
}

void Reinserter::refit_from(std::uint32_t index) {
    while (true) {
        Node& node = nodes_[index];
        if (!node.is_leaf()) {
            const Aabb box = united(nodes_[node.first].box, nodes_[node.first + 1].box);
            if (box == node.box) {
                return;
            }
            node.box = box;
        }
        if (index == kRoot) {
            return;
        }
        index = parents_[index];
    }
}

std::size_t Reinserter::improve(std::size_t count, Executor& executor) {
    if (nodes_.size() < 5) {
        return 0;
    }
    const std::vector<std::uint32_t> candidates = worst(count, executor);
    std::vector<Move> moves(candidates.size());
    constexpr std::size_t kGrain = 256;
    executor.for_each(moves.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            moves[i] = best_move(candidates[i]);
        }
    });
    std::erase_if(moves, [](const Move& move) { return move.to == kRoot; });
    std::sort(moves.begin(), moves.end(), [](const Move& a, const Move& b) {
        return a.gain != b.gain ? a.gain > b.gain : a.from < b.from;
    });
    is_touched_.assign(nodes_.size(), 0);
    std::size_t made = 0;
    for (const Move& move : moves) {
        made += make(move) ? 1 : 0;
    }
    return made;
}

double Reinserter::inner_area() const noexcept {
    double sum = 0.0;
    for (const Node& node : nodes_) {
        sum += node.is_leaf() ? 0.0 : node.box.half_area();
    }
    return sum;
}

std::vector<Node> Reinserter::ordered() const {
    struct Open {
        std::uint32_t source, target;
        std::size_t depth;
    };
    std::vector<Node> result;
    result.reserve(nodes_.size());
    result.push_back(nodes_[kRoot]);
    std::vector<Open> open = {{kRoot, 0, 0}};
    while (!open.empty()) {
        const Open place = open.back();
        open.pop_back();
        if (place.depth > kMaxDepth) {
            return {};
        }
        const Node& node = nodes_[place.source];
        if (node.is_leaf()) {
            continue;
        }
        const auto left = static_cast<std::uint32_t>(result.size());
        result[place.target].first = left;
        result.push_back(nodes_[node.first]);
        result.push_back(nodes_[node.first + 1]);
        open.push_back({node.first + 1, left + 1, place.depth + 1});
        open.push_back({node.first, left, place.depth + 1});
    }
    return result;
}

}  // namespace earshot::bvh
