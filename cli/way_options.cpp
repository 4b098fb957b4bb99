// SPDX-License-Identifier: MIT
#include "earshot/cli/way_options.h"

#include "earshot/base/error.h"
#include "earshot/base/spelling.h"
#include "earshot/io/points.h"

#include <algorithm>
#include <utility>

namespace earshot::cli {
namespace {

using propagation::Emitter;

std::vector<std::string> names_of(const std::vector<Emitter>& emitters) {
    std::vector<std::string> names;
    for (const Emitter& emitter : emitters) {
        names.push_back(emitter.name);
    }
    return names;
}

}  // namespace

void WayOptions::add_to(CLI::App& app) {
    add_repeatable(app,
                   "--path-of",
                   ways_,
                   "NAME=FILE.csv: the way of a source or listener, time,x,y,z on a line")
        ->type_name("NAME=FILE");
}

Ways WayOptions::read(const CLI::App& app,
                      const SceneChoice& choice,
                      const propagation::Scene& scene) const {
    Ways trajectories;
    std::vector<std::string> names = names_of(scene.sources);
    const std::vector<std::string> listeners = names_of(scene.listeners);
    names.insert(names.end(), listeners.begin(), listeners.end());
    for (const std::string& text : ways_) {
        const std::size_t equals = text.find('=');
        if (equals == std::string::npos || equals == 0 || equals + 1 == text.size()) {
            throw wrong_usage(app, "--path-of", "'" + text + "' is not of the form NAME=FILE");
        }
        const std::string name = text.substr(0, equals);
        const std::string file = text.substr(equals + 1);
        if (std::find(names.begin(), names.end(), name) == names.end()) {
            throw Error(name,
                        "the scene has no such source or listener",
                        did_you_mean(name, names, "check the name before ="));
        }
        std::vector<propagation::TrajectoryKey> keys = io::read_trajectory(file);
        for (propagation::TrajectoryKey& key : keys) {
            key.position = choice.to_scene(key.position);
        }
        try {
            if (!trajectories.emplace(name, propagation::Trajectory(std::move(keys))).second) {
                throw Error("--path-of", "'" + name + "' is given twice");
            }
        } catch (const Error& error) {
            throw error.subject() == "trajectory" ? Error(file, error.what(), error.remedy())
                                                  : error;
        }
    }
    return trajectories;
}

std::size_t find_emitter(const std::string& file,
                         const std::vector<Emitter>& emitters,
                         const io::NameChoice& choice) {
    return io::find_name(file, names_of(emitters), choice);
}

}  // namespace earshot::cli
