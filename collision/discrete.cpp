// SPDX-License-Identifier: MIT
#include "earshot/collision/discrete.h"

#include "earshot/collision/broad_phase/internal/box_pairs.h"
#include "earshot/collision/narrow_phase/internal/leaf_pairs.h"
#include "earshot/collision/narrow_phase/internal/neighbours.h"
#include "earshot/collision/narrow_phase/internal/triangle_lanes.h"
#include "earshot/collision/narrow_phase/triangle_distance.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <limits>
#include <utility>

namespace earshot::collision {

using geometry::Vec3;

namespace {

bool is_empty(const Body& body) noexcept {
    return body.shape.nodes().empty();
}

BoxPairs trees_of(const Body& a, const Body& b, const RelativePose& pose) noexcept {
    return {a.shape.nodes(), b.shape.nodes(), pose, a.shape.corners(), b.shape.corners()};
}

/// Runs search(item, found) over items in chunks; what they find, sorted.
template <typename Search>
std::vector<TrianglePair> collect(std::size_t items,
                                  std::size_t grain,
                                  Executor& executor,
                                  Search&& search) {
    std::vector<std::vector<TrianglePair>> chunks(chunk_count(items, grain));
    executor.for_each(items, grain, [&](std::size_t begin, std::size_t end) {
        chunks[begin / grain] = search(begin, end);
    });
    std::vector<TrianglePair> found;
    for (const auto& chunk : chunks) {
        found.insert(found.end(), chunk.begin(), chunk.end());
    }
    std::sort(found.begin(), found.end());
    return found;
}

void fetch_triangle(const Body& body, geometry::TriangleId id) noexcept {
    __builtin_prefetch(&body.shape.mesh().triangles[id]);
}

/// Precondition: fetch_triangle(), and time for it.
void fetch_corners(const Body& body, geometry::TriangleId id) noexcept {
    const geometry::MeshView& mesh = body.shape.mesh();
    for (const geometry::VertexId vertex : mesh.triangles[id]) {
        __builtin_prefetch(&mesh.positions[vertex]);
    }
}

/// Pairs of boxes that between them hold all contacts, enough for every thread to have some.
std::vector<BoxPair> tasks_of(const BoxPairs& trees) {
    constexpr std::size_t kEnough = 128;
    constexpr int kRounds = 8;
    std::vector<BoxPair> tasks{{0, 0}};
    for (int round = 0; round < kRounds && tasks.size() < kEnough; ++round) {
        std::vector<BoxPair> smaller;
        for (const BoxPair& task : tasks) {
            const auto children = open_touching(trees, task);
            smaller.insert(smaller.end(), children.begin(), children.end());
        }
        tasks = std::move(smaller);
    }
    return tasks;
}

/// Of length 1 within a rounding, or 0.
Vec3 unit(const Vec3& v) noexcept {
    const double length = glm::length(v);
    return length > 0.0 ? v / length : Vec3(0.0);
}

Vec3 direction_between(const Corners& one, const Corners& other) noexcept {
    return unit(((other[0] - one[0]) + (other[1] - one[1])) + (other[2] - one[2]));
}

/// Whether planes across a direction keep triangles more than a distance apart, and
/// distance_of_disjoint() would say so.
bool are_parted(const Corners& one,
                const Corners& other,
                const Vec3& direction,
                double distance) noexcept {
    double most = 0.0;
    double least = std::numeric_limits<double>::infinity();
    double size = 0.0;
    for (std::size_t i = 0; i < 3; ++i) {
        const Vec3 own = one[i] - one[0];
        const Vec3 apart = other[i] - one[0];
        most = std::max(most, glm::dot(direction, own));
        least = std::min(least, glm::dot(direction, apart));
        size = std::max({size, glm::dot(own, own), glm::dot(apart, apart)});
    }
    // The gap is off by less than 2^-50 of the size, distances by less than 2^-42.
    constexpr double kRounding = 0x1p-40;
    const double gap = least - most;
    return gap > distance && (gap - distance) * (gap - distance) > kRounding * kRounding * size;
}

}  // namespace

bool ContactSearch::meets(const LeafPair& leaves) {
    const Corners& one = a_.corners(leaves[0]);
    const Corners& other = b_.corners(leaves[1]);
    return wanted_ == Wanted::all_of_one_mesh
               ? intersect_beyond_shared_features(triangles_[a_.triangle(leaves[0])],
                                                  one,
                                                  triangles_[b_.triangle(leaves[1])],
                                                  other)
               : intersect(one, other);
}

void ContactSearch::decide_lanes_of(std::span<const LeafPair> pairs) {
    TriangleLanes lanes;
    for (std::size_t i = 0; i < TriangleLanes::kWidth; ++i) {
        const LeafPair& pair = pairs[std::min(i, pairs.size() - 1)];
        lanes.set(i, a_.own_corners(pair[0]), b_.own_corners(pair[1]));
    }
    const LanesDecided decided = decide_lanes(lanes, a_.pose(), b_.pose());
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        if ((decided.apart >> i & 1U) == 0 &&
            ((decided.meeting >> i & 1U) != 0 || meets(pairs[i]))) {
            found.push_back({a_.triangle(pairs[i][0]), b_.triangle(pairs[i][1])});
        }
    }
}

void ContactSearch::decide() {
    const std::span<const LeafPair> pairs(waiting_.data(), count_);
    count_ = 0;
    if (wanted_ == Wanted::all) {
        for (std::size_t i = 0; i < pairs.size(); i += TriangleLanes::kWidth) {
            decide_lanes_of(pairs.subspan(i, std::min(TriangleLanes::kWidth, pairs.size() - i)));
        }
        return;
    }
    for (const LeafPair& pair : pairs) {
        if (meets(pair)) {
            const geometry::TriangleId a = a_.triangle(pair[0]);
            const geometry::TriangleId b = b_.triangle(pair[1]);
            const bool is_in_order = wanted_ == Wanted::first || a < b;
            found.push_back(is_in_order ? TrianglePair{a, b} : TrianglePair{b, a});
        }
    }
}

void DistanceSearch::add(std::uint32_t a, std::uint32_t b) noexcept {
    const Corners& one = a_.corners(a);
    const Corners& other = b_.corners(b);
    // Near the best pair most others are parted by more than its distance in its direction, and
    // elsewhere in that from one to the other.
    if (are_parted(one, other, direction_, best.distance) ||
        are_parted(one, other, direction_between(one, other), best.distance)) {
        return;
    }
    const TriangleDistance here = distance_of_disjoint(one, other);
    const TrianglePair pair{a_.triangle(a), b_.triangle(b)};
    if (here.distance < best.distance ||
        (here.distance == best.distance && pair < best.triangles)) {
        best = {here.distance, pair, here.on_one, here.on_other};
        // Triangles' distances may lie below the true ones by a rounding; the boxes' padding and
        // this factor are more. The summand stands for squares that underflow.
        constexpr double kGrow = 1.0 + 0x1p-20;
        squared_bound_ = geometry::round_up(kGrow * here.distance * here.distance + 0x1p-120);
        direction_ = unit(here.on_other - here.on_one);
    }
}

bool intersects(const Body& a, const Body& b) {
    const RelativePose pose(a, b);
    if (is_empty(a) || is_empty(b)) {
        return false;
    }
    ContactSearch search(a, b, ContactSearch::Wanted::first);
    find_touching(trees_of(a, b, pose), {0, 0}, search);
    return !search.found.empty();
}

std::vector<TrianglePair> find_contacts(const Body& a, const Body& b, Executor& executor) {
    const RelativePose pose(a, b);
    if (is_empty(a) || is_empty(b)) {
        return {};
    }
    const BoxPairs trees = trees_of(a, b, pose);
    // Sorted in the end, contacts are the same however the search is split.
    const auto tasks = executor.threads() > 1 ? tasks_of(trees) : std::vector<BoxPair>{{0, 0}};
    return collect(tasks.size(), 8, executor, [&](std::size_t begin, std::size_t end) {
        ContactSearch search(a, b, ContactSearch::Wanted::all);
        for (std::size_t i = begin; i < end; ++i) {
            find_touching(trees, tasks[i], search);
        }
        search.decide();
        return std::move(search.found);
    });
}

std::vector<TrianglePair> find_self_contacts(const Body& body, Executor& executor) {
    const RelativePose pose(body, body);
    const BoxPairs trees = trees_of(body, body, pose);
    return collect(trees.a.size(), 256, executor, [&](std::size_t begin, std::size_t end) {
        ContactSearch search(body, body, ContactSearch::Wanted::all_of_one_mesh);
        for (std::size_t i = begin; i < end; ++i) {
            find_touching_within(trees, static_cast<std::uint32_t>(i), search);
        }
        search.decide();
        return std::move(search.found);
    });
}

std::vector<geometry::Segment> contact_segments(const Body& a,
                                                const Body& b,
                                                std::span<const TrianglePair> pairs) {
    std::vector<geometry::Segment> segments;
    segments.reserve(pairs.size());
    // Each pair's corners are far from those of the last, and asked for in time.
    constexpr std::size_t kAhead = 8;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        if (i + 2 * kAhead < pairs.size()) {
            fetch_triangle(a, pairs[i + 2 * kAhead].a);
            fetch_triangle(b, pairs[i + 2 * kAhead].b);
        }
        if (i + kAhead < pairs.size()) {
            fetch_corners(a, pairs[i + kAhead].a);
            fetch_corners(b, pairs[i + kAhead].b);
        }
        segments.push_back(intersection(corners_of(a, pairs[i].a), corners_of(b, pairs[i].b))
                               .value_or(geometry::Segment{}));
    }
    return segments;
}

MeshDistance distance(const Body& a, const Body& b) {
    if (intersects(a, b)) {
        return {.distance = 0.0};
    }
    if (is_empty(a) || is_empty(b)) {
        return {};
    }
    const RelativePose pose(a, b);
    DistanceSearch search(a, b);
    find_nearest(trees_of(a, b, pose), search);
    return search.best;
}

}  // namespace earshot::collision
