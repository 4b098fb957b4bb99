// SPDX-License-Identifier: MIT
#include "earshot/geometry/clean.h"

#include "earshot/base/assert.h"
#include "earshot/geometry/internal/close_points.h"
#include "earshot/geometry/internal/edge_counts.h"
#include "earshot/geometry/internal/first_index_table.h"
#include "earshot/geometry/internal/near_duplicates.h"
#include "earshot/geometry/predicates.h"
#include "earshot/geometry/tolerance.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <iterator>
#include <numeric>
#include <span>
#include <utility>

namespace earshot::geometry {
namespace {

constexpr std::size_t kGrain = 4096;

std::uint64_t hash_of(const Vec3& position) noexcept {
    std::uint64_t hash = 0;
    for (int axis = 0; axis < 3; ++axis) {
        hash = mixed_hash(hash, std::bit_cast<std::uint64_t>(position[axis] + 0.0));  // -0 is 0
    }
    return hash;
}

std::vector<VertexId> weld_equal_positions(std::span<const Vec3> positions) {
    FirstIndexTable table(positions.size());
    std::vector<VertexId> weld(positions.size());
    for (std::size_t v = 0; v < weld.size(); ++v) {
        const auto equals = [&](VertexId other) { return positions[other] == positions[v]; };
        weld[v] = table.add(hash_of(positions[v]), static_cast<VertexId>(v), equals);
    }
    return weld;
}

Triangle welded(const Triangle& triangle, std::span<const VertexId> weld) noexcept {
    return {weld[triangle[0]], weld[triangle[1]], weld[triangle[2]]};
}

/// Exactly: the components of the normal are the areas of the three projections.
bool has_zero_area(const Vec3& a, const Vec3& b, const Vec3& c) noexcept {
    return orient2d({a.x, a.y}, {b.x, b.y}, {c.x, c.y}) == 0 &&
           orient2d({a.y, a.z}, {b.y, b.z}, {c.y, c.z}) == 0 &&
           orient2d({a.z, a.x}, {b.z, b.x}, {c.z, c.x}) == 0;
}

bool is_degenerate(const Triangle& triangle, std::span<const Vec3> positions) noexcept {
    const auto [a, b, c] = triangle;
    return a == b || b == c || c == a || has_zero_area(positions[a], positions[b], positions[c]);
}

/// The triangles of `candidates` (ascending) that repeat no earlier one with the same vertices.
std::vector<TriangleId> without_duplicates(const MeshView& mesh,
                                           std::span<const VertexId> weld,
                                           std::span<const TriangleId> candidates,
                                           std::vector<DuplicateTriangle>& duplicates) {
    const auto key_of = [&](TriangleId id) {
        Triangle key = welded(mesh.triangles[id], weld);
        std::sort(key.begin(), key.end());
        return key;
    };
    FirstIndexTable table(candidates.size());
    std::vector<TriangleId> kept;
    kept.reserve(candidates.size());
    for (const TriangleId id : candidates) {
        const Triangle key = key_of(id);
        const std::uint64_t hash = mixed_hash(mixed_hash(mixed_hash(0, key[0]), key[1]), key[2]);
        const TriangleId first =
            table.add(hash, id, [&](TriangleId other) { return key_of(other) == key; });
        if (first == id) {
            kept.push_back(id);
        } else {
            duplicates.push_back({id, first});
        }
    }
    return kept;
}

/// Per vertex 1 if it is welded to others as one corner of the triangles.
std::vector<std::uint8_t> mark_corners(const MeshView& mesh,
                                       std::span<const VertexId> weld,
                                       std::span<const TriangleId> triangles) {
    std::vector<std::uint8_t> marks(mesh.positions.size(), 0);
    for (const TriangleId id : triangles) {
        for (const VertexId vertex : mesh.triangles[id]) {
            marks[weld[vertex]] = 1;
        }
    }
    return marks;
}

/// The near duplicates among triangles of which no two have the same vertices: of each pair both
/// have a corner that is close to another vertex, the other's.
std::vector<std::pair<TriangleId, TriangleId>> near_duplicates_beside(
    const MeshView& mesh,
    std::span<const VertexId> weld,
    std::span<const std::uint8_t> is_close,
    std::span<const TriangleId> triangles,
    double tolerance) {
    std::vector<TriangleId> candidates;
    std::copy_if(
        triangles.begin(), triangles.end(), std::back_inserter(candidates), [&](TriangleId id) {
            const auto [a, b, c] = welded(mesh.triangles[id], weld);
            return is_close[a] != 0 || is_close[b] != 0 || is_close[c] != 0;
        });
    return find_near_duplicates(mesh, candidates, tolerance);
}

/// Removes from `kept` (ascending) what repeats an earlier triangle within the tolerance.
void remove_near_duplicates(std::span<const std::pair<TriangleId, TriangleId>> pairs,
                            std::size_t triangle_count,
                            CleanMesh& mesh) {
    std::vector<TriangleId> repeated(triangle_count);  // itself, or the one that it repeats
    std::iota(repeated.begin(), repeated.end(), TriangleId{0});
    for (const auto& [later, earlier] : pairs) {
        if (repeated[later] == later && repeated[earlier] == earlier) {
            repeated[later] = earlier;
        }
    }
    for (DuplicateTriangle& exact : mesh.duplicates) {
        exact.kept = repeated[exact.kept];
    }
    for (const TriangleId id : mesh.kept) {
        if (repeated[id] != id) {
            mesh.duplicates.push_back({id, repeated[id]});
        }
    }
    std::erase_if(mesh.kept, [&](TriangleId id) { return repeated[id] != id; });
    std::sort(mesh.duplicates.begin(), mesh.duplicates.end(), [](const auto& a, const auto& b) {
        return a.duplicate < b.duplicate;
    });
}

}  // namespace

CleanMesh clean(const MeshView& mesh, Executor& executor) {
    CleanMeshCache cache;
    cache.update(mesh, executor);
    CleanMesh result = cache.clean();
    result.report = cache.report(mesh, executor);
    return result;
}

void CleanMeshCache::clean_afresh(const MeshView& mesh, Executor& executor) {
    clean_ = {};
    clean_.weld = weld_equal_positions(mesh.positions);
    has_area_.resize(mesh.triangles.size());
    executor.for_each(has_area_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t t = begin; t < end; ++t) {
            has_area_[t] = is_degenerate(welded(mesh.triangles[t], clean_.weld), mesh.positions)
                               ? std::uint8_t{0}
                               : std::uint8_t{1};
        }
    });
    std::vector<TriangleId> with_area;
    with_area.reserve(has_area_.size());
    for (std::size_t t = 0; t < has_area_.size(); ++t) {
        if (has_area_[t] != 0) {
            with_area.push_back(static_cast<TriangleId>(t));
        }
    }
    clean_.kept = without_duplicates(mesh, clean_.weld, with_area, clean_.duplicates);
    is_corner_ = mark_corners(mesh, clean_.weld, clean_.kept);
    const double tolerance = coplanar_tolerance(mesh);
    const auto pairs =
        near_duplicates_beside(mesh,
                               clean_.weld,
                               mark_close_points(mesh.positions, is_corner_, tolerance),
                               clean_.kept,
                               tolerance);
    has_near_duplicates_ = !pairs.empty();
    if (has_near_duplicates_) {
        remove_near_duplicates(pairs, mesh.triangles.size(), clean_);
    }
}

// Vertices that were welded must still coincide, others must not; what had an area must have one
// still. Then the exact duplicates are the same. Near ones are looked for only where other vertices
// have come close.
bool CleanMeshCache::holds_for(const MeshView& mesh, Executor& executor) const {
    if (mesh.triangles.size() != has_area_.size() || mesh.positions.size() != is_corner_.size()) {
        return false;
    }
    std::atomic<bool> holds = true;
    executor.for_each(mesh.positions.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t v = begin; v < end; ++v) {
            if (mesh.positions[v] != mesh.positions[clean_.weld[v]]) {
                holds = false;
            }
        }
    });
    executor.for_each(has_area_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t t = begin; t < end; ++t) {
            const Triangle triangle = welded(mesh.triangles[t], clean_.weld);
            if (is_degenerate(triangle, mesh.positions) != (has_area_[t] == 0)) {
                holds = false;
            }
        }
    });
    if (!holds) {
        return false;
    }
    const double tolerance = coplanar_tolerance(mesh);
    const std::vector<std::uint8_t> is_close =
        mark_close_points(mesh.positions, is_corner_, tolerance);
    if (std::none_of(is_close.begin(), is_close.end(), [](std::uint8_t is) { return is != 0; })) {
        return !has_near_duplicates_;
    }
    FirstIndexTable table(mesh.positions.size());
    for (std::size_t v = 0; v < is_close.size(); ++v) {
        const auto equals = [&](VertexId other) {
            return mesh.positions[other] == mesh.positions[v];
        };
        const auto vertex = static_cast<VertexId>(v);
        if (is_close[v] != 0 && table.add(hash_of(mesh.positions[v]), vertex, equals) != vertex) {
            return false;
        }
    }
    return !has_near_duplicates_ &&
           near_duplicates_beside(mesh, clean_.weld, is_close, clean_.kept, tolerance).empty();
}

bool CleanMeshCache::update(const MeshView& mesh, Executor& executor) {
    if (holds_for(mesh, executor)) {
        return true;
    }
    clean_afresh(mesh, executor);
    return false;
}

CleanReport CleanMeshCache::report(const MeshView& mesh, Executor& executor) const {
    CleanReport report;
    report.triangles_read = mesh.triangles.size();
    report.vertices_read = mesh.positions.size();
    // Also of vertices in no triangle, which may have met or parted since.
    const std::vector<VertexId> weld = weld_equal_positions(mesh.positions);
    for (std::size_t v = 0; v < weld.size(); ++v) {
        report.vertices_welded += weld[v] != v ? 1 : 0;
    }
    report.degenerate_triangles =
        static_cast<std::size_t>(std::count(has_area_.begin(), has_area_.end(), 0));
    report.duplicate_triangles = clean_.duplicates.size();
    std::vector<Triangle> kept(clean_.kept.size());
    executor.for_each(kept.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            kept[i] = welded(mesh.triangles[clean_.kept[i]], clean_.weld);
        }
    });
    count_edges(kept, mesh.positions, report);
    return report;
}

}  // namespace earshot::geometry
