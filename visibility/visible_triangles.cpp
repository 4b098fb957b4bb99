// SPDX-License-Identifier: MIT
#include "earshot/visibility/visible_triangles.h"

#include "earshot/base/assert.h"
#include "earshot/visibility/internal/cube_face.h"
#include "earshot/visibility/internal/visible_search.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

namespace earshot::visibility {

using geometry::TriangleId;
using geometry::Vec3;

namespace {

/// Pixels are cast in tiles of 8 x 8, which traverse the tree as one ray packet.
constexpr std::size_t kTile = 8;

/// About so many pixels are held at a time.
constexpr std::size_t kPixelsPerBatch = std::size_t{1} << 18U;

/// The number of pixels along a face's edge: neighbours are `resolution` apart at most, in the
/// middle of a face, and no tile crosses a middle line of the face, where directions change their
/// signs.
std::size_t pixels_along_edge(double resolution) {
    const double pixels = 1.0 / math::tan(resolution / 2.0);
    constexpr std::size_t kStep = 2 * kTile;
    return static_cast<std::size_t>(std::ceil(pixels / static_cast<double>(kStep))) * kStep;
}

/// Pixels of some rows of a face, a whole number of tiles high, in the order of their tiles.
class Strip {
public:
    Strip(const CubeFace& face, std::size_t pixels, std::size_t begin, std::size_t rows)
        : face_(face),
          pixels_(pixels),
          begin_(begin),
          rows_(rows),
          directions_(pixels * rows),
          solid_angles_(pixels * rows) {}

    void prepare(Executor& executor) {
        executor.for_each(rows_ / kTile, 1, [&](std::size_t first, std::size_t last) {
            for (std::size_t row = first * kTile; row < last * kTile; ++row) {
                prepare_row(row);
            }
        });
    }

    std::size_t pixel_index(std::size_t row, std::size_t column) const noexcept {
        return row / kTile * kTile * pixels_ + column / kTile * kTile * kTile +
               row % kTile * kTile + column % kTile;
    }
    const std::vector<Vec3>& directions() const noexcept { return directions_; }
    double solid_angle(std::size_t pixel) const noexcept { return solid_angles_[pixel]; }

    /// The direction of a pixel, counted from the strip's first row; it may lie off the face.
    Vec3 direction(std::ptrdiff_t row, std::ptrdiff_t column) const noexcept {
        return face_.direction(
            static_cast<double>(column) + 0.5,
            static_cast<double>(row + static_cast<std::ptrdiff_t>(begin_)) + 0.5);
    }

private:
    void prepare_row(std::size_t row) {
        double last = face_.corner_angle(0, begin_ + row + 1) - face_.corner_angle(0, begin_ + row);
        for (std::size_t column = 0; column < pixels_; ++column) {
            const double next = face_.corner_angle(column + 1, begin_ + row + 1) -
                                face_.corner_angle(column + 1, begin_ + row);
            const std::size_t at = pixel_index(row, column);
            directions_[at] =
                direction(static_cast<std::ptrdiff_t>(row), static_cast<std::ptrdiff_t>(column));
            solid_angles_[at] = next - last;
            last = next;
        }
    }

    const CubeFace& face_;
    std::size_t pixels_, begin_, rows_;
    std::vector<Vec3> directions_;
    std::vector<double> solid_angles_;
};

/// The item buffer over the sphere of directions, a few rows at a time.
class ItemBufferPass {
public:
    ItemBufferPass(VisibleSearch& search,
                   const VisibleTrianglesOptions& options,
                   Executor& executor,
                   Progress* progress)
        : search_(search),
          refine_(options.refine),
          pixels_(pixels_along_edge(options.resolution)),
          executor_(executor),
          progress_(progress) {}

    void run() {
        const std::size_t strips = std::max<std::size_t>(1, kPixelsPerBatch / (pixels_ * kTile));
        for (std::size_t face = 0; face < CubeFace::kFaces; ++face) {
            const CubeFace cube_face(face, pixels_);
            row_above_.clear();
            for (std::size_t row = 0; row < pixels_; row += strips * kTile) {
                const std::size_t rows = std::min(strips * kTile, pixels_ - row);
                Strip strip(cube_face, pixels_, row, rows);
                strip.prepare(executor_);
                add_strip(strip, rows, row + rows == pixels_);
                if (progress_ != nullptr) {
                    progress_->report(
                        "rows", face * pixels_ + row + rows, CubeFace::kFaces * pixels_);
                }
            }
        }
    }

private:
    /// Casts and counts the pixels of a strip, and refines the intervals between them.
    void add_strip(const Strip& strip, std::size_t rows, bool is_last) {
        const std::vector<TriangleId> visible = search_.cast(strip.directions());
        const bool is_first = row_above_.empty();
        std::vector<DirectionInterval> intervals;
        std::vector<DirectionSample> row(pixels_);
        for (std::size_t r = 0; r < rows; ++r) {
            for (std::size_t c = 0; c < pixels_; ++c) {
                const std::size_t pixel = strip.pixel_index(r, c);
                row[c] = {strip.directions()[pixel], visible[pixel]};
                search_.count_pixel(visible[pixel], strip.solid_angle(pixel));
                if (c > 0) {
                    add_interval(row[c - 1], row[c], intervals);
                }
                if (!row_above_.empty()) {
                    add_interval(row_above_[c], row[c], intervals);
                }
            }
            row_above_.swap(row);
            row.resize(pixels_);
        }
        if (refine_) {
            search_.subdivide(std::move(intervals));
            refine_face_edges(strip, rows, visible, is_first, is_last);
        }
    }

    void add_interval(const DirectionSample& first,
                      const DirectionSample& second,
                      std::vector<DirectionInterval>& intervals) const {
        const DirectionInterval interval{first, second};
        if (refine_ && first.triangle != second.triangle &&
            search_.needs_subdivision(interval, std::numeric_limits<double>::infinity())) {
            intervals.push_back(interval);
        }
    }

    /// Refines the intervals between this face and its neighbours.
    void refine_face_edges(const Strip& strip,
                           std::size_t rows,
                           const std::vector<TriangleId>& visible,
                           bool is_first,
                           bool is_last) {
        std::vector<DirectionSample> inside;
        std::vector<Vec3> outside;
        const auto add = [&](std::size_t r, std::size_t c, int down, int right) {
            const std::size_t pixel = strip.pixel_index(r, c);
            inside.push_back({strip.directions()[pixel], visible[pixel]});
            outside.push_back(strip.direction(static_cast<std::ptrdiff_t>(r) + down,
                                              static_cast<std::ptrdiff_t>(c) + right));
        };
        for (std::size_t r = 0; r < rows; ++r) {
            add(r, 0, 0, -1);
            add(r, pixels_ - 1, 0, 1);
        }
        for (std::size_t c = 0; c < pixels_; ++c) {
            if (is_first) {
                add(0, c, -1, 0);
            }
            if (is_last) {
                add(rows - 1, c, 1, 0);
            }
        }
        const std::vector<TriangleId> beyond = search_.cast(outside);
        std::vector<DirectionInterval> intervals;
        for (std::size_t i = 0; i < inside.size(); ++i) {
            add_interval(inside[i], {outside[i], beyond[i]}, intervals);
        }
        search_.subdivide(std::move(intervals));
    }

    VisibleSearch& search_;
    bool refine_;
    std::size_t pixels_;
    Executor& executor_;
    Progress* progress_;
    std::vector<DirectionSample> row_above_;  // the last row cast; empty at a face's beginning
};

}  // namespace

VisibleTriangles visible_triangles(const bvh::MeshBvh& bvh,
                                   const Vec3& point,
                                   const VisibleTrianglesOptions& options,
                                   Executor& executor,
                                   Progress* progress) {
    EARSHOT_ASSERT(options.resolution >= VisibleTrianglesOptions::kMinResolution &&
                   options.resolution <= VisibleTrianglesOptions::kMaxResolution);
    EARSHOT_ASSERT(options.min_gap > 0.0 && options.border_angle > 0.0);
    VisibleSearch search(bvh, point, options, executor);
    ItemBufferPass(search, options, executor, progress).run();
    if (options.refine) {
        search.sample_borders(progress);
        search.aim_at_missing(progress);
        search.sample_borders(progress);
    }
    return search.finish();
}

}  // namespace earshot::visibility
