// SPDX-License-Identifier: MIT
#include "earshot/visibility/internal/visible_search.h"

#include "earshot/bvh/wide_batch.h"
#include "earshot/visibility/internal/border_sampling.h"
#include "earshot/visibility/internal/unit.h"

#include <algorithm>
#include <array>
#include <utility>

namespace earshot::visibility {

using geometry::Hit;
using geometry::Ray;
using geometry::TriangleId;
using geometry::Vec3;

namespace {

/// Rays that are made at a time.
constexpr std::size_t kBatch = std::size_t{1} << 16U;

constexpr std::size_t kGrain = 4096;

/// Triangles whose borders are followed at a time.
constexpr std::size_t kTrianglesAtATime = 4096;

/// The square of the distance between opposite unit vectors is 4; this close to it, no direction
/// between them can be told.
constexpr double kOpposite = 4.0 - 1e-12;

}  // namespace

VisibleSearch::VisibleSearch(const bvh::WideTree& tree,
                             const geometry::MeshView& mesh,
                             const Vec3& point,
                             const VisibleTrianglesOptions& options,
                             Executor& executor)
    : tree_(tree),
      mesh_(mesh),
      point_(point),
      options_(options),
      executor_(executor),
      place_(mesh.triangles.size(), kNoTriangle) {}

std::vector<TriangleId> VisibleSearch::look(std::span<const Vec3> directions) {
    std::vector<TriangleId> seen(directions.size(), kNoTriangle);
    std::vector<Ray> rays(std::min(kBatch, directions.size()));
    std::vector<std::optional<Hit>> hits(rays.size());
    for (std::size_t done = 0; done < directions.size(); done += kBatch) {
        const auto batch = directions.subspan(done, std::min(kBatch, directions.size() - done));
        executor_.for_each(batch.size(), kGrain, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                rays[i] = {.origin = point_, .direction = batch[i]};
            }
        });
        bvh::closest_hits(tree_,
                          mesh_,
                          std::span<const Ray>(rays).first(batch.size()),
                          std::span(hits).first(batch.size()),
                          executor_);
        for (std::size_t i = 0; i < batch.size(); ++i) {
            if (hits[i]) {
                seen[done + i] = hits[i]->triangle;
                note(hits[i]->triangle, batch[i]);
            }
        }
    }
    found_.rays += directions.size();
    return seen;
}

std::optional<std::vector<TriangleId>> VisibleSearch::refine(std::span<const Vec3> directions) {
    if (directions.size() > options_.max_refining_rays - refining_rays_) {
        found_.is_complete = false;
        return std::nullopt;
    }
    refining_rays_ += directions.size();
    return look(directions);
}

void VisibleSearch::note(TriangleId triangle, const Vec3& direction) {
    if (place_[triangle] == kNoTriangle) {
        place_[triangle] = static_cast<std::uint32_t>(found_.triangles.size());
        found_.triangles.push_back({.triangle = triangle, .direction = direction});
    }
}

void VisibleSearch::count_pixel(TriangleId triangle, double solid_angle) {
    if (triangle == kNoTriangle) {
        found_.free_solid_angle += solid_angle;
        return;
    }
    VisibleTriangle& entry = found_.triangles[place_[triangle]];
    ++entry.pixels;
    entry.solid_angle += solid_angle;
}

bool VisibleSearch::are_joined(TriangleId a, TriangleId b) const noexcept {
    if (a == kNoTriangle || b == kNoTriangle) {
        return false;
    }
    // By position: files of some formats give every triangle corners of its own.
    int shared = 0;
    for (const geometry::VertexId i : mesh_.triangles[a]) {
        for (const geometry::VertexId j : mesh_.triangles[b]) {
            shared += i == j || mesh_.positions[i] == mesh_.positions[j] ? 1 : 0;
        }
    }
    return shared >= 2;
}

bool VisibleSearch::is_open(const Gap& gap, double longest) const noexcept {
    // The chord, which is a little shorter than the angle.
    const Vec3 step = gap.second.direction - gap.first.direction;
    const double squared = glm::dot(step, step);
    if (!(squared > options_.min_gap * options_.min_gap && squared < kOpposite)) {
        return false;
    }
    const TriangleId a = gap.first.triangle, b = gap.second.triangle;
    return squared > longest * longest || (a != b && !are_joined(a, b));
}

void VisibleSearch::narrow(std::vector<Gap> gaps, double longest) {
    std::vector<Vec3> middles;
    while (!gaps.empty()) {
        middles.clear();
        for (const Gap& gap : gaps) {
            middles.push_back(unit(gap.first.direction + gap.second.direction));
        }
        const auto seen = refine(middles);
        if (!seen) {
            return;
        }
        std::vector<Gap> halves;
        for (std::size_t i = 0; i < gaps.size(); ++i) {
            const Look middle{middles[i], (*seen)[i]};
            for (const Gap& half : {Gap{gaps[i].first, middle}, Gap{middle, gaps[i].second}}) {
                if (is_open(half, longest)) {
                    halves.push_back(half);
                }
            }
        }
        gaps = std::move(halves);
    }
}

std::array<Vec3, 3> VisibleSearch::corners_of(TriangleId triangle) const noexcept {
    const geometry::Triangle& t = mesh_.triangles[triangle];
    return {mesh_.positions[t[0]] - point_,
            mesh_.positions[t[1]] - point_,
            mesh_.positions[t[2]] - point_};
}

void VisibleSearch::follow_borders(Progress* progress) {
    std::vector<Vec3> directions;
    while (followed_ < found_.triangles.size() && found_.is_complete) {
        const std::size_t end = std::min(found_.triangles.size(), followed_ + kTrianglesAtATime);
        directions.clear();
        for (; followed_ < end; ++followed_) {
            // Seen from the origin, since the corners are counted from the point.
            auto outline = enlarged(
                {}, corners_of(found_.triangles[followed_].triangle), options_.border_angle);
            std::transform(outline.begin(), outline.end(), outline.begin(), unit);
            if (std::all_of(outline.begin(), outline.end(), is_finite)) {
                directions.insert(directions.end(), outline.begin(), outline.end());
            }
        }
        const auto seen = refine(directions);
        if (!seen) {
            return;
        }
        // The sides of the polygons: also where both ends see the same, no piece of a border is
        // left that is longer than a pixel.
        std::vector<Gap> gaps;
        for (std::size_t i = 0; i < directions.size(); ++i) {
            const bool is_last = i % kBorderPoints == kBorderPoints - 1;
            const std::size_t next = is_last ? i + 1 - kBorderPoints : i + 1;
            const Gap side{{directions[i], (*seen)[i]}, {directions[next], (*seen)[next]}};
            if (is_open(side, options_.resolution)) {
                gaps.push_back(side);
            }
        }
        narrow(std::move(gaps), options_.resolution);
        if (progress != nullptr) {
            progress->report("borders", followed_, found_.triangles.size());
        }
    }
}

void VisibleSearch::aim_at_others(Progress* progress) {
    std::vector<Vec3> directions;
    std::size_t next = 0;
    while (next < place_.size() && found_.is_complete) {
        directions.clear();
        for (; next < place_.size() && directions.size() < kBatch; ++next) {
            if (place_[next] != kNoTriangle) {
                continue;
            }
            const auto corners = corners_of(static_cast<TriangleId>(next));
            const Vec3 direction = unit(corners[0] + corners[1] + corners[2]);
            if (is_finite(direction)) {
                directions.push_back(direction);
            }
        }
        refine(directions);
        if (progress != nullptr) {
            progress->report("aims", next, place_.size());
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
