// SPDX-License-Identifier: MIT
#include "fuzz/readers.h"

#include "earshot/base/error.h"
#include "earshot/io/arrivals.h"
#include "earshot/io/contact_queries.h"
#include "earshot/io/directivity_file.h"
#include "earshot/io/internal/hrir_set.h"
#include "earshot/io/internal/sofa_file.h"
#include "earshot/io/material_assignments.h"
#include "earshot/io/path_frames.h"
#include "earshot/io/points.h"
#include "earshot/io/report_contacts.h"
#include "earshot/io/report_map.h"
#include "earshot/io/scene_file.h"
#include "earshot/io/visibility_file.h"
#include "earshot/io/wav.h"
#include "earshot/io/whole_file.h"
#include "earshot/propagation/room_shapes.h"

#include <nlohmann/json.hpp>

#include "fuzz/input_file.h"
#include "fuzz/repair.h"
#include <algorithm>
#include <cmath>
#include <map>
#include <new>
#include <stdexcept>

namespace earshot::test {
namespace {

namespace fs = std::filesystem;
using geometry::Vec3;

/// What a reader promises of its result. Throws std::logic_error, which is a finding.
void require(bool is_true, const char* promise) {
    if (!is_true) {
        throw std::logic_error(promise);
    }
}

bool is_finite(const Vec3& p) {
    return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

void require_sound_mesh(const geometry::AnimatedMesh& mesh) {
    for (const geometry::Triangle& triangle : mesh.triangles()) {
        for (const geometry::VertexId vertex : triangle) {
            require(vertex < mesh.vertex_count(), "triangles name vertices of the mesh");
        }
    }
    for (const Vec3& position : mesh.positions_at(0.0)) {
        require(is_finite(position), "positions are finite at time 0");
    }
    mesh.positions_at(mesh.duration() / 3.0);
    require(mesh.mesh_of_triangle().size() == mesh.triangles().size(),
            "every triangle belongs to a mesh");
    for (const std::uint32_t number : mesh.mesh_of_triangle()) {
        require(number < mesh.mesh_names().size(), "every mesh has a name");
    }
}

void read_scene(const fs::path& file) {
    const io::LoadedScene loaded = io::load_scene(file);
    const propagation::Scene& scene = loaded.scene;
    require_sound_mesh(scene.mesh);
    require(scene.material_of_triangle.size() == scene.mesh.triangles().size(),
            "every triangle has a material");
    for (const std::uint32_t material : scene.material_of_triangle) {
        require(material < scene.materials.size(), "materials of triangles exist");
    }
    for (const std::uint32_t material : loaded.default_materials) {
        require(material < scene.materials.size(), "materials without data exist");
    }
    for (const auto* emitters : {&scene.sources, &scene.listeners}) {
        for (const propagation::Emitter& emitter : *emitters) {
            require(is_finite(scene.pose_at(emitter, 0.0).position), "emitters have a place");
        }
    }
    io::warnings_of_acoustics(loaded);
}

void read_materials(const fs::path& file) {
    Warnings warnings;
    const auto assignments = io::read_material_assignments(file, warnings);
    io::LoadedScene loaded;
    for (const char* name : {"Carpet 1", "Wall", "aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa"}) {
        loaded.scene.materials.emplace_back().name = name;
    }
    io::assign_materials(assignments, loaded);
    for (const io::MaterialAssignment& assignment : assignments) {
        propagation::validate(assignment.material);
    }
}

void read_points(const fs::path& file) {
    for (const Vec3& point : io::read_points(file)) {
        require(is_finite(point), "points are finite");
    }
}

void read_listeners(const fs::path& file) {
    for (const io::NamedPosition& point : io::read_named_points(file)) {
        require(is_finite(point.position) && !point.name.empty(), "listeners have name and place");
    }
}

void read_arrivals(const fs::path& file) {
    static const propagation::Scene kScene = [] {
        propagation::Scene scene = propagation::shoebox_room({5.0, 3.0, 4.0});
        scene.sources.push_back({.name = "talker"});
        scene.listeners.push_back({.name = "seat 1"});
        scene.listeners.push_back({.name = "seat 2"});
        return scene;
    }();
    for (const propagation::MeasuredArrival& arrival : io::read_arrivals(file, kScene).arrivals) {
        require(
            arrival.source < kScene.sources.size() && arrival.listener < kScene.listeners.size(),
            "arrivals are of pairs of the scene");
        require(arrival.time >= 0.0 && std::isfinite(arrival.time), "times are numbers from 0 up");
        for (const std::string& name : arrival.surfaces.value_or(std::vector<std::string>{})) {
            require(!name.empty(), "surfaces have names");
        }
    }
}

void read_contact_queries(const fs::path& file) {
    for (const io::ContactQuery& query : io::read_contact_queries(file)) {
        for (const auto& points : {query.points.begin, query.points.end}) {
            for (const auto& point : points) {
                for (const auto& number : point) {
                    require(!number.numerator.empty() && number.denominator != "0",
                            "coordinates are rational numbers");
                }
            }
        }
    }
}

void read_directivity(const fs::path& file) {
    const propagation::Directivity directivity = io::read_directivity(file);
    for (const Vec3& towards : {Vec3(1, 0, 0), Vec3(-0.6, 0, 0.8), Vec3(0, -1, 0), Vec3(0, 0, 1)}) {
        const auto pressure = directivity.pressure(audio::Bands::octaves(), towards);
        for (std::size_t band = 0; band < audio::Bands::octaves().count(); ++band) {
            require(std::isfinite(pressure[band]), "pressures of a directivity are finite");
        }
    }
}

void read_wav(const fs::path& file) {
    const io::Sound sound = io::read_sound(file);
    require(sound.channels >= 1 && sound.sample_rate > 0.0, "sounds have channels and a rate");
    require(sound.samples.size() % static_cast<std::size_t>(sound.channels) == 0,
            "sounds consist of whole frames");
}

/// What the process that reads a SOFA file by HDF5 hands back, and the set that is made of it.
void read_sofa_reply(const fs::path& file) {
    const std::string name = file.string();
    audio::HrirSet set;
    try {
        set = io::hrir_set_of(io::decode_sofa_reply(io::read_whole_file(file), name), name);
    } catch (const Error&) {
        // Its text is that of the input, which may say anything.
        throw Error(name, "is no reply");
    }
    require(std::isfinite(set.sample_rate) && set.sample_rate > 0.0, "sets have a sample rate");
    for (const audio::Hrir& hrir : set.directions) {
        const auto& [x, y, z] = hrir.towards;
        require(std::abs(x * x + y * y + z * z - 1.0) < 1e-12, "directions are unit vectors");
        require(std::isfinite(hrir.distance) && hrir.distance > 0.0, "distances are positive");
        require(!hrir.left.empty() && hrir.left.size() == hrir.right.size(),
                "both ears have responses of one length");
        for (const auto* ear : {&hrir.left, &hrir.right}) {
            for (const double sample : *ear) {
                require(std::isfinite(sample), "responses are finite");
            }
        }
    }
}

void read_visible_sets(const fs::path& file) {
    const visibility::VisibleSets sets = io::read_visible_sets(file);
    const std::size_t triangles = sets.objects().object_of_triangle().size();
    for (std::size_t cell = 0; cell < sets.cells().size(); ++cell) {
        const auto number = static_cast<visibility::CellId>(cell);
        for (const geometry::TriangleId triangle : sets.triangles_visible_from(number)) {
            require(triangle < triangles && sets.contains(number, triangle),
                    "visible triangles are contained in the set");
        }
    }
    if (sets.history()) {
        require(sets.merged(1).cells().size() == 1, "histories lead to one cell");
    }
}

io::ReportFile report_file(const fs::path& file) {
    return {.name = file.filename().string(), .text = io::read_whole_file(file)};
}

void require_page_data(const std::string& data) {
    require(nlohmann::json::accept(data), "the data of pages is JSON");
}

void read_contact_results(const fs::path& file) {
    const io::ContactReport report = io::read_contacts(report_file(file));
    for (const io::ContactStep& step : report.steps) {
        for (const collision::Contact& contact : step.contacts) {
            for (const collision::Element& element : {contact.a, contact.b}) {
                require(element.mesh < report.meshes.size(), "meshes of contacts have a name");
                require(element.size >= 1 && element.size <= element.vertices.size(),
                        "elements are vertices, edges or faces");
            }
        }
    }
    require_page_data(io::encode_contacts_page({.title = "fuzz", .contacts = report}));
}

void read_map_results(const fs::path& file) {
    require_page_data(io::encode_map_page({.title = "fuzz", .map = report_file(file)}));
}

/// Several files of results in one: each begins behind a line "=== NAME".
void read_room_results(const fs::path& file) {
    constexpr std::string_view kMark = "=== ";
    const std::string text = io::read_whole_file(file);
    io::RoomReport report{.title = "fuzz",
                          .reference_name = "before",
                          .limits = {{"sti", 0.6}, {"t30", 0.8}, {"c80", 0.0}}};
    const std::map<std::string_view, io::ReportFile*> parts = {{"metrics", &report.metrics},
                                                               {"paths", &report.paths},
                                                               {"histograms", &report.histograms},
                                                               {"sensitivity", &report.sensitivity},
                                                               {"reference", &report.reference}};
    std::size_t begin = text.find(kMark);
    if (begin == std::string::npos) {
        throw Error(file.string(), "holds no results");
    }
    while (begin != std::string::npos) {
        begin += kMark.size();
        const std::size_t end = std::min(text.find(kMark, begin), text.size());
        const std::size_t line = std::min(text.find('\n', begin), end);
        const auto part = parts.find(std::string_view(text).substr(begin, line - begin));
        if (part != parts.end()) {
            *part->second = {.name = std::string(part->first),
                             .text = text.substr(line, end - line)};
        }
        begin = end < text.size() ? end : std::string::npos;
    }
    require_page_data(io::encode_room_report(report));
}

void require_sound_path(const propagation::Path& path) {
    require(path.points.size() == path.triangles.size() + 2, "paths have a point per interaction");
    require(path.transmitted.empty() || path.transmitted.size() == path.triangles.size(),
            "what lets sound pass is told of all interactions or of none");
    require(path.edges.size() == (path.kind == propagation::PathKind::diffracted ? 1 : 0),
            "diffracted paths alone bend round an edge");
    for (const Vec3& point : path.points) {
        require(is_finite(point), "points of paths are finite");
    }
    for (const double pressure : path.pressure) {
        require(std::isfinite(pressure), "pressures of paths are finite");
    }
}

/// The paths, and a recording of a few samples played over them.
void read_path_frames(const fs::path& file) {
    constexpr double kRate = 8000.0;
    constexpr double kRecording[] = {1.0, -0.5, 0.25};
    const std::vector<io::PairPathFrames> pairs = io::read_path_frames(file);
    require(!pairs.empty(), "files of paths have a pair");
    for (const io::PairPathFrames& pair : pairs) {
        double last = -INFINITY;
        for (const propagation::PathFrame& frame : pair.frames.instants) {
            require(frame.time > last, "times of instants ascend");
            last = frame.time;
            require(is_finite(frame.listener_front) && is_finite(frame.listener_up),
                    "listeners are turned by finite axes");
            std::for_each(frame.paths.begin(), frame.paths.end(), require_sound_path);
        }
    }
    const audio::Signal heard =
        propagation::render_path_frames(pairs.front().frames, {.sample_rate = kRate}, kRecording)
            .signal;
    for (const double sample : heard.channels.at(0)) {
        require(std::isfinite(sample), "sound over paths is finite");
    }
}

/// As load_scene() words what std::bad_alloc means. Messages may quote the file: they only hold it.
bool is_out_of_memory(const Error& error) {
    return std::string_view(error.what()) == "needs more memory than is available";
}

InputFile& input_of(const Reader& reader) {
    static std::map<std::string, InputFile, std::less<>> files;
    return files.try_emplace(reader.name, reader.name + reader.suffix).first->second;
}

}  // namespace

const std::vector<Reader>& readers() {
    static const std::vector<Reader> kReaders{
        {"arrivals", ".csv", read_arrivals},
        {"contact_queries", ".csv", read_contact_queries},
        {"contacts", ".json", read_contact_results},
        {"directivity", ".csv", read_directivity},
        {"glb", ".glb", read_scene, repair_glb},
        {"gltf", ".gltf", read_scene},
        {"listeners", ".csv", read_listeners},
        {"map_results", ".json", read_map_results},
        {"materials", ".json", read_materials},
        {"obj", ".obj", read_scene},
        {"off", ".off", read_scene},
        {"path_frames", ".json", read_path_frames},
        {"ply", ".ply", read_scene},
        {"points", ".csv", read_points},
        {"room_results", ".txt", read_room_results},
        {"sofa_reply", ".bin", read_sofa_reply},
        {"stl", ".stl", read_scene, repair_stl},
        {"visible_sets", ".pvs", read_visible_sets, repair_visible_sets},
        {"wav", ".wav", read_wav, repair_wav},
    };
    return kReaders;
}

const Reader& reader_named(std::string_view name) {
    const auto found = std::find_if(readers().begin(), readers().end(), [&](const Reader& reader) {
        return reader.name == name;
    });
    if (found == readers().end()) {
        throw std::out_of_range("no reader " + std::string(name));
    }
    return *found;
}

Outcome fuzz_one(const Reader& reader, std::string_view bytes) {
    InputFile& file = input_of(reader);
    file.write(bytes);
    try {
        reader.read(file.path());
    } catch (const Error& error) {
        if (is_out_of_memory(error)) {
            throw std::bad_alloc();
        }
        return Outcome::refused;
    }
    return Outcome::read;
}

const fs::path& input_file(const Reader& reader) {
    return input_of(reader).path();
}

}  // namespace earshot::test
