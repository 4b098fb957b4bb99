// SPDX-License-Identifier: MIT
#include "earshot/cli/simulation_choice.h"

#include "earshot/cli/values.h"

#include <string>
#include <string_view>

namespace earshot::cli {
namespace {

constexpr std::string_view kAuto = "auto";

}  // namespace

SimulationChoice::SimulationChoice(const Defaults& defaults)
    : order_(defaults.order),
      rays_error_percent_(defaults.rays_error_percent),
      max_auto_rays_(defaults.max_auto_rays) {}

void SimulationChoice::add_to(CLI::App& app) {
    add_paths_to(app);
    add_rays_to(app);
    add_sound_to(app);
}

void SimulationChoice::add_paths_to(CLI::App& app) {
    add_integer(app,
                "--order",
                order_,
                {0, 64},
                "maximum number of reflections and transmissions of a path");
    app.add_flag("--transmission", transmission_, "also find paths through transmissive materials");
}

void SimulationChoice::add_rays_to(CLI::App& app) {
    app.add_option("--rays",
                   rays_,
                   "of late sound, reverberation and scattering: a number, 0 for none, or auto: "
                   "until T30 and level are certain, at most " +
                       std::to_string(max_auto_rays_))
        ->capture_default_str();
    add_number(app,
               "--rays-error",
               rays_error_percent_,
               {0.1, 100.0},
               "standard error of T30 that --rays auto aims at, percent");
}

void SimulationChoice::add_sound_to(CLI::App& app) {
    app.add_option("--bands", bands_, "octave (31.5 Hz to 16 kHz) or third (20 Hz to 20 kHz)")
        ->check(CLI::IsMember({"octave", "third"}))
        ->capture_default_str();
    add_number(app, "--temperature", air_.temperature_c, {}, "air temperature, degrees Celsius");
    add_number(
        app, "--humidity", air_.humidity_percent, {}, "relative humidity of the air, percent");
    add_number(app, "--pressure", air_.pressure_kpa, {}, "air pressure, kilopascal");
    app.add_flag(
        "--no-air-absorption", no_air_absorption_, "ignore the absorption of sound by air");
}

propagation::Options SimulationChoice::options(const CLI::App& app, std::int64_t seed) const {
    propagation::Options options = {
        .specular_order = static_cast<int>(order_),
        .air = air_,
        .air_absorption = !no_air_absorption_,
        .transmission = transmission_,
        .rays = max_auto_rays_,
        .max_error = rays_error_percent_ / 100.0,
        .seed = static_cast<std::uint64_t>(seed),
        .bands = bands_ == "third" ? audio::Bands::third_octaves() : audio::Bands::octaves()};
    if (rays_ != kAuto) {
        constexpr std::int64_t kMaxRays = 1000000000;
        const auto count = parse_integer_within(rays_, 0, kMaxRays);
        if (!count) {
            throw wrong_usage(
                app,
                "--rays",
                "'" + rays_ + "' is neither auto nor in 0 ... " + std::to_string(kMaxRays));
        }
        options.rays = static_cast<std::size_t>(*count);
        options.max_error = 0.0;
    }
    return options;
}

}  // namespace earshot::cli
