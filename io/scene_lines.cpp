// SPDX-License-Identifier: MIT
#include "earshot/io/internal/scene_lines.h"

#include "earshot/geometry/feature_edges.h"
#include "earshot/visibility/line_of_sight.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace earshot::io {

using geometry::TriangleId;
using geometry::Vec3;
using glm::dvec2;

namespace {

constexpr double kShortest = 4.0;  // units; shorter lines are left out

/// An edge under way to the drawing, in steps of at most a unit.
struct SampledEdge {
    Vec3 from{0.0}, to{0.0};
    TriangleId triangle = 0;
    std::size_t first = 0, steps = 0;  // of its samples

    Vec3 at(std::size_t step) const noexcept {
        return from + (to - from) * (static_cast<double>(step) / static_cast<double>(steps));
    }
};

/// Appends the runs of visible samples as lines.
void append_runs(const SampledEdge& edge,
                 std::span<const std::uint8_t> visible,
                 const PictureProjection& projection,
                 std::vector<PictureLine>& lines) {
    std::size_t start = 0;
    for (std::size_t step = 0; step <= edge.steps + 1; ++step) {
        if (step <= edge.steps && visible[edge.first + step] != 0) {
            continue;
        }
        if (step > start) {
            const dvec2 a = projection.project(edge.at(start));
            const dvec2 b = projection.project(edge.at(step - 1));
            if (glm::distance(a, b) >= kShortest) {
                lines.push_back({.from = a, .to = b, .triangle = edge.triangle});
            }
        }
        start = step + 1;
    }
}

}  // namespace

std::vector<PictureLine> visible_edges(const bvh::MeshBvh& bvh,
                                       std::span<const std::uint32_t> labels,
                                       const visibility::ExclusionMask& excluded,
                                       const PictureProjection& projection,
                                       Executor& executor) {
    const geometry::MeshView& mesh = bvh.mesh();
    const geometry::FeatureEdges features =
        geometry::find_feature_edges(mesh, labels, geometry::kCreaseCosine, executor);
    std::vector<SampledEdge> edges;
    std::vector<geometry::Segment> lines_of_view;
    for (std::size_t i = 0; i < features.edges.size(); ++i) {
        const auto beside = features.beside(i);
        const auto shown = std::find_if(
            beside.begin(), beside.end(), [&](TriangleId id) { return !excluded.contains(id); });
        if (shown == beside.end()) {
            continue;
        }
        const auto [a, b] = features.edges[i];
        SampledEdge edge{.from = mesh.positions[a],
                         .to = mesh.positions[b],
                         .triangle = *shown,
                         .first = lines_of_view.size(),
                         .steps = 0};
        const double length =
            glm::distance(projection.project(edge.from), projection.project(edge.to));
        if (length >= kShortest) {
            edge.steps = static_cast<std::size_t>(length) + 1;
            for (std::size_t step = 0; step <= edge.steps; ++step) {
                lines_of_view.push_back(projection.line_of_view(edge.at(step)));
            }
            edges.push_back(edge);
        }
    }
    std::vector<std::uint8_t> visible = visibility::visible(bvh, lines_of_view, excluded, executor);
    std::vector<PictureLine> lines;
    for (const SampledEdge& edge : edges) {
        for (std::size_t step = 0; step <= edge.steps && projection.is_plan(); ++step) {
            if (edge.at(step).y > projection.cut()) {
                visible[edge.first + step] = 0;
            }
        }
        append_runs(edge, visible, projection, lines);
    }
    return lines;
}

std::vector<PictureLine> section_lines(const geometry::MeshView& mesh,
                                       const visibility::ExclusionMask& excluded,
                                       const PictureProjection& projection) {
    std::vector<PictureLine> lines;
    const double cut = projection.cut();
    for (std::size_t id = 0; id < mesh.triangles.size(); ++id) {
        if (excluded.contains(static_cast<TriangleId>(id))) {
            continue;
        }
        const geometry::Corners corners = geometry::corners(mesh, id);
        std::vector<dvec2> ends;
        for (std::size_t i = 0; i < 3; ++i) {
            // From the lower to the upper end, so that neighbours meet in the same point.
            Vec3 low = corners[i], high = corners[(i + 1) % 3];
            if (low.y > high.y) {
                std::swap(low, high);
            }
            if (low.y <= cut && high.y > cut) {
                const double t = (cut - low.y) / (high.y - low.y);
                ends.push_back(projection.project(low + (high - low) * t));
            }
        }
        if (ends.size() == 2) {
            lines.push_back({ends[0], ends[1], static_cast<TriangleId>(id)});
        }
    }
    return lines;
}

}  // namespace earshot::io
