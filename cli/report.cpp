// SPDX-License-Identifier: MIT
#include "earshot/cli/commands.h"
#include "earshot/cli/material_options.h"
#include "earshot/cli/output.h"
#include "earshot/cli/report_output.h"
#include "earshot/cli/scene_choice.h"
#include "earshot/io/report_contacts.h"
#include "earshot/io/report_map.h"
#include "earshot/io/result_names.h"
#include "earshot/io/sound_signal.h"
#include "earshot/io/wav.h"
#include "earshot/io/whole_file.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace earshot::cli {
namespace {

constexpr const char* kFooter =
    "The page is complete in itself: it needs no network and no other file. With the scene it "
    "shows\n"
    "the walls; with --histograms of earshot ir the decay curves, with --sensitivity which "
    "surface\n"
    "matters. earshot ir --report makes the page at once, with all of them.\n\n"
    "Examples:\n"
    "  earshot report out scenes/classroom.gltf -o classroom.html\n"
    "      what earshot ir wrote into the folder out, in the room that it is of\n"
    "  earshot report after --against before -o change.html\n"
    "      metrics in just-noticeable differences from those of another run\n"
    "  earshot report out --limit sti=0.6 -o page.html\n"
    "      whether speech is understood at every listener\n"
    "  earshot report contacts.json scenes/door.gltf -o door.html\n"
    "      what earshot collide found, and the meshes that move\n"
    "  earshot report out -o data.json\n"
    "      the data of the page alone";

constexpr std::array<const char*, 4> kResultNames = {
    "metrics.json", "paths.json", "histograms.json", "sensitivity.json"};

bool is_scene(const std::filesystem::path& file) {
    std::string suffix = file.extension().string();
    std::transform(suffix.begin(), suffix.end(), suffix.begin(), [](char c) {
        return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    });
    constexpr std::array<std::string_view, 6> kSuffixes = {
        ".gltf", ".glb", ".obj", ".ply", ".stl", ".off"};
    return std::find(kSuffixes.begin(), kSuffixes.end(), suffix) != kSuffixes.end();
}

class ReportCommand : public Command {
public:
    explicit ReportCommand(CLI::App& program)
        : Command(program,
                  "report",
                  "One page for the browser that shows results",
                  {.threads = false, .simd = false}) {
        app()
            .add_option("FILES",
                        files_,
                        "a folder of earshot ir, or files of it, or a contacts.json or map.json; "
                        "and the scene that they are of")
            ->required();
        add_output("-o,--output", output_, "the page to write, .html; .json for its data alone")
            ->required();
        app()
            .add_option("--against",
                        against_,
                        "metrics to compare with: a folder of earshot ir, or a metrics.json")
            ->type_name("DIR");
        app()
            .add_option("--audio",
                        dry_file_,
                        "a dry recording, of which the page plays what each listener hears; its "
                        "first 10 s, with the responses of a folder")
            ->type_name("DRY.wav");
        limits_.add_to(app());
        scene_.add_reading_to(app());
        materials_.add_to(app());
        app().footer(kFooter);
    }

    void run() override {
        io::RoomReport report{.time = scene_.times(app()).front(), .limits = limits_.limits(app())};
        require_report(output_);
        std::optional<io::LoadedScene> loaded;
        for (const std::string& file : files_) {
            if (is_scene(file)) {
                load_scene(file, loaded);
            } else if (std::filesystem::is_directory(file)) {
                add_folder(file, report);
            } else {
                add_file(file, report);
            }
            report.provenance.files.push_back(name_of(file));
        }
        if (!against_.empty()) {
            const bool is_folder = std::filesystem::is_directory(against_);
            const std::filesystem::path file =
                is_folder ? std::filesystem::path(against_) / kResultNames[0]
                          : std::filesystem::path(against_);
            report.reference = {file.string(), io::read_whole_file(file)};
            report.reference_name = name_of(against_);
            report.provenance.files.push_back(name_of(against_));
        }
        if (!dry_file_.empty()) {
            add_audio(report);
        }
        report.title = title(loaded);
        report.provenance.version = program_version();
        report.provenance.command = command_line();
        if (loaded) {
            add_scene(*loaded, report);
        }
        write_report(output_,
                     !contacts_.name.empty() ? contacts_data(loaded, report)
                     : !map_.name.empty()    ? map_data(report)
                                             : io::encode_room_report(report));
        tell(report.warnings);
    }

private:
    static std::string name_of(const std::filesystem::path& file) {
        const std::filesystem::path name = file.filename();
        return (name.empty() ? file.parent_path().filename() : name).string();
    }

    std::string title(const std::optional<io::LoadedScene>& loaded) const {
        return std::filesystem::path(loaded ? loaded->scene.name : name_of(files_.front()))
            .stem()
            .string();
    }

    void load_scene(const std::string& file, std::optional<io::LoadedScene>& loaded) {
        if (loaded) {
            throw Error(file, "is a second scene", "give one");
        }
        scene_.set_file(file);
        loaded = scene_.load();
        materials_.apply(file, *loaded);
    }

    /// Contacts and maps have pages of their own.
    void require_alone(const io::ReportFile& file, const io::RoomReport& report) const {
        if (!report.metrics.name.empty() || !report.paths.name.empty() ||
            (!contacts_.name.empty() && !map_.name.empty())) {
            throw Error(file.name, "does not go with the other results", "give one of them");
        }
    }

    /// The page of a map.json.
    std::string map_data(const io::RoomReport& report) const {
        require_alone(map_, report);
        return io::encode_map_page({.title = report.title,
                                    .provenance = report.provenance,
                                    .map = map_,
                                    .scene = report.scene,
                                    .default_materials = report.default_materials,
                                    .warnings = report.warnings});
    }

    /// The page of a contacts.json, with the meshes of its scene.
    std::string contacts_data(const std::optional<io::LoadedScene>& loaded,
                              const io::RoomReport& report) const {
        require_alone(contacts_, report);
        io::ContactsPage page{.title = report.title,
                              .provenance = report.provenance,
                              .contacts = io::read_contacts(contacts_),
                              .warnings = report.warnings};
        if (loaded) {
            const geometry::AnimatedMesh& mesh = loaded->scene.mesh;
            if (mesh.mesh_names().size() != page.contacts.meshes.size()) {
                throw Error(contacts_.name,
                            "has contacts of other meshes than the scene has",
                            "give the scene that earshot collide had");
            }
            page.triangles = mesh.triangles();
            page.mesh_of_triangle = mesh.mesh_of_triangle();
            page.positions_at = [&mesh](double time) { return mesh.positions_at(time); };
        }
        return io::encode_contacts_page(page);
    }

    /// Of each pair the file that `earshot ir` has named after it.
    void add_audio(io::RoomReport& report) {
        if (folder_.empty()) {
            throw wrong_usage(app(), "--audio", "goes with a folder of earshot ir");
        }
        report.audio_of = [dry = io::signal_of(io::read_sound(dry_file_)),
                           folder = folder_,
                           file = dry_file_](const std::string& source,
                                             const std::string& listener,
                                             double) -> std::optional<io::ReportAudio> {
            propagation::Scene names;
            names.sources = {{.name = source}};
            names.listeners = {{.name = listener}};
            const std::filesystem::path sound = folder / (io::ResultNames(names).of(0, 0) + ".wav");
            if (!std::filesystem::exists(sound)) {
                return std::nullopt;
            }
            const audio::Signal response = io::signal_of(io::read_sound(sound));
            if (!audio::channels_fit(dry, response)) {
                throw Error(file,
                            "has another number of channels than " + sound.string(),
                            "give a recording of one channel");
            }
            return io::make_report_audio(dry, response);
        };
    }

    void add_folder(const std::filesystem::path& folder, io::RoomReport& report) {
        folder_ = folder;
        bool has_results = false;
        for (const char* const name : kResultNames) {
            if (std::filesystem::exists(folder / name)) {
                add_file(folder / name, report);
                has_results = true;
            }
        }
        if (!has_results) {
            throw Error(folder.string(),
                        "has no results: no metrics.json and no paths.json",
                        "give a folder that earshot ir -o has written");
        }
    }

    /// Which of its files one is, its beginning tells.
    void add_file(const std::filesystem::path& file, io::RoomReport& report) {
        constexpr std::size_t kHead = 65536;
        io::ReportFile content{file.string(), io::read_whole_file(file)};
        const std::string_view head = std::string_view(content.text).substr(0, kHead);
        const auto has = [&](std::string_view key) { return head.find(key) != head.npos; };
        io::ReportFile& place = has("\"steps\"")            ? contacts_
                                : has("\"maps\"")           ? map_
                                : has("\"speed_of_sound\"") ? report.paths
                                : has("\"area\"")           ? report.sensitivity
                                : has("\"bin\"")            ? report.histograms
                                                            : report.metrics;
        if (!place.name.empty()) {
            throw Error(file.string(), "is of the same kind as " + place.name, "give one of them");
        }
        place = std::move(content);
    }

    void add_scene(const io::LoadedScene& loaded, io::RoomReport& report) const {
        report.scene = &loaded.scene;
        report.default_materials = loaded.default_materials;
        report.warnings = loaded.warnings;
        if (!contacts_.name.empty()) {
            return;
        }
        const Warnings acoustic = io::warnings_of_acoustics(loaded);
        report.warnings.insert(report.warnings.end(), acoustic.begin(), acoustic.end());
    }

    void tell(const Warnings& warnings) const {
        if (common().json) {
            const nlohmann::ordered_json json = {
                {"version", 1}, {"file", output_}, {"bytes", std::filesystem::file_size(output_)}};
            write_output(
                json.dump(1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n");
        } else if (!common().quiet) {
            print_warnings(warnings);
            write_output("report     " + output_ + "\n");
        }
    }

    std::vector<std::string> files_;
    std::string output_, against_;
    std::string dry_file_;
    std::filesystem::path folder_;
    io::ReportFile map_;       // a map.json, if one is given
    io::ReportFile contacts_;  // a contacts.json, if one is given
    LimitOption limits_;
    SceneChoice scene_;
    MaterialOptions materials_;
};

}  // namespace

std::unique_ptr<Command> make_report_command(CLI::App& program) {
    return std::make_unique<ReportCommand>(program);
}

}  // namespace earshot::cli
