// SPDX-License-Identifier: MIT
#include "earshot/visibility/visible_share.h"

#include "earshot/base/assert.h"
#include "earshot/base/math.h"
#include "earshot/base/random.h"
#include "earshot/geometry/clean.h"
#include "earshot/geometry/facets.h"
#include "earshot/geometry/overlap.h"
#include "earshot/geometry/vector.h"
#include "earshot/visibility/internal/share_cells.h"
#include "earshot/visibility/line_of_sight.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace earshot::visibility {

using geometry::Plane;
using geometry::TriangleId;
using geometry::Vec3;

namespace {

constexpr std::size_t kMinRays = 8, kMaxRays = std::size_t{1} << 20U;

// Distances that are compared are computed from coordinates with relative errors of some 2^-50;
// what is divided by a small sine, at most by kMinSine, may lose as many digits more.
constexpr double kMargin = 1e-9;
constexpr double kMinSine = 1e-6;

constexpr std::uint32_t kNoPolygon = std::numeric_limits<std::uint32_t>::max();

/// A convex polygon that blocks as a whole.
struct ConvexOccluder {
    Plane plane;
    std::vector<Vec3> corners;  // counter-clockwise from the plane's front
    double slack = 0.0;         // by which its surface may lie elsewhere, metres
};

/// Whether every corner turns the same way.
bool is_convex(const geometry::Loop& loop, const Vec3& normal) {
    for (std::size_t i = 0; i < loop.size(); ++i) {
        const Vec3& before = loop[(i + loop.size() - 1) % loop.size()];
        const Vec3& after = loop[(i + 1) % loop.size()];
        if (!(glm::dot(glm::cross(loop[i] - before, after - loop[i]), normal) > 0.0)) {
            return false;
        }
    }
    // A star turns the same way, too, but more than once round.
    double turn = 0.0;
    for (std::size_t i = 0; i < loop.size(); ++i) {
        const Vec3 in = loop[i] - loop[(i + loop.size() - 1) % loop.size()];
        const Vec3 out = loop[(i + 1) % loop.size()] - loop[i];
        turn += math::atan2(glm::length(glm::cross(in, out)), glm::dot(in, out));
    }
    return turn < 3.0 * math::kPi;
}

/// What is known of a share while its cells are divided.
struct Decision {
    double visible = 0.0;  // of the target
    double sampled = 0.0;
    double visible_sampled = 0.0;
    double squared = 0.0;  // sum of the squares of sampled cells
    std::uint64_t rays = 0;
};

}  // namespace

struct VisibleShareQuery::State {
    State(const bvh::MeshBvh& the_bvh, const ExclusionMask& mask, Executor& executor)
        : bvh(the_bvh),
          excluded(mask),
          polygon_of_triangle(bvh.mesh().triangles.size(), kNoPolygon) {
        find_polygons(executor);
    }

    void find_polygons(Executor& executor);
    bool covers(const ConvexOccluder& occluder, const Vec3& from, const CellHull& hull) const;
    bool is_hidden(const Vec3& from,
                   const CellHull& hull,
                   std::span<const TriangleId> triangles) const;
    geometry::ConvexRegion region(const Vec3& from, const CellHull& hull) const;
    double scale(const Vec3& from, const CellHull& hull) const;

    bvh::MeshBvh bvh;
    ExclusionMask excluded;
    std::vector<ConvexOccluder> polygons;
    std::vector<std::uint32_t> polygon_of_triangle;
};

// Facets of one convex loop all of whose triangles block.
void VisibleShareQuery::State::find_polygons(Executor& executor) {
    const geometry::MeshView& mesh = bvh.mesh();
    if (mesh.triangles.empty()) {
        return;
    }
    const geometry::CleanMesh clean = geometry::clean(mesh, executor);
    std::vector<geometry::Triangle> kept;
    std::vector<std::uint32_t> labels;
    for (const TriangleId id : clean.kept) {
        kept.push_back(mesh.triangles[id]);
        labels.push_back(excluded.contains(id) ? 1 : 0);
    }
    const geometry::Facets facets =
        geometry::find_facets({mesh.positions, kept}, clean.weld, labels, executor);
    for (const geometry::Facet& facet : facets.facets) {
        if (labels[facet.triangles.front()] != 0 || facet.loops.size() != 1 ||
            !is_convex(facet.loops.front(), facet.plane.normal)) {
            continue;
        }
        for (const TriangleId triangle : facet.triangles) {
            polygon_of_triangle[clean.kept[triangle]] = static_cast<std::uint32_t>(polygons.size());
        }
        // Corners may lie off the plane by the deviation, and straight runs be left out of the
        // loop within the tolerance.
        polygons.push_back({.plane = facet.plane,
                            .corners = facet.loops.front(),
                            .slack = 4.0 * (facet.deviation + facets.tolerance)});
    }
}

double VisibleShareQuery::State::scale(const Vec3& from, const CellHull& hull) const {
    double largest = std::max(bvh.max_abs_coordinate(), geometry::max_abs(from));
    for (const Vec3& corner : hull.far) {
        largest = std::max(largest, geometry::max_abs(corner));
    }
    return largest;
}

// Errs to the side of false. The cell's lines of sight are hidden if the corners of their hull lie
// behind the occluder's plane and within the pyramid over its edges: both hold for the hull of the
// corners, too.
bool VisibleShareQuery::State::covers(const ConvexOccluder& occluder,
                                      const Vec3& from,
                                      const CellHull& hull) const {
    const double margin = kMargin * scale(from, hull) + occluder.slack;
    const double height = occluder.plane.distance(from);
    if (!(std::abs(height) > margin)) {
        return false;
    }
    const double side = height > 0.0 ? 1.0 : -1.0;
    for (const Vec3& corner : hull.near) {
        if (!(side * occluder.plane.distance(corner) < -margin)) {
            return false;
        }
    }
    for (std::size_t i = 0; i < occluder.corners.size(); ++i) {
        const Vec3 first = occluder.corners[i] - from;
        const Vec3 second = occluder.corners[(i + 1) % occluder.corners.size()] - from;
        const Vec3 normal = glm::cross(first, second);
        const double length = glm::length(normal);
        if (!(length > kMinSine * glm::length(first) * glm::length(second))) {
            return false;
        }
        for (const Vec3& corner : hull.near) {
            // The front sees the corners counter-clockwise: the inside is to the left.
            if (!(-side * glm::dot(normal, corner - from) > margin * length)) {
                return false;
            }
        }
    }
    return true;
}

bool VisibleShareQuery::State::is_hidden(const Vec3& from,
                                         const CellHull& hull,
                                         std::span<const TriangleId> triangles) const {
    std::uint32_t last = kNoPolygon;
    for (const TriangleId id : triangles) {
        const std::uint32_t polygon = polygon_of_triangle[id];
        if (polygon != kNoPolygon) {
            if (polygon != last && covers(polygons[polygon], from, hull)) {
                return true;
            }
            last = polygon;
            continue;
        }
        const auto [a, b, c] = bvh.corners(id);
        const Vec3 normal = geometry::normalized_or_zero(glm::cross(b - a, c - a));
        if (normal != Vec3(0.0) &&
            covers({.plane = {normal, glm::dot(normal, a)}, .corners = {a, b, c}}, from, hull)) {
            return true;
        }
    }
    return false;
}

// The hull of the point and the cell's far side, and a little more.
geometry::ConvexRegion VisibleShareQuery::State::region(const Vec3& from,
                                                        const CellHull& hull) const {
    const double margin = kMargin * scale(from, hull);
    const Vec3 middle = 0.25 * (hull.far[0] + hull.far[1] + hull.far[2] + hull.far[3]);
    std::vector<Plane> planes;
    const auto add = [&](const Vec3& normal, const Vec3& on_it, const Vec3& inside) {
        const double length = glm::length(normal);
        if (length > 0.0) {
            const Vec3 unit = normal / length;
            const double outward = glm::dot(unit, inside - on_it) > 0.0 ? -1.0 : 1.0;
            planes.push_back({outward * unit, glm::dot(outward * unit, on_it) + margin});
        }
    };
    for (std::size_t corner = 0; corner < 4; ++corner) {
        const Vec3 first = hull.far[corner] - from;
        const Vec3 second = hull.far[(corner + 1) % 4] - from;
        // A side whose direction is lost in rounding bounds nothing.
        const Vec3 normal = glm::cross(first, second);
        if (glm::length(normal) > kMinSine * glm::length(first) * glm::length(second)) {
            add(normal, from, middle);
        }
    }
    add(glm::cross(hull.far[2] - hull.far[0], hull.far[3] - hull.far[1]), hull.far[0], from);
    return geometry::ConvexRegion(planes);
}

namespace {

/// One share under way.
template <class State>
class Division {
public:
    Division(const State& state,
             const Vec3& from,
             const ShareCells& cells,
             const VisibleShareOptions& options)
        : state_(state), from_(from), cells_(cells), random_(options.seed, 0) {
        EARSHOT_ASSERT(options.max_rays >= kMinRays && options.max_rays <= kMaxRays);
        leaves_ = cells.columns();
        while (4 * leaves_ <= options.max_rays) {
            leaves_ *= 4;
            ++levels_;
        }
    }

    VisibleShare run() {
        const std::size_t columns = cells_.columns();
        for (std::size_t column = 0; column < columns; ++column) {
            const ParameterCell cell{
                .u0 = static_cast<double>(column) / static_cast<double>(columns),
                .u1 = static_cast<double>(column + 1) / static_cast<double>(columns)};
            divide(cell, levels_, column, {});
        }
        // Hoeffding 1963, theorem 2: the sum of independent numbers, each 0 or the size of its
        // cell, is off by more than this once in a million.
        constexpr double kOdds = 1e-6;
        const double hoeffding = std::sqrt(0.5 * math::log(2.0 / kOdds) * decision_.squared);
        const double farthest =
            std::max(decision_.visible_sampled, decision_.sampled - decision_.visible_sampled);
        return {.share = std::min(1.0, decision_.visible + decision_.visible_sampled),
                .error = std::min(hoeffding, farthest),
                .rays = decision_.rays};
    }

private:
    /// `number` of the cell among those of its level; `candidates` are those of its parent.
    void divide(const ParameterCell& cell,
                int levels,
                std::uint64_t number,
                std::span<const TriangleId> candidates) {
        const double size = (cell.u1 - cell.u0) * (cell.v1 - cell.v0);
        const CellHull hull = cells_.hull(cell);
        const geometry::ConvexRegion region = state_.region(from_, hull);
        std::vector<TriangleId> triangles;
        const auto blocks = [&](TriangleId id) { return !state_.excluded.contains(id); };
        if (levels == levels_) {
            triangles = state_.bvh.overlapping(region);
            triangles.erase(
                std::remove_if(
                    triangles.begin(), triangles.end(), [&](TriangleId id) { return !blocks(id); }),
                triangles.end());
        } else {
            for (const TriangleId id : candidates) {
                const auto [a, b, c] = state_.bvh.corners(id);
                if (region.touches(a, b, c)) {
                    triangles.push_back(id);
                }
            }
        }
        if (triangles.empty()) {
            decision_.visible += size;
            return;
        }
        if (state_.is_hidden(from_, hull, triangles)) {
            return;
        }
        if (levels == 0) {
            cast_ray(cell, size, number);
            return;
        }
        for (std::size_t quarter = 0; quarter < 4; ++quarter) {
            divide(cell.quarter(quarter), levels - 1, 4 * number + quarter, triangles);
        }
    }

    void cast_ray(const ParameterCell& cell, double size, std::uint64_t number) {
        const double u = cell.u0 + random_.at(2 * number) * (cell.u1 - cell.u0);
        const double v = cell.v0 + random_.at(2 * number + 1) * (cell.v1 - cell.v0);
        ++decision_.rays;
        decision_.sampled += size;
        decision_.squared += size * size;
        if (visible(state_.bvh, {from_, cells_.point(u, v)}, state_.excluded)) {
            decision_.visible_sampled += size;
        }
    }

    const State& state_;
    const Vec3& from_;
    const ShareCells& cells_;
    RandomStream random_;
    std::size_t leaves_ = 1;
    int levels_ = 0;
    Decision decision_;
};

}  // namespace

VisibleShareQuery::VisibleShareQuery(const bvh::MeshBvh& bvh,
                                     const ExclusionMask& excluded,
                                     Executor& executor)
    : state_(std::make_unique<const State>(bvh, excluded, executor)) {}

VisibleShareQuery::~VisibleShareQuery() = default;
VisibleShareQuery::VisibleShareQuery(VisibleShareQuery&&) noexcept = default;
VisibleShareQuery& VisibleShareQuery::operator=(VisibleShareQuery&&) noexcept = default;

VisibleShare VisibleShareQuery::share(const Vec3& from,
                                      const SphereTarget& target,
                                      const VisibleShareOptions& options) const {
    EARSHOT_ASSERT(target.radius > 0.0);
    if (!(glm::distance(from, target.centre) > target.radius)) {
        return {.share = 1.0};
    }
    return Division(*state_, from, SphereCells(from, target), options).run();
}

VisibleShare VisibleShareQuery::share(const Vec3& from,
                                      const ParallelogramTarget& target,
                                      const VisibleShareOptions& options) const {
    return Division(*state_, from, ParallelogramCells(target), options).run();
}

std::vector<VisibleShare> VisibleShareQuery::matrix(std::span<const Vec3> from,
                                                    std::span<const Vec3> to,
                                                    double radius,
                                                    const VisibleShareOptions& options,
                                                    Executor& executor) const {
    std::vector<VisibleShare> shares(from.size() * to.size());
    executor.for_each(shares.size(), 4, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            shares[i] = share(
                from[i / to.size()], {.centre = to[i % to.size()], .radius = radius}, options);
        }
    });
    return shares;
}

}  // namespace earshot::visibility
