// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/cli/arguments.h"
#include "earshot/io/scene_file.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace earshot::cli {

/// The options that name a scene and instants of its animation.
class SceneChoice {
public:
    /// Must outlive the parsing of the command line. `with_frames`: what comes of each instant;
    /// without it there is only one.
    void add_to(CLI::App& app, const std::string& of_each_frame = "");

    /// The same but for the scene itself, whose file set_file() tells, and frames.
    void add_reading_to(CLI::App& app);
    void set_file(const std::string& file) { file_ = file; }

    const std::string& file() const noexcept { return file_; }

    /// Throws Error as io::load_scene().
    io::LoadedScene load() const;

    /// The name of the unit in which the file is read.
    const std::string& unit() const noexcept { return unit_; }

    /// How the coordinates of the file, and of points given beside it, are meant.
    io::FileFrame frame() const;

    /// A point of the command line or of a table, in the file's unit and axes, in the scene's
    /// metres.
    geometry::Vec3 to_scene(const geometry::Vec3& point) const { return frame().to_scene(point); }

    bool is_sequence() const noexcept { return !frames_.empty(); }

    /// Instants in seconds, at least one. Throws UsageError if --frames is not of its form.
    std::vector<double> times(const CLI::App& app) const;

    /// Where what belongs to an instant is written: `output` itself unless there are several, then
    /// with __0000, __0001, ... before the suffix.
    std::string file_of_frame(const std::string& output, std::size_t frame) const;

private:
    std::string file_, frames_, animation_;
    std::string unit_ = "m", up_axis_ = "y";
    double time_ = 0.0;
    bool allow_outside_ = false;
};

/// "__0000", "__0001", ...
std::string frame_suffix(std::size_t frame);

/// Adds the flag that lets a scene name files outside of its folder.
void add_allow_outside(CLI::App& app, bool& allow_outside);

/// The index of a scene's material. Throws Error, with the nearest name, if there is none.
std::uint32_t material_named(const propagation::Scene& scene, const std::string& name);

}  // namespace earshot::cli
