// SPDX-License-Identifier: MIT
#include "earshot/collision/discrete.h"

#include "earshot/collision/internal/box_pairs.h"
#include "earshot/collision/internal/neighbours.h"
#include "earshot/collision/internal/pair_search.h"
#include "earshot/collision/triangle_distance.h"

#include <algorithm>

namespace earshot::collision {
namespace {

bool is_empty(const Body& body) noexcept {
    return body.shape.nodes().empty();
}

BoxPairs trees_of(const Body& a, const Body& b, const RelativePose& pose) noexcept {
    return {a.shape.nodes(), b.shape.nodes(), pose};
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

}  // namespace

bool ContactSearch::add(geometry::TriangleId a, geometry::TriangleId b) {
    const Corners one = corners_of(a_, a);
    const Corners other = corners_of(b_, b);
    if (wanted_ == Wanted::all_of_one_mesh) {
        const auto& triangles = a_.shape.mesh().triangles;
        if (meet_beyond_shared(triangles[a], one, triangles[b], other)) {
            found.push_back(a < b ? TrianglePair{a, b} : TrianglePair{b, a});
        }
        return true;
    }
    if (meet(one, other)) {
        found.push_back({a, b});
    }
    return wanted_ == Wanted::all || found.empty();
}

void DistanceSearch::add(geometry::TriangleId a, geometry::TriangleId b) noexcept {
    const TriangleDistance here = distance_apart(corners_of(a_, a), corners_of(b_, b));
    const TrianglePair pair{a, b};
    if (here.distance < best.distance ||
        (here.distance == best.distance && pair < best.triangles)) {
        best = {here.distance, pair, here.on_one, here.on_other};
        // Triangles' distances may lie below the true ones by a rounding; the boxes' padding and
        // this factor are more.
        constexpr double kGrow = 1.0 + 0x1p-20;
        squared_bound_ = geometry::round_up(kGrow * here.distance * here.distance);
    }
}

bool intersects(const Body& a, const Body& b) {
    const RelativePose pose(a, b);
    if (is_empty(a) || is_empty(b)) {
        return false;
    }
    ContactSearch search(a, b, ContactSearch::Wanted::first);
    find_touching(trees_of(a, b, pose), {}, search);
    return !search.found.empty();
}

std::vector<TrianglePair> find_contacts(const Body& a, const Body& b, Executor& executor) {
    const RelativePose pose(a, b);
    if (is_empty(a) || is_empty(b)) {
        return {};
    }
    const BoxPairs trees = trees_of(a, b, pose);
    const std::vector<BoxPair> tasks = tasks_of(trees);
    return collect(tasks.size(), 8, executor, [&](std::size_t begin, std::size_t end) {
        ContactSearch search(a, b, ContactSearch::Wanted::all);
        for (std::size_t i = begin; i < end; ++i) {
            find_touching(trees, tasks[i], search);
        }
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
        return std::move(search.found);
    });
}

std::vector<geometry::Segment> contact_segments(const Body& a,
                                                const Body& b,
                                                std::span<const TrianglePair> pairs) {
    std::vector<geometry::Segment> segments;
    segments.reserve(pairs.size());
    for (const TrianglePair& pair : pairs) {
        segments.push_back(intersection(corners_of(a, pair.a), corners_of(b, pair.b))
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
