// SPDX-License-Identifier: MIT
#include "earshot/base/assert.h"
#include "earshot/cli/hierarchy_report.h"

#include <algorithm>
#include <array>
#include <cstdio>

namespace earshot::cli {
namespace {

constexpr double kWidth = 720.0, kHeight = 360.0, kMargin = 56.0;  // pixels

struct Curve {
    const char* label;
    const char* colour;
    double HierarchyFrame::*steps;
};

constexpr std::array<Curve, 3> kCurves = {
    {{"refit only", "#c03028", &HierarchyFrame::refit_steps},
     {"rebuild always", "#808080", &HierarchyFrame::rebuild_steps},
     {"update", "#2060c0", &HierarchyFrame::update_steps}}};

/// Where values stand in the picture.
struct Scale {
    double begin = 0.0, end = 1.0;  // of time
    double max_steps = 1.0;         // of steps

    double x(double time) const {
        const double share = end > begin ? (time - begin) / (end - begin) : 0.5;
        return kMargin + share * (kWidth - 2.0 * kMargin);
    }
    double y(double steps) const {
        return kHeight - kMargin - steps / max_steps * (kHeight - 2.0 * kMargin);
    }
};

template <typename... Values>
std::string formatted(const char* format, Values... values) {
    std::array<char, 256> text{};
    std::snprintf(text.data(), text.size(), format, values...);
    return text.data();
}

std::string axes(const Scale& scale) {
    std::string text = formatted("<path d='M%.1f %.1f V%.1f H%.1f' fill='none' stroke='black'/>\n",
                                 kMargin,
                                 kMargin,
                                 kHeight - kMargin,
                                 kWidth - kMargin);
    for (int k = 0; k <= 4; ++k) {
        const double steps = scale.max_steps * k / 4.0;
        const double time = scale.begin + (scale.end - scale.begin) * k / 4.0;
        text += formatted("<text x='%.1f' y='%.1f' text-anchor='end'>%.3g</text>\n",
                          kMargin - 6.0,
                          scale.y(steps) + 4.0,
                          steps);
        text += formatted("<text x='%.1f' y='%.1f' text-anchor='middle'>%.3g s</text>\n",
                          scale.x(time),
                          kHeight - kMargin + 18.0,
                          time);
    }
    return text;
}

}  // namespace

std::string hierarchy_plot(const HierarchyReport& report) {
    EARSHOT_ASSERT(!report.frames.empty());
    Scale scale = {.begin = report.frames.front().time, .end = report.frames.back().time};
    for (const HierarchyFrame& frame : report.frames) {
        scale.max_steps =
            std::max({scale.max_steps, frame.refit_steps, frame.rebuild_steps, frame.update_steps});
    }
    std::string text = formatted(
        "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 %.0f %.0f' font-family='sans-serif' "
        "font-size='12'>\n<rect width='100%%' height='100%%' fill='white'/>\n",
        kWidth,
        kHeight);
    text += formatted(
        "<text x='%.1f' y='24' font-size='14'>expected steps of a random ray</text>\n", kMargin);
    text += axes(scale);
    double legend = kMargin;
    for (const Curve& curve : kCurves) {
        text +=
            formatted("<polyline fill='none' stroke='%s' stroke-width='2' points='", curve.colour);
        for (const HierarchyFrame& frame : report.frames) {
            text += formatted("%.1f,%.1f ", scale.x(frame.time), scale.y(frame.*curve.steps));
        }
        text += "'/>\n";
        text += formatted(
            "<text x='%.1f' y='44' fill='%s'>%s</text>\n", legend, curve.colour, curve.label);
        legend += 120.0;
    }
    // What the update did, where it did more than a refit.
    for (const HierarchyFrame& frame : report.frames) {
        if (frame.action != bvh::UpdateAction::refit) {
            text += formatted(
                "<circle cx='%.1f' cy='%.1f' r='4' fill='%s'><title>%s</title>"
                "</circle>\n",
                scale.x(frame.time),
                scale.y(frame.update_steps),
                frame.action == bvh::UpdateAction::rebuild ? "#2060c0" : "white",
                std::string(bvh::name_of(frame.action)).c_str());
        }
    }
    return text + "</svg>\n";
}

}  // namespace earshot::cli
