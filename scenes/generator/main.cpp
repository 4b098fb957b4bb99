// SPDX-License-Identifier: MIT
#include "earshot/base/error.h"
#include "earshot/io/whole_file.h"
#include "earshot/scenes/gltf_writer.h"
#include "earshot/scenes/models.h"
#include "earshot/scenes/picture.h"

#include <CLI/CLI.hpp>

#include <filesystem>
#include <functional>
#include <iostream>
#include <map>
#include <string>
#include <vector>

namespace earshot::scenes {
namespace {

struct Output {
    std::string file;
    std::string picture;
    int tessellation = 1;
};

void write_scene(const SceneDraft& draft, const std::filesystem::path& file, int tessellation) {
    const bool binary = file.extension() == ".glb";
    if (!binary && file.extension() != ".gltf") {
        throw Error(file.string(), "has no suffix of glTF", "name it .gltf or .glb");
    }
    const GltfFile gltf =
        write_gltf(draft, binary ? GltfForm::binary : GltfForm::text, tessellation);
    io::write_whole_file(file, gltf.bytes);
    std::cout << file.string() << ": " << gltf.triangles << " triangles, " << gltf.vertices
              << " vertices, " << gltf.bytes.size() << " bytes\n";
}

void write_picture(const SceneDraft& draft, const std::filesystem::path& file) {
    const std::string svg = draw_picture(draft);
    io::write_whole_file(file, svg);
    std::cout << file.string() << ": " << svg.size() << " bytes\n";
}

// The command line: one subcommand per scene.
class Program {
public:
    Program() {
        app_.require_subcommand(1);
        app_.footer(
            "Examples:\n"
            "  earshot_scenes all -o scenes                      what the project holds\n"
            "  earshot_scenes concert_hall -o hall.glb --tessellation 12\n"
            "  earshot_scenes concert_hall --picture hall.svg --seats blocks\n\n"
            "earshot_scenes SCENE --help lists the parameters of a scene.");
        add_all();
        add_rooms();
        add_concert_hall();
        add_moving();
        add_outdoors();
    }

    int run(int argc, char** argv) {
        try {
            app_.parse(argc, argv);
        } catch (const CLI::ParseError& error) {
            return app_.exit(error) == 0 ? 0 : 2;
        }
        return 0;
    }

private:
    CLI::App* add_scene(const std::string& name,
                        const std::string& description,
                        const std::function<SceneDraft()>& make) {
        CLI::App* command = app_.add_subcommand(name, description);
        CLI::Option* file =
            command->add_option("-o,--output", output_.file, "the scene, .gltf or .glb");
        command->add_option("--picture", output_.picture, "an isometric drawing, .svg");
        command
            ->add_option("--tessellation",
                         output_.tessellation,
                         "split every face into N x N; 1 leaves it whole")
            ->check(CLI::Range(1, 4096))
            ->needs(file);
        command->callback([this, make, command] {
            if (output_.file.empty() && output_.picture.empty()) {
                throw CLI::RequiredError(command->get_name() + ": -o or --picture");
            }
            const SceneDraft draft = make();
            if (!output_.file.empty()) {
                write_scene(draft, output_.file, output_.tessellation);
            }
            if (!output_.picture.empty()) {
                write_picture(draft, output_.picture);
            }
        });
        return command;
    }

    void add_all() {
        CLI::App* command = app_.add_subcommand("all", "Every scene and its picture");
        command->add_option("-o,--output", output_.file, "folder; pictures go to its pictures/")
            ->required();
        command->callback([this] {
            const std::filesystem::path folder = output_.file;
            std::filesystem::create_directories(folder / "pictures");
            for (const SceneDraft& draft : make_all()) {
                write_scene(draft, folder / (draft.name + ".gltf"), 1);
                write_picture(draft, folder / "pictures" / (draft.name + ".svg"));
            }
        });
    }

    void add_rooms() {
        CLI::App* box = add_scene("shoebox", "A rectangular room", [this] {
            shoebox_.size = {size_[0], size_[1], size_[2]};
            return make_shoebox(shoebox_);
        });
        box->add_option("--size", size_, "metres along x, y (up), z")
            ->expected(3)
            ->check(CLI::Range(0.1, 1000.0));
        box->add_option("--absorption", shoebox_.absorption, "energy coefficient of the walls")
            ->check(CLI::Range(0.0, 1.0));
        add_scene("lroom",
                  "An L-shaped room with three pairs of source and listener",
                  [this] { return make_lroom(lroom_); })
            ->add_option("--absorption", lroom_.absorption, "energy coefficient of the walls")
            ->check(CLI::Range(0.0, 1.0));
        add_scene("coupled_rooms",
                  "A live and a dead room with an opening between them",
                  [this] { return make_coupled_rooms(coupled_rooms_); })
            ->add_option("--opening", coupled_rooms_.opening, "width of the opening, metres")
            ->check(CLI::Range(0.2, 3.4));
        CLI::App* classroom = add_scene("classroom", "A classroom with furniture", [this] {
            return make_classroom(classroom_);
        });
        classroom->add_flag("!--empty", classroom_.furnished, "without desks and chairs");
        classroom
            ->add_option("--rounded",
                         classroom_.rounding,
                         "pieces of each rounded edge of the furniture; 0: sharp edges")
            ->check(CLI::Range(0, 100));
    }

    void add_concert_hall() {
        add_scene("concert_hall",
                  "A concert hall with balconies and seats",
                  [this] {
                      const std::map<std::string, Seats> seats = {
                          {"none", Seats::none},
                          {"blocks", Seats::blocks},
                          {"individual", Seats::individual}};
                      concert_hall_.seats = seats.at(seats_);
                      return make_concert_hall(concert_hall_);
                  })
            ->add_option(
                "--seats", seats_, "in the stalls: none, blocks (few facets) or individual")
            ->check(CLI::IsMember({"none", "blocks", "individual"}));
    }

    void add_moving() {
        add_scene(
            "door", "Two rooms; the door between them opens", [this] { return make_door(door_); })
            ->add_option("--angle", door_.angle_deg, "how far it opens, degrees")
            ->check(CLI::Range(0.0, 120.0));
        add_scene("curtain",
                  "A small hall whose curtain sways and is drawn aside",
                  [this] { return make_curtain(curtain_); })
            ->add_option("--folds", curtain_.folds, "folds of the curtain")
            ->check(CLI::Range(1, 100));
    }

    void add_outdoors() {
        add_scene("city", "Streets between 143 buildings", [] { return make_city(); });
    }

    CLI::App app_{"Writes the scenes of earshot as glTF", "earshot_scenes"};
    Output output_;
    std::vector<double> size_ = {8.0, 3.5, 6.0};
    ShoeboxOptions shoebox_;
    LRoomOptions lroom_;
    CoupledRoomsOptions coupled_rooms_;
    ClassroomOptions classroom_;
    ConcertHallOptions concert_hall_;
    std::string seats_ = "individual";
    DoorOptions door_;
    CurtainOptions curtain_;
};

}  // namespace
}  // namespace earshot::scenes

int main(int argc, char** argv) {
    try {
        return earshot::scenes::Program().run(argc, argv);
    } catch (const earshot::Error& error) {
        std::cerr << "earshot_scenes: error: " << error.line() << "\n";
    } catch (const std::exception& error) {
        std::cerr << "earshot_scenes: error: " << error.what() << "\n";
    }
    return 1;
}
