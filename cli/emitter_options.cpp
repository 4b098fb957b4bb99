// SPDX-License-Identifier: MIT
#include "earshot/cli/emitter_options.h"

#include "earshot/cli/values.h"
#include "earshot/io/directivity_file.h"
#include "earshot/io/points.h"

#include <algorithm>
#include <set>
#include <utility>

namespace earshot::cli {
namespace {

using propagation::Emitter;

using io::NamedPosition;

/// In the scene's metres.
std::vector<NamedPosition> parse_points(const CLI::App& app,
                                        const std::string& option,
                                        const std::vector<std::string>& texts,
                                        const io::FileFrame& frame) {
    std::vector<NamedPosition> points;
    for (const std::string& text : texts) {
        const auto point = parse_named_point(text);
        if (!point) {
            throw wrong_usage(app, option, "'" + text + "' is not of the form [NAME=]X,Y,Z");
        }
        const auto& [x, y, z] = point->position;
        points.push_back({point->name, frame.to_scene({x, y, z})});
    }
    return points;
}

/// Points of the command line stand beside the scene's; one of the same name replaces it. Those
/// without a name are numbered.
void add_or_replace(std::vector<NamedPosition> points,
                    const std::string& role,
                    std::vector<Emitter>& emitters) {
    std::size_t unnamed = 0;
    std::set<std::string> given;
    for (NamedPosition& point : points) {
        if (point.name.empty()) {
            point.name = role + std::to_string(++unnamed);
        }
        if (!given.insert(point.name).second) {
            throw Error(role + " \"" + point.name + "\"",
                        "is given twice, and results are stored by name",
                        "give each " + role + " a name of its own");
        }
        const Emitter emitter = {.name = point.name, .node = -1, .position = point.position};
        const auto same = std::find_if(emitters.begin(), emitters.end(), [&](const Emitter& e) {
            return e.name == emitter.name;
        });
        if (same != emitters.end()) {
            *same = emitter;
        } else {
            emitters.push_back(emitter);
        }
    }
}

/// Calls `change` for the emitter of that name, for all if there is no name.
template <class Change>
void change_named(const std::string& name,
                  const std::string& option,
                  std::vector<Emitter>& emitters,
                  const Change& change) {
    bool found = false;
    for (Emitter& emitter : emitters) {
        if (name.empty() || emitter.name == name) {
            change(emitter);
            found = true;
        }
    }
    if (!found) {
        throw Error(option, "the scene has no \"" + name + "\"", "check the name");
    }
}

void set_look_at(const std::vector<NamedPosition>& points,
                 const std::string& option,
                 std::vector<Emitter>& emitters) {
    for (const NamedPosition& point : points) {
        change_named(point.name, option, emitters, [&](Emitter& emitter) {
            emitter.looks_at = point.position;
        });
    }
}

void require_any(const std::vector<Emitter>& emitters,
                 const std::string& role,
                 const std::string& scene_file) {
    if (emitters.empty()) {
        throw Error(scene_file, "the scene has no " + role, "give one with --" + role + " X,Y,Z");
    }
}

}  // namespace

void EmitterOptions::add_to(CLI::App& app) {
    has_listeners_ = true;
    add_repeatable(app, "--source", sources_, "a source at [NAME=]X,Y,Z, in the file's unit");
    add_repeatable(app, "--listener", listeners_, "a listener at [NAME=]X,Y,Z, in the file's unit");
    app.add_option("--listeners", listeners_file_, "a .csv file of listeners: name,x,y,z on a line")
        ->type_name("FILE");
    add_directions_to(app);
    add_repeatable(
        app, "--look-at", looks_, "[NAME=]X,Y,Z: the point that a listener (every one) faces");
}

void EmitterOptions::add_sources_to(CLI::App& app) {
    add_repeatable(app, "--source", sources_, "a source at [NAME=]X,Y,Z, in the file's unit");
    add_directions_to(app);
}

void EmitterOptions::add_directions_to(CLI::App& app) {
    add_repeatable(app,
                   "--directivity",
                   directivities_,
                   "[NAME=]PATTERN of a source (of all): omni, subcardioid, cardioid, "
                   "supercardioid, hypercardioid, figure-of-eight or a .csv file of levels");
    add_repeatable(
        app, "--aim-at", aims_, "[NAME=]X,Y,Z: the point that a source (every source) faces");
}

void EmitterOptions::apply(const CLI::App& app,
                           const SceneChoice& choice,
                           propagation::Scene& scene,
                           bool require_emitters) const {
    const io::FileFrame frame = choice.frame();
    auto listeners = parse_points(app, "--listener", listeners_, frame);
    if (!listeners_file_.empty()) {
        for (const NamedPosition& listener : io::read_named_points(listeners_file_)) {
            listeners.push_back({listener.name, frame.to_scene(listener.position)});
        }
    }
    const auto aims = parse_points(app, "--aim-at", aims_, frame);
    const auto looks = parse_points(app, "--look-at", looks_, frame);
    add_or_replace(parse_points(app, "--source", sources_, frame), "source", scene.sources);
    add_or_replace(std::move(listeners), "listener", scene.listeners);
    if (require_emitters) {
        require_any(scene.sources, "source", choice.file());
    }
    if (require_emitters && has_listeners_) {
        require_any(scene.listeners, "listener", choice.file());
    }
    set_look_at(aims, "--aim-at", scene.sources);
    set_look_at(looks, "--look-at", scene.listeners);
    for (const std::string& text : directivities_) {
        const std::size_t equals = text.find('=');
        const bool is_named = equals != std::string::npos;
        const auto directivity =
            io::directivity_named(is_named ? text.substr(equals + 1) : text, "", "--directivity");
        change_named(is_named ? text.substr(0, equals) : "",
                     "--directivity",
                     scene.sources,
                     [&](Emitter& emitter) { emitter.directivity = directivity; });
    }
}

}  // namespace earshot::cli
