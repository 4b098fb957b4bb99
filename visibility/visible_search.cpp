// SPDX-License-Identifier: MIT
#include "earshot/visibility/internal/visible_search.h"

#include "earshot/geometry/vector.h"
#include "earshot/visibility/internal/border_sampling.h"
#include "earshot/visibility/internal/directions.h"
#include "earshot/visibility/internal/masked_hits.h"

#include <algorithm>
#include <array>
#include <utility>

namespace earshot::visibility {

using geometry::Hit;
using geometry::Ray;
using geometry::TriangleId;
using geometry::Vec3;

namespace {

/// Rays per batch.
constexpr std::size_t kBatch = std::size_t{1} << 16U;

constexpr std::size_t kGrain = 4096;

/// Triangles whose borders are sampled at a time.
constexpr std::size_t kTrianglesPerBatch = 4096;

/// The square of the distance between opposite unit vectors is 4; this close to it, no direction
/// between them can be told.
constexpr double kOpposite = 4.0 - 1e-12;

}  // namespace

VisibleSearch::VisibleSearch(const bvh::MeshBvh& bvh,
                             const Vec3& point,
                             const VisibleTrianglesOptions& options,
                             Executor& executor)
    : bvh_(bvh),
      point_(point),
      options_(options),
      excluded_(with_degenerate(options.excluded, bvh.mesh())),
      executor_(executor),
      index_of_triangle_(bvh.mesh().triangles.size(), kNoTriangle) {}

std::vector<TriangleId> VisibleSearch::cast(std::span<const Vec3> directions) {
    std::vector<TriangleId> visible(directions.size(), kNoTriangle);
    std::vector<Ray> rays(std::min(kBatch, directions.size()));
    std::vector<std::optional<Hit>> hits(rays.size());
    for (std::size_t done = 0; done < directions.size(); done += kBatch) {
        const auto batch = directions.subspan(done, std::min(kBatch, directions.size() - done));
        executor_.for_each(batch.size(), kGrain, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                rays[i] = {.origin = point_, .direction = batch[i]};
            }
        });
        closest_hits(bvh_,
                     std::span<const Ray>(rays).first(batch.size()),
                     excluded_,
                     std::span(hits).first(batch.size()),
                     executor_);
        for (std::size_t i = 0; i < batch.size(); ++i) {
            if (hits[i]) {
                visible[done + i] = hits[i]->triangle;
                record(hits[i]->triangle, batch[i]);
            }
        }
    }
    found_.rays += directions.size();
    return visible;
}

std::optional<std::vector<TriangleId>> VisibleSearch::refine(std::span<const Vec3> directions) {
    if (directions.size() > options_.max_refining_rays - refining_rays_) {
        found_.is_complete = false;
        return std::nullopt;
    }
    refining_rays_ += directions.size();
    return cast(directions);
}

void VisibleSearch::record(TriangleId triangle, const Vec3& direction) {
    if (index_of_triangle_[triangle] == kNoTriangle) {
        index_of_triangle_[triangle] = static_cast<std::uint32_t>(found_.triangles.size());
        found_.triangles.push_back({.triangle = triangle, .direction = direction});
    }
}

void VisibleSearch::count_pixel(TriangleId triangle, double solid_angle) {
    if (triangle == kNoTriangle) {
        found_.free_solid_angle += solid_angle;
        return;
    }
    VisibleTriangle& entry = found_.triangles[index_of_triangle_[triangle]];
    ++entry.pixels;
    entry.solid_angle += solid_angle;
}

bool VisibleSearch::share_edge(TriangleId a, TriangleId b) const noexcept {
    if (a == kNoTriangle || b == kNoTriangle) {
        return false;
    }
    // Compared by position, because files of some formats give every triangle its own vertices.
    int shared = 0;
    for (const geometry::VertexId i : bvh_.mesh().triangles[a]) {
        for (const geometry::VertexId j : bvh_.mesh().triangles[b]) {
            shared += i == j || bvh_.mesh().positions[i] == bvh_.mesh().positions[j] ? 1 : 0;
        }
    }
    return shared >= 2;
}

bool VisibleSearch::needs_subdivision(const DirectionInterval& interval,
                                      double max_angle) const noexcept {
    // The chord, which is a little shorter than the angle.
    const Vec3 step = interval.second.direction - interval.first.direction;
    const double squared = glm::dot(step, step);
    if (!(squared > options_.min_gap * options_.min_gap && squared < kOpposite)) {
        return false;
    }
    const TriangleId a = interval.first.triangle, b = interval.second.triangle;
    return squared > max_angle * max_angle || (a != b && !share_edge(a, b));
}

void VisibleSearch::subdivide(std::vector<DirectionInterval> intervals, double max_angle) {
    std::vector<Vec3> middles;
    while (!intervals.empty()) {
        middles.clear();
        for (const DirectionInterval& interval : intervals) {
            middles.push_back(
                geometry::normalized(interval.first.direction + interval.second.direction));
        }
        const auto visible = refine(middles);
        if (!visible) {
            return;
        }
        std::vector<DirectionInterval> subintervals;
        for (std::size_t i = 0; i < intervals.size(); ++i) {
            const DirectionSample middle{middles[i], (*visible)[i]};
            for (const DirectionInterval& subinterval :
                 {DirectionInterval{intervals[i].first, middle},
                  DirectionInterval{middle, intervals[i].second}}) {
                if (needs_subdivision(subinterval, max_angle)) {
                    subintervals.push_back(subinterval);
                }
            }
        }
        intervals = std::move(subintervals);
    }
}

Corners VisibleSearch::relative_corners(TriangleId triangle) const noexcept {
    Corners corners = bvh_.corners(triangle);
    for (Vec3& corner : corners) {
        corner -= point_;
    }
    return corners;
}

void VisibleSearch::sample_borders(Progress* progress) {
    std::vector<Vec3> directions;
    while (borders_followed_ < found_.triangles.size() && found_.is_complete) {
        const std::size_t end =
            std::min(found_.triangles.size(), borders_followed_ + kTrianglesPerBatch);
        directions.clear();
        for (; borders_followed_ < end; ++borders_followed_) {
            // The eye is the origin, because the corners are relative to the point.
            auto outline =
                enlarged_polygon({},
                                 relative_corners(found_.triangles[borders_followed_].triangle),
                                 options_.border_angle);
            std::transform(outline.begin(), outline.end(), outline.begin(), geometry::normalized);
            if (std::all_of(outline.begin(), outline.end(), [](const Vec3& v) {
                    return geometry::is_finite(v);
                })) {
                directions.insert(directions.end(), outline.begin(), outline.end());
            }
        }
        const auto visible = refine(directions);
        if (!visible) {
            return;
        }
        // The sides of the polygons are subdivided down to a pixel even where both ends show the
        // same triangle.
        std::vector<DirectionInterval> intervals;
        for (std::size_t i = 0; i < directions.size(); ++i) {
            const bool is_last = i % kPolygonVertices == kPolygonVertices - 1;
            const std::size_t next = is_last ? i + 1 - kPolygonVertices : i + 1;
            const DirectionInterval side{{directions[i], (*visible)[i]},
                                         {directions[next], (*visible)[next]}};
            if (needs_subdivision(side, options_.resolution)) {
                intervals.push_back(side);
            }
        }
        subdivide(std::move(intervals), options_.resolution);
        if (progress != nullptr) {
            progress->report("borders", borders_followed_, found_.triangles.size());
        }
    }
}

void VisibleSearch::aim_at_missing(Progress* progress) {
    std::vector<Vec3> directions;
    std::size_t next = 0;
    while (next < index_of_triangle_.size() && found_.is_complete) {
        directions.clear();
        for (; next < index_of_triangle_.size() && directions.size() < kBatch; ++next) {
            const auto id = static_cast<TriangleId>(next);
            if (index_of_triangle_[next] != kNoTriangle || excluded_.contains(id)) {
                continue;
            }
            const auto corners = relative_corners(id);
            const Vec3 direction = geometry::normalized(corners[0] + corners[1] + corners[2]);
            if (geometry::is_finite(direction)) {
                directions.push_back(direction);
            }
        }
        refine(directions);
        if (progress != nullptr) {
            progress->report("aims", next, index_of_triangle_.size());
        }
    }
}

VisibleTriangles VisibleSearch::finish() {
    std::sort(
        found_.triangles.begin(),
        found_.triangles.end(),
        [](const VisibleTriangle& a, const VisibleTriangle& b) { return a.triangle < b.triangle; });
    return std::move(found_);
}

}  // namespace earshot::visibility
