// SPDX-License-Identifier: MIT
//
// Draws the echogram of a scene's first source and listener as SVG: when each path arrives, how
// strong it is at 1 kHz, and how many reflections it took.
//
//     echogram SCENE ORDER > echogram.svg

#include "earshot/base/error.h"
#include "earshot/base/math.h"
#include "earshot/io/scene_file.h"
#include "earshot/io/svg.h"
#include "earshot/propagation/simulator.h"

#include <array>
#include <cstdio>
#include <cstdlib>
#include <string>

namespace {

using earshot::io::SvgAxis;
using earshot::io::SvgPicture;

constexpr int kOneKilohertz = 5;  // of the octaves 31.5, 63, 125, 250, 500, 1000 Hz ...
constexpr std::array<const char*, 5> kColours = {
    "#111111", "#d1495b", "#edae49", "#00798c", "#8d96a3"};

const SvgAxis kTime{0.0, 200.0, 60.0, 720.0, {0.0, 50.0, 100.0, 150.0, 200.0}, " ms"};
const SvgAxis kLevel{-75.0, -15.0, 280.0, 30.0, {-15.0, -30.0, -45.0, -60.0, -75.0}, " dB"};

void draw_axes(SvgPicture& picture) {
    for (const double level : kLevel.ticks) {
        picture.line({kTime.begin, kLevel.at(level)}, {kTime.end, kLevel.at(level)}, "#ddd");
    }
    picture.axes(kTime, kLevel);
    for (std::size_t order = 0; order < kColours.size(); ++order) {
        picture.text({120.0 + 110.0 * static_cast<double>(order), 325.0},
                     (order == 0 ? "direct, order " : "order ") + std::to_string(order),
                     {.fill = kColours[order]});
    }
}

void draw_path(SvgPicture& picture, const earshot::propagation::Path& path) {
    const double milliseconds = 1e3 * path.delay;
    const double level_db = 20.0 * earshot::math::log10(path.pressure[kOneKilohertz]);
    if (milliseconds <= kTime.last && level_db > kLevel.first) {
        picture.line({kTime.at(milliseconds), kLevel.begin},
                     {kTime.at(milliseconds), kLevel.at(level_db)},
                     kColours[static_cast<std::size_t>(path.order) % kColours.size()],
                     2.0);
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
        SvgPicture picture(760.0, 340.0, 12.0);
        draw_axes(picture);
        for (std::size_t i = pairs[0].paths.size(); i-- > 0;) {
            draw_path(picture, pairs[0].paths[i]);  // early sound on top
        }
        std::fputs(picture.str().c_str(), stdout);
        return 0;
    } catch (const earshot::Error& error) {
        std::fprintf(stderr, "echogram: %s\n", error.line().c_str());
        return 1;
    }
}
