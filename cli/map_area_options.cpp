// SPDX-License-Identifier: MIT
#include "earshot/cli/map_area_options.h"

#include "earshot/cli/values.h"
#include "earshot/io/points.h"

#include <algorithm>
#include <array>
#include <string_view>

namespace earshot::cli {
namespace {

constexpr double kEarHeight = 1.2;  // metres, of a seated listener (ISO 3382-1)

std::optional<std::array<double, 4>> parse_rectangle(std::string_view text) {
    std::array<double, 4> numbers{};
    return parse_numbers(text, ',', numbers) ? std::optional(numbers) : std::nullopt;
}

}  // namespace

void MapAreaOptions::add_to(CLI::App& app) {
    app.add_option(
           "--rect",
           rectangle_,
           "a rectangle between two corners, X0,Z0,X1,Z1 (of a file with +Z up X0,Y0,X1,Y1), "
           "in the file's unit")
        ->type_name("CORNERS");
    app.add_option("--on", material_, "above the faces of a material that look upwards")
        ->type_name("MATERIAL");
    app.add_option("--points", points_file_, "at the points of a .csv file: x,y,z on a line")
        ->type_name("FILE");
    app.add_option_function<std::string>(
           "--height",
           [this, &app](const std::string& text) {
               height_ = parse_number(text);
               if (!height_) {
                   throw wrong_usage(app, "--height", "'" + text + "' is not a number");
               }
           },
           "height of the rectangle, or above the faces, in the file's unit; default: 1.2 m")
        ->type_name("X");
    add_number(app, "--step", step_, {0.001, 1000.0}, "edge of the smallest cells, metres");
    app.add_option_function<std::string>(
           "--coarse-step",
           [this, &app](const std::string& text) {
               coarse_step_ = parse_number(text);
               if (!coarse_step_ || !(*coarse_step_ > 0.0)) {
                   throw wrong_usage(
                       app, "--coarse-step", "'" + text + "' is not a positive number");
               }
           },
           "edge of the first cells, metres, which are halved where values change; default: four "
           "times --step")
        ->type_name("X");
    add_number(app,
               "--clearance",
               clearance_,
               {0.0, 100.0},
               "least distance of points to surfaces, metres");
}

double MapAreaOptions::coarse_step() const noexcept {
    constexpr double kCoarse = 4.0;
    return coarse_step_.value_or(kCoarse * step_);
}

void MapAreaOptions::check(const CLI::App& app) const {
    const auto given = static_cast<int>(!rectangle_.empty()) +
                       static_cast<int>(!material_.empty()) +
                       static_cast<int>(!points_file_.empty());
    if (given != 1) {
        throw wrong_usage(
            app,
            "map",
            given == 0 ? "no area is given: one of --rect, --on and --points says where"
                       : "several areas are given: only one of --rect, --on and --points can be");
    }
    if (!rectangle_.empty() && !parse_rectangle(rectangle_)) {
        throw wrong_usage(app, "--rect", "'" + rectangle_ + "' is not of the form X0,Z0,X1,Z1");
    }
    if (!points_file_.empty() && (height_ || coarse_step_)) {
        throw wrong_usage(
            app, height_ ? "--height" : "--coarse-step", "--points are where they are");
    }
    if (coarse_step() < step_) {
        throw wrong_usage(app, "--coarse-step", "is less than --step");
    }
}

propagation::MapRectangle MapAreaOptions::rectangle(const CLI::App& app,
                                                    const SceneChoice& choice) const {
    check(app);
    const auto [a0, b0, a1, b1] = *parse_rectangle(rectangle_);
    const io::FileFrame frame = choice.frame();
    const double height = height_.value_or(kEarHeight / frame.metres_per_unit);
    const bool is_z_up = frame.up == io::UpAxis::z;
    const auto corner = [&](double a, double b) {
        return choice.to_scene(is_z_up ? geometry::Vec3(a, b, height)
                                       : geometry::Vec3(a, height, b));
    };
    const geometry::Vec3 first = corner(a0, b0), last = corner(a1, b1);
    return {.x0 = first.x, .z0 = first.z, .x1 = last.x, .z1 = last.z, .height = first.y};
}

propagation::MapArea MapAreaOptions::area(const CLI::App& app,
                                          const SceneChoice& choice,
                                          const propagation::Scene& scene) const {
    if (!rectangle_.empty()) {
        return rectangle(app, choice);
    }
    if (!material_.empty()) {
        const double unit = choice.frame().metres_per_unit;
        return propagation::MapSurface{.material = material_named(scene, material_),
                                       .height = unit * height_.value_or(kEarHeight / unit)};
    }
    propagation::MapPointList points = io::read_points(points_file_);
    std::transform(points.begin(), points.end(), points.begin(), [&](const geometry::Vec3& point) {
        return choice.to_scene(point);
    });
    return points;
}

}  // namespace earshot::cli
