// SPDX-License-Identifier: MIT
#include "earshot/collision/discrete.h"

#include "earshot/collision/broad_phase/internal/box_pairs.h"
#include "earshot/collision/internal/instant_search.h"
#include "earshot/collision/narrow_phase/internal/leaf_pairs.h"

#include <algorithm>
#include <utility>

namespace earshot::collision {

namespace {

bool is_empty(const Body& body) noexcept {
    return body.shape.nodes().empty();
}

BoxPairs trees_of(const Body& a, const Body& b, const RelativePose& pose) noexcept {
    return {a.shape.nodes(), b.shape.nodes(), pose, a.shape.corners(), b.shape.corners()};
}

/// Runs search(begin, end) over items in chunks; what they find, sorted.
template <typename Search>
InstantContacts collect(std::size_t items, std::size_t grain, Executor& executor, Search&& search) {
    std::vector<InstantContacts> chunks(chunk_count(items, grain));
    executor.for_each(items, grain, [&](std::size_t begin, std::size_t end) {
        ContactSearch done = search(begin, end);
        chunks[begin / grain] = {std::move(done.found), done.statistics};
    });
    InstantContacts all;
    for (const InstantContacts& chunk : chunks) {
        all.pairs.insert(all.pairs.end(), chunk.pairs.begin(), chunk.pairs.end());
        all.statistics += chunk.statistics;
    }
    std::sort(all.pairs.begin(), all.pairs.end());
    return all;
}

void prefetch_triangle(const Body& body, geometry::TriangleId id) noexcept {
    __builtin_prefetch(&body.shape.mesh().triangles[id]);
}

/// Precondition: prefetch_triangle(), some time before.
void prefetch_corners(const Body& body, geometry::TriangleId id) noexcept {
    const geometry::MeshView& mesh = body.shape.mesh();
    for (const geometry::VertexId vertex : mesh.triangles[id]) {
        __builtin_prefetch(&mesh.positions[vertex]);
    }
}

/// Pairs of boxes below which all contacts are found, enough of them to balance the threads.
std::vector<BoxPair> tasks_of(const BoxPairs& trees, std::uint64_t& box_tests) {
    constexpr std::size_t kMinTasks = 128;
    constexpr int kMaxRounds = 8;
    std::vector<BoxPair> tasks{{0, 0}};
    for (int round = 0; round < kMaxRounds && tasks.size() < kMinTasks; ++round) {
        std::vector<BoxPair> smaller;
        for (const BoxPair& task : tasks) {
            const auto children = expand_overlapping(trees, task, box_tests);
            smaller.insert(smaller.end(), children.begin(), children.end());
        }
        tasks = std::move(smaller);
    }
    return tasks;
}

}  // namespace

bool intersects(const Body& a, const Body& b) {
    const RelativePose pose(a, b);
    if (is_empty(a) || is_empty(b)) {
        return false;
    }
    ContactSearch search(a, b, ContactSearch::Query::first);
    traverse_overlapping(trees_of(a, b, pose), {0, 0}, search);
    return !search.found.empty();
}

InstantContacts search_contacts(const Body& a, const Body& b, Executor& executor) {
    const RelativePose pose(a, b);
    if (is_empty(a) || is_empty(b)) {
        return {};
    }
    const BoxPairs trees = trees_of(a, b, pose);
    // Sorted in the end, contacts are the same however the search is split, and so are the tests.
    std::uint64_t box_tests = 0;
    const auto tasks =
        executor.threads() > 1 ? tasks_of(trees, box_tests) : std::vector<BoxPair>{{0, 0}};
    InstantContacts contacts =
        collect(tasks.size(), 8, executor, [&](std::size_t begin, std::size_t end) {
            ContactSearch search(a, b, ContactSearch::Query::all);
            for (std::size_t i = begin; i < end; ++i) {
                traverse_overlapping(trees, tasks[i], search);
            }
            search.decide();
            return search;
        });
    contacts.statistics.box_tests += box_tests;
    return contacts;
}

std::vector<TrianglePair> find_contacts(const Body& a, const Body& b, Executor& executor) {
    return search_contacts(a, b, executor).pairs;
}

InstantContacts search_self_contacts(const Body& body, Executor& executor) {
    const RelativePose pose(body, body);
    const BoxPairs trees = trees_of(body, body, pose);
    return collect(trees.a.size(), 256, executor, [&](std::size_t begin, std::size_t end) {
        ContactSearch search(body, body, ContactSearch::Query::all_of_one_mesh);
        for (std::size_t i = begin; i < end; ++i) {
            traverse_self(trees, static_cast<std::uint32_t>(i), search);
        }
        search.decide();
        return search;
    });
}

std::vector<TrianglePair> find_self_contacts(const Body& body, Executor& executor) {
    return search_self_contacts(body, executor).pairs;
}

std::vector<geometry::Segment> contact_segments(const Body& a,
                                                const Body& b,
                                                std::span<const TrianglePair> pairs) {
    std::vector<geometry::Segment> segments;
    segments.reserve(pairs.size());
    // The corners of consecutive pairs are far apart in memory, hence prefetched.
    constexpr std::size_t kAhead = 8;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        if (i + 2 * kAhead < pairs.size()) {
            prefetch_triangle(a, pairs[i + 2 * kAhead].a);
            prefetch_triangle(b, pairs[i + 2 * kAhead].b);
        }
        if (i + kAhead < pairs.size()) {
            prefetch_corners(a, pairs[i + kAhead].a);
            prefetch_corners(b, pairs[i + kAhead].b);
        }
        segments.push_back(intersection(corners_of(a, pairs[i].a), corners_of(b, pairs[i].b))
                               .value_or(geometry::Segment{}));
    }
    return segments;
}

InstantDistance search_distance(const Body& a, const Body& b) {
    const RelativePose pose(a, b);
    if (is_empty(a) || is_empty(b)) {
        return {};
    }
    const BoxPairs trees = trees_of(a, b, pose);
    ContactSearch contact(a, b, ContactSearch::Query::first);
    traverse_overlapping(trees, {0, 0}, contact);
    if (!contact.found.empty()) {
        return {{.distance = 0.0}, contact.statistics};
    }
    DistanceSearch search(a, b);
    traverse_closest(trees, search);
    search.statistics += contact.statistics;
    return {search.best, search.statistics};
}

MeshDistance distance(const Body& a, const Body& b) {
    return search_distance(a, b).distance;
}

}  // namespace earshot::collision
