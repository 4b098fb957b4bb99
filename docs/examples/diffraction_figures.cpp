// SPDX-License-Identifier: MIT
//
// Draws what edges do to sound, as SVG: the insertion loss of a screen over its Fresnel number, the
// level behind a plate and behind a barrier, and the level in a room whose door opens.
//
//     diffraction_figures scenes/door.gltf ORDER > diffraction.svg

#include "earshot/base/error.h"
#include "earshot/base/math.h"
#include "earshot/geometry/wedge.h"
#include "earshot/io/scene_file.h"
#include "earshot/io/svg.h"
#include "earshot/propagation/diffraction.h"
#include "earshot/propagation/second_order_diffraction.h"
#include "earshot/propagation/simulator.h"

#include <glm/geometric.hpp>

#include <array>
#include <cmath>
#include <complex>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

namespace {

using earshot::geometry::Vec3;
using earshot::geometry::Wedge;
using earshot::io::SvgAxis;
using earshot::io::SvgPicture;
using earshot::io::SvgPoint;
using Complex = std::complex<double>;

namespace math = earshot::math;
namespace propagation = earshot::propagation;

constexpr double kSpeedOfSound = 343.0;
constexpr std::array<const char*, 3> kColours = {"#d1495b", "#00798c", "#8d96a3"};

double wave_number(double hertz) {
    return 2.0 * math::kPi * hertz / kSpeedOfSound;
}

double decibels(double energy) {
    return 10.0 * math::log10(energy);
}

/// A diagram in a quarter of the picture.
class Panel {
public:
    Panel(SvgPicture& picture,
          const SvgPoint& corner,
          const std::string& title,
          const SvgAxis& x,
          const SvgAxis& y)
        : picture_(picture), corner_(corner), x_(x), y_(y) {
        x_.begin = corner.x + 45.0;
        x_.end = corner.x + 350.0;
        y_.begin = corner.y + 225.0;
        y_.end = corner.y + 30.0;
        for (const double tick : y_.ticks) {
            picture_.line({x_.begin, y_.at(tick)}, {x_.end, y_.at(tick)}, "#ddd");
        }
        picture_.axes(x_, y_);
        picture_.text({corner.x + 45.0, corner.y + 18.0}, title);
    }

    /// Parts of the line outside of the diagram are left out.
    void line(const std::vector<std::pair<double, double>>& values, const std::string& name) {
        std::vector<std::vector<SvgPoint>> lines(1);
        for (const auto& [x, y] : values) {
            if (y >= y_.first && y <= y_.last) {
                lines.back().push_back({x_.at(x), y_.at(y)});
            } else if (!lines.back().empty()) {
                lines.emplace_back();
            }
        }
        const char* colour = kColours[lines_ % kColours.size()];
        picture_.polylines(lines, colour, 1.5);
        picture_.text({corner_.x + 45.0 + 105.0 * static_cast<double>(lines_), corner_.y + 262.0},
                      name,
                      {.fill = colour});
        ++lines_;
    }

private:
    SvgPicture& picture_;
    SvgPoint corner_;
    SvgAxis x_, y_;
    std::size_t lines_ = 0;
};

propagation::EdgeDiffraction whole_edge(const Wedge& wedge,
                                        const Vec3& source,
                                        const Vec3& listener) {
    propagation::EdgeDiffraction edge;
    edge.open_angle = wedge.open_angle;
    edge.source = earshot::geometry::wedge_coordinates(wedge, source);
    edge.listener = earshot::geometry::wedge_coordinates(wedge, listener);
    edge.z_end = wedge.length();
    return edge;
}

Complex over_two(const Wedge& first,
                 const Wedge& second,
                 const Vec3& source,
                 const Vec3& listener,
                 int face,
                 double k) {
    propagation::DoubleDiffraction edges;
    edges.first = first;
    edges.second = second;
    edges.source = source;
    edges.listener = listener;
    edges.first_end = first.length();
    edges.second_end = second.length();
    edges.common_face = propagation::DoubleDiffraction::CommonFace{face, face};
    return propagation::second_order_pressure(edges, k);
}

/// A half plane, source and listener 10 m from its edge and 10 degrees below it.
void draw_screen(SvgPicture& picture) {
    Panel panel(picture,
                {0.0, 0.0},
                "Insertion loss of a screen, Fresnel number",
                {-1.5, 2.0, 0.0, 1.0, {-1.0, 0.0, 1.0, 2.0}, " = log N"},
                {0.0, 40.0, 0.0, 1.0, {0.0, 10.0, 20.0, 30.0, 40.0}, " dB"});
    propagation::EdgeDiffraction edge;
    edge.open_angle = 2.0 * math::kPi;
    edge.source = {10.0, math::kPi * 80.0 / 180.0, 0.0};
    edge.listener = {10.0, math::kPi * 280.0 / 180.0, 0.0};
    edge.z_begin = -1e4;
    edge.z_end = 1e4;
    const double direct = 20.0 * math::cos(math::kPi / 18.0);
    std::vector<std::pair<double, double>> exact, chart;
    for (int i = -60; i <= 80; ++i) {
        const double fresnel_number = math::pow10(i / 40.0);
        const double k = math::kPi * fresnel_number / (20.0 - direct);
        const Complex found = propagation::diffracted_pressure(edge, k).total() * direct;
        exact.emplace_back(i / 40.0, -decibels(std::norm(found)));
        chart.emplace_back(i / 40.0, decibels(3.0 + 20.0 * fresnel_number));
    }
    panel.line(exact, "exact");
    panel.line(chart, "Maekawa's chart");
}

/// A plate of 1.0 x 0.7 m at 400 Hz. Listeners 1 m behind its middle, turned by an angle.
void draw_plate(SvgPicture& picture) {
    Panel panel(picture,
                {380.0, 0.0},
                "Behind a plate of 1.0 x 0.7 m at 400 Hz, re free field",
                {-60.0, 60.0, 0.0, 1.0, {-60.0, -30.0, 0.0, 30.0, 60.0}, " deg"},
                {-18.0, 6.0, 0.0, 1.0, {-18.0, -12.0, -6.0, 0.0, 6.0}, " dB"});
    const std::array<Vec3, 4> corners{
        Vec3(-0.5, -0.35, 0.0), Vec3(0.5, -0.35, 0.0), Vec3(0.5, 0.35, 0.0), Vec3(-0.5, 0.35, 0.0)};
    std::vector<Wedge> edges;
    for (std::size_t i = 0; i < 4; ++i) {
        edges.push_back(earshot::geometry::make_wedge(
            corners[i], corners[(i + 1) % 4], Vec3(0.0), 2.0 * math::kPi));
    }
    const Vec3 source(0.13, -0.08, 1.2);
    const double k = wave_number(400.0);
    std::vector<std::pair<double, double>> first, both;
    for (int angle = -60; angle <= 60; angle += 3) {
        const double turn = math::kPi * angle / 180.0;
        const Vec3 listener(math::sin(turn), 0.02, -math::cos(turn));
        const double distance = glm::distance(source, listener);
        const Vec3 crossing = source + source.z / (source.z - listener.z) * (listener - source);
        Complex one{0.0}, two{0.0};
        if (std::abs(crossing.x) > 0.5 || std::abs(crossing.y) > 0.35) {
            one += Complex(math::cos(k * distance), -math::sin(k * distance)) / distance;
        }
        for (std::size_t a = 0; a < 4; ++a) {
            one +=
                propagation::diffracted_pressure(whole_edge(edges[a], source, listener), k).total();
            for (std::size_t b = 0; b < 4; ++b) {
                for (int face = 0; a != b && face < 2; ++face) {
                    two += over_two(edges[a], edges[b], source, listener, face, k);
                }
            }
        }
        first.emplace_back(angle, decibels(std::norm(one * distance)));
        both.emplace_back(angle, decibels(std::norm((one + two) * distance)));
    }
    panel.line(first, "one edge");
    panel.line(both, "one and two edges");
}

/// A barrier 1 m thick and 8 m long. Listeners 3 m behind it, from below to above its top.
void draw_barrier(SvgPicture& picture) {
    Panel panel(picture,
                {0.0, 290.0},
                "Behind a barrier 1 m thick at 250 Hz, re free field",
                {-2.0, 1.5, 0.0, 1.0, {-2.0, -1.0, 0.0, 1.0}, " m"},
                {-30.0, 0.0, 0.0, 1.0, {-30.0, -20.0, -10.0, 0.0}, " dB"});
    const double outer = 1.5 * math::kPi;
    const Wedge near_edge =
        earshot::geometry::make_wedge({-0.5, 0, -4}, {-0.5, 0, 4}, {0.5, 0, -4}, outer);
    const Wedge far_edge =
        earshot::geometry::make_wedge({0.5, 0, 4}, {0.5, 0, -4}, {-0.5, 0, 4}, outer);
    const Vec3 source(-3.5, -1.5, 0.0);
    const double k = wave_number(250.0);
    std::vector<std::pair<double, double>> first, both;
    for (int i = -200; i <= 150; i += 5) {
        const Vec3 listener(3.5, 0.01 * i + 1e-6, 0.3);
        const double distance = glm::distance(source, listener);
        // The far edge hides the near one from listeners below the top.
        const Complex one = listener.y < 0.0 ? Complex(0.0)
                                             : propagation::diffracted_pressure(
                                                   whole_edge(near_edge, source, listener), k)
                                                   .total();
        const Complex two = over_two(near_edge, far_edge, source, listener, 0, k);
        first.emplace_back(0.01 * i, decibels(std::norm(one * distance) + 1e-12));
        both.emplace_back(0.01 * i, decibels(std::norm((one + two) * distance)));
    }
    panel.line(first, "one edge");
    panel.line(both, "one and two edges");
}

/// The study of the scene hears a source in the hall through a door that opens.
void draw_door(SvgPicture& picture, const propagation::Scene& scene, int order) {
    Panel panel(picture,
                {380.0, 290.0},
                "G of early sound through a door that opens",
                {0.0, 100.0, 0.0, 1.0, {0.0, 20.0, 40.0, 60.0, 80.0, 100.0}, " deg"},
                {-40.0, 20.0, 0.0, 1.0, {-40.0, -20.0, 0.0, 20.0}, " dB"});
    constexpr std::array<std::size_t, 2> kBands{2, 7};  // 125 Hz and 4 kHz
    std::array<std::vector<std::pair<double, double>>, 3> lines;
    for (const int diffraction : {1, 0}) {
        propagation::Simulator simulator(
            scene, {.specular_order = order, .diffraction = diffraction, .air_absorption = false});
        for (int angle = 0; angle <= 100; angle += 4) {
            constexpr double kDegreesPerSecond = 50.0;
            simulator.set_time(angle / kDegreesPerSecond);
            for (const propagation::PairResult& pair : simulator.run()) {
                if (scene.listeners[pair.listener].name != "study_listener") {
                    continue;
                }
                std::array<double, 2> energy{};
                for (const auto& arrival : propagation::energy_arrivals_of(pair)) {
                    for (std::size_t i = 0; i < kBands.size(); ++i) {
                        const double pressure = 10.0 * arrival.pressure[kBands[i]];
                        energy[i] += pressure * pressure;
                    }
                }
                if (diffraction == 1) {
                    lines[0].emplace_back(angle, decibels(energy[0] + 1e-12));
                    lines[1].emplace_back(angle, decibels(energy[1] + 1e-12));
                } else {
                    lines[2].emplace_back(angle, decibels(energy[1] + 1e-12));
                }
            }
        }
    }
    panel.line(lines[0], "125 Hz");
    panel.line(lines[1], "4 kHz");
    panel.line(lines[2], "4 kHz without edges");
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 3) {
        std::fputs("usage: diffraction_figures DOOR ORDER\n", stderr);
        return 2;
    }
    try {
        const auto loaded = earshot::io::load_scene(argv[1]);
        SvgPicture picture(760.0, 580.0, 12.0, "Edge diffraction");
        draw_screen(picture);
        draw_plate(picture);
        draw_barrier(picture);
        draw_door(picture, loaded.scene, std::atoi(argv[2]));
        std::fputs(picture.str().c_str(), stdout);
        return 0;
    } catch (const earshot::Error& error) {
        std::fprintf(stderr, "diffraction_figures: %s\n", error.line().c_str());
        return 1;
    }
}
