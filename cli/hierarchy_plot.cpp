// SPDX-License-Identifier: MIT
#include "earshot/base/assert.h"
#include "earshot/cli/hierarchy_report.h"
#include "earshot/io/svg.h"

#include <algorithm>
#include <array>
#include <vector>

namespace earshot::cli {
namespace {

constexpr double kWidth = 720.0, kHeight = 360.0, kMargin = 56.0;  // of the picture
constexpr int kTickSteps = 4;

struct Curve {
    const char* label;
    const char* colour;
    double HierarchyFrame::*steps;
};

constexpr std::array<Curve, 3> kCurves = {
    {{"refit only", "#c03028", &HierarchyFrame::refit_steps},
     {"rebuild always", "#808080", &HierarchyFrame::rebuild_steps},
     {"update", "#2060c0", &HierarchyFrame::update_steps}}};

io::SvgAxis axis(double first, double last, double begin, double end, const char* unit) {
    io::SvgAxis result{first, last, begin, end, {}, unit};
    for (int k = 0; k <= kTickSteps; ++k) {
        result.ticks.push_back(first + (last - first) * k / kTickSteps);
    }
    return result;
}

}  // namespace

std::string hierarchy_plot(const HierarchyReport& report) {
    EARSHOT_ASSERT(!report.frames.empty());
    double max_steps = 1.0;
    for (const HierarchyFrame& frame : report.frames) {
        max_steps =
            std::max({max_steps, frame.refit_steps, frame.rebuild_steps, frame.update_steps});
    }
    const io::SvgAxis time = axis(
        report.frames.front().time, report.frames.back().time, kMargin, kWidth - kMargin, " s");
    const io::SvgAxis steps = axis(0.0, max_steps, kHeight - kMargin, kMargin, "");

    io::SvgPicture picture(kWidth, kHeight, 12.0);
    picture.text({kMargin, 24.0}, "expected steps of a random ray", {.size = 14.0});
    picture.axes(time, steps);
    double legend = kMargin;
    for (const Curve& curve : kCurves) {
        std::vector<io::SvgPoint> points;
        for (const HierarchyFrame& frame : report.frames) {
            points.push_back({time.at(frame.time), steps.at(frame.*curve.steps)});
        }
        picture.polyline(points, curve.colour, 2.0);
        picture.text({legend, 44.0}, curve.label, {.fill = curve.colour});
        legend += 120.0;
    }
    // What the update did, where it did more than a refit.
    for (const HierarchyFrame& frame : report.frames) {
        if (frame.action != bvh::UpdateAction::refit) {
            picture.disc({time.at(frame.time), steps.at(frame.update_steps)},
                         4.0,
                         frame.action == bvh::UpdateAction::rebuild ? "#2060c0" : "white",
                         bvh::name_of(frame.action));
        }
    }
    return picture.str();
}

}  // namespace earshot::cli
