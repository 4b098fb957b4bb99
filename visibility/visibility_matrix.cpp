// SPDX-License-Identifier: MIT
#include "earshot/visibility/visibility_matrix.h"

#include "earshot/visibility/internal/batch_query.h"
#include "earshot/visibility/internal/coherent_order.h"

#include <algorithm>

namespace earshot::visibility {

using geometry::Segment;
using geometry::TriangleId;

namespace {

std::uint8_t cell_of(std::uint8_t visible) noexcept {
    return visible;
}
TriangleId cell_of(const std::optional<Blocker>& blocker) noexcept {
    return blocker ? blocker->triangle : kNoBlocker;
}

/// A matrix whose cells are converted from answers. The columns of a row are queried along a Morton
/// curve, so that consecutive segments, which start together, end close together too.
template <typename Answer, typename Cell>
void make_matrix(const bvh::MeshBvh& bvh,
                 const PointSets& points,
                 const ExclusionMask& excluded,
                 Executor& executor,
                 const std::function<void(std::span<const Cell>)>& take_row) {
    const std::size_t columns = points.to.size();
    const std::vector<std::uint32_t> order = coherent_order(points.to, executor);
    const std::size_t rows_per_batch =
        std::max<std::size_t>(1, kBatchSize / std::max<std::size_t>(1, columns));
    const std::size_t max_rows = std::min(rows_per_batch, points.from.size());
    std::vector<Cell> cells(max_rows * columns);
    std::vector<Segment> segments;
    std::vector<Answer> answers;
    for (std::size_t row = 0; row < points.from.size(); row += rows_per_batch) {
        const std::size_t rows = std::min(rows_per_batch, points.from.size() - row);
        for (std::size_t begin = 0; begin < rows * columns; begin += kBatchSize) {
            const std::size_t count = std::min(kBatchSize, rows * columns - begin);
            segments.resize(count);
            answers.resize(count);
            for (std::size_t i = 0; i < count; ++i) {
                const std::size_t pair = begin + i;
                segments[i] = {points.from[row + pair / columns], points.to[order[pair % columns]]};
            }
            query_batch(bvh, segments, excluded, std::span<Answer>(answers), executor);
            for (std::size_t i = 0; i < count; ++i) {
                const std::size_t pair = begin + i;
                cells[pair / columns * columns + order[pair % columns]] = cell_of(answers[i]);
            }
        }
        for (std::size_t i = 0; i < rows; ++i) {
            take_row(std::span<const Cell>(cells).subspan(i * columns, columns));
        }
    }
}

}  // namespace

void visibility_matrix(const bvh::MeshBvh& bvh,
                       const PointSets& points,
                       const ExclusionMask& excluded,
                       Executor& executor,
                       const std::function<void(std::span<const std::uint8_t>)>& take_row) {
    make_matrix<std::uint8_t, std::uint8_t>(bvh, points, excluded, executor, take_row);
}

void blocker_matrix(const bvh::MeshBvh& bvh,
                    const PointSets& points,
                    const ExclusionMask& excluded,
                    Executor& executor,
                    const std::function<void(std::span<const TriangleId>)>& take_row) {
    make_matrix<std::optional<Blocker>, TriangleId>(bvh, points, excluded, executor, take_row);
}

}  // namespace earshot::visibility
