// SPDX-License-Identifier: MIT
#include "earshot/cli/scene_choice.h"

#include "earshot/base/spelling.h"
#include "earshot/cli/formatted.h"
#include "earshot/cli/values.h"

#include <algorithm>
#include <filesystem>

namespace earshot::cli {
namespace {

std::vector<std::string> unit_names() {
    std::vector<std::string> names;
    for (const io::LengthUnit& unit : io::length_units()) {
        names.emplace_back(unit.name);
    }
    return names;
}

}  // namespace

void SceneChoice::add_to(CLI::App& app, const std::string& of_each_frame) {
    app.add_option("SCENE", file_, "a .gltf, .glb, .obj, .ply, .stl or .off file")->required();
    add_reading_to(app);
    if (!of_each_frame.empty()) {
        app.add_option("--frames", frames_, "instants A:B:STEP in seconds, " + of_each_frame)
            ->excludes(app.get_option("--time"));
    }
}

void SceneChoice::add_reading_to(CLI::App& app) {
    add_number(app, "--time", time_, {}, "time in the scene's animation, seconds");
    app.add_option(
        "--animation", animation_, "name or number of the animation; default: the first");
    app.add_option("--units",
                   unit_,
                   "unit of a mesh file and of points given beside it: m, cm, mm, in or ft "
                   "(default: m; glTF is always in metres)")
        ->check(CLI::IsMember(unit_names()));
    app.add_option("--up", up_axis_, "axis of a mesh file that points up: y or z (default: y)")
        ->check(CLI::IsMember({"y", "z"}));
    add_allow_outside(app, allow_outside_);
}

io::LoadedScene SceneChoice::load() const {
    return io::load_scene(
        file_, {.animation = animation_, .frame = frame(), .allow_outside = allow_outside_});
}

io::FileFrame SceneChoice::frame() const {
    return {.metres_per_unit = io::metres_per_unit(unit_).value_or(1.0),
            .up = up_axis_ == "z" ? io::UpAxis::z : io::UpAxis::y};
}

std::vector<double> SceneChoice::times(const CLI::App& app) const {
    if (frames_.empty()) {
        return {time_};
    }
    const auto instants = parse_frames(frames_);
    if (!instants) {
        throw wrong_usage(
            app, "--frames", "'" + frames_ + "' is not of the form A:B:STEP in seconds");
    }
    return *instants;
}

std::string SceneChoice::file_of_frame(const std::string& output, std::size_t frame) const {
    if (!is_sequence()) {
        return output;
    }
    const std::filesystem::path path(output);
    return (path.parent_path() /
            (path.stem().string() + frame_suffix(frame) + path.extension().string()))
        .string();
}

void add_allow_outside(CLI::App& app, bool& allow_outside) {
    app.add_flag("--allow-outside",
                 allow_outside,
                 "let a glTF scene name buffers and images outside of its folder");
}

std::string frame_suffix(std::size_t frame) {
    return formatted("__%04zu", frame);
}

std::uint32_t material_named(const propagation::Scene& scene, const std::string& name) {
    std::vector<std::string> names;
    for (const propagation::Material& material : scene.materials) {
        names.push_back(material.name);
    }
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end()) {
        throw Error(name,
                    "the scene has no such material",
                    did_you_mean(name, names, "check the names of the scene's materials"));
    }
    return static_cast<std::uint32_t>(found - names.begin());
}

}  // namespace earshot::cli
