// SPDX-License-Identifier: MIT
#include "earshot/propagation/internal/leak_search.h"

#include "earshot/geometry/disjoint_sets.h"
#include "earshot/geometry/topology.h"
#include "earshot/geometry/triangulate.h"
#include "earshot/geometry/vector.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>

#include <algorithm>
#include <array>
#include <utility>

namespace earshot::propagation {
namespace {

using geometry::Vec3;
using visibility::Opening;
using visibility::OpeningFlow;

/// Loops of more corners are capped by a fan about their centre: ear clipping takes the square.
constexpr std::size_t kMaxTriangulatedRim = 500;

/// A cap of a larger area than so many times that of its rim's vector area folds over itself, as
/// where borders run to and fro along a line: what passes it is no measure of the hole.
constexpr double kMaxFoldedArea = 2.0;

/// Strips beside open edges reach from one of these distances to the next, metres: gaps of 1 cm are
/// met by one place in three of the first, and those of up to 0.4 m by places of the others.
constexpr std::array<double, 4> kStripWidths{0.0, 0.03, 0.12, 0.4};
constexpr std::uint32_t kRaysPerStrip = 64;
constexpr std::size_t kMaxStripEdges = 4096;  // the longest

/// Fewer leaking rays, or a smaller share of those that are not blocked, may be the wrong label of
/// a small sample.
constexpr std::uint32_t kMinLeakingRays = 3;
constexpr double kMinLeakingShare = 0.02;

bool leaks_through(const OpeningFlow& flow) {
    return flow.leaking >= kMinLeakingRays &&
           flow.leaking >= kMinLeakingShare * (flow.rays - flow.blocked);
}

double leaking_area(const OpeningFlow& flow) {
    return flow.area * flow.leaking / flow.rays;
}

Opening cap_of(const CheckedMesh& mesh, const geometry::HoleLoop& hole) {
    const auto positions = mesh.view().positions;
    Opening opening;
    if (hole.rim.size() <= kMaxTriangulatedRim) {
        for (const geometry::Triangle& t : geometry::triangulate(positions, hole.rim)) {
            opening.cap.push_back(geometry::corners(positions, t));
        }
        return opening;
    }
    for (std::size_t i = 0; i < hole.rim.size(); ++i) {
        opening.cap.push_back(
            {hole.centre, positions[hole.rim[i]], positions[hole.rim[(i + 1) % hole.rim.size()]]});
    }
    return opening;
}

bool is_folded(const Opening& cap, const geometry::HoleLoop& hole) {
    double area = 0.0;
    for (const auto& [a, b, c] : cap.cap) {
        area += 0.5 * glm::length(glm::cross(b - a, c - a));
    }
    return area > kMaxFoldedArea * hole.area;
}

/// An edge of one triangle, and the direction in that triangle's plane that leaves it there.
struct OpenEdge {
    Vec3 from{0.0}, to{0.0};
    Vec3 outward{0.0};
    std::pair<geometry::VertexId, geometry::VertexId> vertices;  // ascending
};

std::vector<OpenEdge> longest_open_edges(const CheckedMesh& mesh) {
    const auto [positions, triangles] = mesh.view();
    const geometry::EdgeTable edges(triangles, positions.size());
    std::vector<OpenEdge> open;
    for (std::size_t e = 0; e < edges.size(); ++e) {
        if (edges.uses(e).size() != 1) {
            continue;
        }
        const geometry::HalfEdgeId h = edges.uses(e).front();
        const auto a = geometry::start_of(triangles, h);
        const auto b = geometry::end_of(triangles, h);
        const Vec3& apex = positions[geometry::end_of(triangles, geometry::next_in_triangle(h))];
        const Vec3 along = geometry::direction_between(positions[a], positions[b]);
        const Vec3 inward = apex - positions[a];
        open.push_back(
            {.from = positions[a],
             .to = positions[b],
             .outward = -geometry::normalized_or_zero(inward - glm::dot(inward, along) * along),
             .vertices = std::minmax(a, b)});
    }
    std::stable_sort(open.begin(), open.end(), [](const OpenEdge& a, const OpenEdge& b) {
        return glm::distance(a.from, a.to) > glm::distance(b.from, b.to);
    });
    open.resize(std::min(open.size(), kMaxStripEdges));
    return open;
}

Opening strip_of(const OpenEdge& edge, double near, double far) {
    const std::array<Vec3, 4> corners{edge.from + near * edge.outward,
                                      edge.to + near * edge.outward,
                                      edge.to + far * edge.outward,
                                      edge.from + far * edge.outward};
    return {.cap = {{corners[0], corners[1], corners[2]}, {corners[0], corners[2], corners[3]}},
            .rays = kRaysPerStrip,
            .is_strip = true};
}

/// What leaks beside one open edge, or beside several of one gap.
struct Gap {
    Vec3 lower{0.0}, upper{0.0};
    double area = 0.0;
    double max_area = 0.0;  // of one edge
    bool escapes = false;
};

/// The gaps beside edges, those that touch made one. A gap has an edge on either side, so that half
/// of the sum over its edges counts.
std::vector<Gap> merged(const std::vector<Gap>& gaps, double reach) {
    geometry::DisjointSets sets(gaps.size());
    for (std::uint32_t i = 0; i < gaps.size(); ++i) {
        for (std::uint32_t k = 0; k < i; ++k) {
            const bool touches =
                glm::all(glm::lessThanEqual(gaps[i].lower, gaps[k].upper + reach)) &&
                glm::all(glm::lessThanEqual(gaps[k].lower, gaps[i].upper + reach));
            if (touches) {
                sets.unite(i, k);
            }
        }
    }
    std::vector<Gap> result;
    std::vector<std::size_t> place(gaps.size());
    for (std::uint32_t i = 0; i < gaps.size(); ++i) {
        const std::uint32_t root = sets.find(i);
        if (root == i) {
            place[i] = result.size();
            result.push_back(gaps[i]);
            continue;
        }
        Gap& gap = result[place[root]];
        gap.lower = glm::min(gap.lower, gaps[i].lower);
        gap.upper = glm::max(gap.upper, gaps[i].upper);
        gap.area += gaps[i].area;
        gap.max_area = std::max(gap.max_area, gaps[i].max_area);
        gap.escapes = gap.escapes || gaps[i].escapes;
    }
    for (Gap& gap : result) {
        gap.area = std::max(gap.max_area, 0.5 * gap.area);
    }
    return result;
}

/// The vertices of the edges of a rim, ascending.
using Edges = std::vector<std::pair<geometry::VertexId, geometry::VertexId>>;

void add_rim(const geometry::HoleLoop& hole, Edges& edges) {
    for (std::size_t i = 0; i < hole.rim.size(); ++i) {
        edges.push_back(std::minmax(hole.rim[i], hole.rim[(i + 1) % hole.rim.size()]));
    }
}

Leak leak_of_hole(const geometry::HoleLoop& hole, std::size_t index, const OpeningFlow& flow) {
    // A hole that is partly closed by something behind it leaks where its rays pass.
    const bool is_whole = 2 * flow.leaking > flow.rays;
    const Vec3 lower = is_whole ? hole.lower : flow.lower;
    const Vec3 upper = is_whole ? hole.upper : flow.upper;
    return {.place = {.centre = 0.5 * (lower + upper),
                      .size = upper - lower,
                      .area = leaking_area(flow)},
            .escapes = flow.escaping > 0,
            .hole = index};
}

}  // namespace

LeakSearch find_leaks(const CheckedMesh& mesh,
                      const geometry::MeshTopology& topology,
                      std::span<const Vec3> points,
                      const visibility::AirCutOptions& options,
                      Executor& executor) {
    std::vector<Opening> openings;
    for (const geometry::HoleLoop& hole : topology.holes) {
        openings.push_back(cap_of(mesh, hole));
        // What covers a sheet, or folds, is no part of the graph.
        openings.back().is_strip = hole.is_outline || is_folded(openings.back(), hole);
    }
    const std::vector<OpenEdge> edges = longest_open_edges(mesh);
    for (const OpenEdge& edge : edges) {
        for (std::size_t k = 0; k + 1 < kStripWidths.size(); ++k) {
            openings.push_back(strip_of(edge, kStripWidths[k], kStripWidths[k + 1]));
        }
    }
    LeakSearch result;
    result.cut = visibility::cut_air(mesh.bvh(), points, openings, options, executor);

    const std::vector<OpeningFlow>& flows = result.cut.openings;
    Edges explained;  // of holes that leak
    for (std::size_t i = 0; i < topology.holes.size(); ++i) {
        if (!openings[i].is_strip && leaks_through(flows[i])) {
            result.leaks.push_back(leak_of_hole(topology.holes[i], i, flows[i]));
            add_rim(topology.holes[i], explained);
        }
    }
    std::sort(explained.begin(), explained.end());
    std::vector<Gap> gaps;
    constexpr std::size_t kStrips = kStripWidths.size() - 1;
    for (std::size_t i = 0; !result.cut.is_open && i < edges.size(); ++i) {
        if (std::binary_search(explained.begin(), explained.end(), edges[i].vertices)) {
            continue;
        }
        for (std::size_t k = 0; k < kStrips; ++k) {
            const OpeningFlow& flow = flows[topology.holes.size() + i * kStrips + k];
            if (leaks_through(flow)) {
                const double area = leaking_area(flow);
                gaps.push_back({flow.lower, flow.upper, area, area, flow.escaping > 0});
            }
        }
    }
    for (const Gap& gap : merged(gaps, kStripWidths[1])) {
        result.leaks.push_back({.place = {.centre = 0.5 * (gap.lower + gap.upper),
                                          .size = gap.upper - gap.lower,
                                          .area = gap.area},
                                .escapes = gap.escapes});
    }
    std::stable_sort(result.leaks.begin(), result.leaks.end(), [](const Leak& a, const Leak& b) {
        return a.place.area > b.place.area;
    });
    return result;
}

}  // namespace earshot::propagation
