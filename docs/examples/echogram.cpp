// SPDX-License-Identifier: MIT
//
// Draws the echogram of a scene's first source and listener as SVG: when each path arrives, how
// strong it is at 1 kHz, and how many reflections it took.
//
//     echogram SCENE ORDER > echogram.svg

#include "earshot/base/error.h"
#include "earshot/base/math.h"
#include "earshot/io/scene_file.h"
#include "earshot/propagation/simulator.h"

#include <array>
#include <cstdio>
#include <cstdlib>

namespace {

constexpr int kOneKilohertz = 5;  // of the octaves 31.5, 63, 125, 250, 500, 1000 Hz ...
constexpr double kMostMilliseconds = 200.0, kLeastDb = -75.0, kMostDb = -15.0;
constexpr std::array<const char*, 5> kColours = {
    "#111111", "#d1495b", "#edae49", "#00798c", "#8d96a3"};

double x_of(double milliseconds) {
    return 60.0 + milliseconds / kMostMilliseconds * 660.0;
}
double y_of(double level_db) {
    return 30.0 + (kMostDb - level_db) / (kMostDb - kLeastDb) * 250.0;
}

void draw_axes() {
    std::puts(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"760\" height=\"340\" "
        "font-family=\"sans-serif\" font-size=\"12\">\n"
        "<rect width=\"760\" height=\"340\" fill=\"white\"/>");
    for (double time = 0.0; time <= kMostMilliseconds; time += 50.0) {
        std::printf(
            "<text x=\"%.0f\" y=\"300\" text-anchor=\"middle\">%.0f ms</text>\n", x_of(time), time);
    }
    for (double level = kMostDb; level >= kLeastDb; level -= 15.0) {
        std::printf(
            "<path d=\"M60 %.1fH720\" stroke=\"#ddd\"/>"
            "<text x=\"52\" y=\"%.1f\" text-anchor=\"end\">%.0f dB</text>\n",
            y_of(level),
            y_of(level) + 4.0,
            level);
    }
    for (std::size_t order = 0; order < kColours.size(); ++order) {
        std::printf("<text x=\"%zu\" y=\"325\" fill=\"%s\">%s%zu</text>\n",
                    120 + 110 * order,
                    kColours[order],
                    order == 0 ? "direct, order " : "order ",
                    order);
    }
}

void draw_path(const earshot::propagation::Path& path) {
    const double milliseconds = 1e3 * path.delay;
    const double level_db = 20.0 * earshot::math::log10(path.pressure[kOneKilohertz]);
    if (milliseconds <= kMostMilliseconds && level_db > kLeastDb) {
        std::printf("<path d=\"M%.1f %.1fV%.1f\" stroke=\"%s\" stroke-width=\"2\"/>\n",
                    x_of(milliseconds),
                    y_of(kLeastDb),
                    y_of(level_db),
                    kColours[static_cast<std::size_t>(path.order) % kColours.size()]);
    }
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 3) {
        std::fputs("usage: echogram SCENE ORDER\n", stderr);
        return 2;
    }
    try {
        const auto loaded = earshot::io::load_scene(argv[1]);
        earshot::propagation::Simulator simulator(loaded.scene,
                                                  {.specular_order = std::atoi(argv[2])});
        const auto pairs = simulator.run();
        draw_axes();
        for (std::size_t i = pairs[0].paths.size(); i-- > 0;) {
            draw_path(pairs[0].paths[i]);  // early sound on top
        }
        std::puts("</svg>");
        return 0;
    } catch (const earshot::Error& error) {
        std::fprintf(stderr, "echogram: %s\n", error.line().c_str());
        return 1;
    }
}
