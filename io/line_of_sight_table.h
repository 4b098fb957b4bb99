// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/types.h"
#include "earshot/visibility/visibility_matrix.h"
#include "earshot/visibility/visible_share.h"

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>

namespace earshot::io {

class JsonLines;

/// Writes a visibility matrix as a table without a header: a line per `from` point, a cell per `to`
/// point, 1 where the two are mutually visible and 0 where not.
class LineOfSightCsv {
public:
    void add_row(std::span<const std::uint8_t> seen);
    /// With blockers a cell holds the triangle that blocks first, and is empty where none does.
    void add_row(std::span<const geometry::TriangleId> blockers);
    /// With shares a cell holds how much of the ball about the `to` point is seen, 0 ... 1.
    void add_row(std::span<const visibility::VisibleShare> shares);
    const std::string& text() const noexcept { return text_; }

private:
    std::string text_;
};

/// What the rows of a visibility matrix hold.
enum class SightRows { visible, blockers, shares };

/// Writes a visibility matrix as JSON, for one instant or several: the points, and per instant the
/// rows, as `visible`, as `blockers` with null where two see each other, or as `shares`, each with
/// its error.
class LineOfSightJson {
public:
    LineOfSightJson(std::string_view scene, const visibility::PointSets& points);
    ~LineOfSightJson();
    LineOfSightJson(const LineOfSightJson&) = delete;
    LineOfSightJson& operator=(const LineOfSightJson&) = delete;

    void begin_frame(double time, SightRows rows);
    void add_row(std::span<const std::uint8_t> seen);
    void add_row(std::span<const geometry::TriangleId> blockers);
    void add_row(std::span<const visibility::VisibleShare> shares);
    void end_frame();
    /// To be called once, after the last instant.
    std::string finish();

private:
    std::unique_ptr<JsonLines> lines_;
};

}  // namespace earshot::io
