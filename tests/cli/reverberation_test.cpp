// SPDX-License-Identifier: MIT
// A model whose materials are nothing but names of the library, as modellers export it.
#include "earshot/io/scene_file.h"

#include <glm/geometric.hpp>
#include <nlohmann/json.hpp>

#include "run_earshot.h"
#include "support/temporary_folder.h"
#include "support/test_paths.h"
#include <cmath>
#include <fstream>
#include <iterator>

namespace earshot::test {
namespace {

using Json = nlohmann::json;
using geometry::Vec3;

/// The classroom as an OBJ, and what Eyring's formula says of it (without air, 500 Hz and 1 kHz).
class Classroom : public testing::Test {
protected:
    Classroom() : scene_(io::load_scene(source_file("scenes/classroom.gltf")).scene) {}

    std::string write_obj() const {
        const std::string file = (folder_.path() / "classroom.obj").string();
        std::ofstream obj(file);
        const std::vector<Vec3> positions = scene_.mesh.positions_at(0.0);
        for (const Vec3& p : positions) {
            obj << "v " << p.x << " " << p.y << " " << p.z << "\n";
        }
        const auto triangles = scene_.mesh.triangles();
        for (std::size_t i = 0; i < triangles.size(); ++i) {
            obj << "usemtl " << scene_.materials[scene_.material_of_triangle[i]].name << "\nf";
            for (const auto vertex : triangles[i]) {
                obj << " " << vertex + 1;
            }
            obj << "\n";
        }
        return file;
    }

    double eyring() const {
        const std::vector<Vec3> positions = scene_.mesh.positions_at(0.0);
        double volume = 0.0, surface = 0.0, absorbed[2] = {0.0, 0.0};
        for (std::size_t i = 0; i < scene_.mesh.triangles().size(); ++i) {
            const auto [a, b, c] = scene_.mesh.triangles()[i];
            const Vec3 normal =
                glm::cross(positions[b] - positions[a], positions[c] - positions[a]);
            const double area = 0.5 * glm::length(normal);
            volume -= glm::dot(normal, positions[a]) / 6.0;
            surface += area;
            const auto row = propagation::find_library_material(
                scene_.materials[scene_.material_of_triangle[i]].name);
            absorbed[0] += area * row->absorption.at(500.0);
            absorbed[1] += area * row->absorption.at(1000.0);
        }
        double sum = 0.0;
        for (const double area : absorbed) {
            sum += 0.161 * volume / (-surface * std::log(1.0 - area / surface));
        }
        return 0.5 * sum;
    }

    std::string place(const propagation::Emitter& emitter) const {
        const Vec3 at = scene_.position_at(emitter, 0.0);
        return std::to_string(at.x) + "," + std::to_string(at.y) + "," + std::to_string(at.z);
    }

    TemporaryFolder folder_;
    propagation::Scene scene_;
};

TEST_F(Classroom, OfLibraryNamesHasEyringsTimeOrANoteThatSaysWhyNot) {
    const std::string out = (folder_.path() / "out").string();
    const RunResult result = run_earshot({"ir",
                                          write_obj(),
                                          "-o",
                                          out,
                                          "--order",
                                          "1",
                                          "--rays",
                                          "20000",
                                          "--no-air-absorption",
                                          "--source",
                                          place(scene_.sources[0]),
                                          "--listener",
                                          place(scene_.listeners[1])});
    ASSERT_EQ(result.status, 0) << result.err;
    EXPECT_EQ(result.err.find("no acoustic data"), std::string::npos) << result.err;
    std::ifstream file(out + "/metrics.json");
    const Json pair = Json::parse(file)["pairs"][0];
    // Of the response, whose T30 is a realisation of the expected one and needs fewer rays.
    const Json& t30 = pair["response"]["t30"];
    const double ratio = 0.5 * (t30[4].get<double>() + t30[5].get<double>()) / eyring();
    EXPECT_GT(ratio, 0.8);
    EXPECT_LT(ratio, 4.0);  // 20 with walls like mirrors
    const bool has_note = result.err.find("times Eyring's") != std::string::npos;
    EXPECT_TRUE(ratio < 1.5 || has_note) << ratio << "\n" << result.err;
    bool has_note_in_file = false;
    for (const Json& note : pair["notes"]) {
        const std::string text = note["text"];
        has_note_in_file = has_note_in_file || text.find("times Eyring's") != std::string::npos;
    }
    EXPECT_EQ(has_note_in_file, has_note);
    if (has_note) {
        // The ceiling absorbs; sound is left between the walls.
        EXPECT_NE(result.err.find("\"wood-panelling-16mm\" (scattering 0.1)"), std::string::npos)
            << result.err;
        EXPECT_EQ(result.err.find("\"acoustic-plaster-25mm\" ("), std::string::npos) << result.err;
    }
}

TEST_F(Classroom, ItselfHasTheTimeThatClassroomsAreMeantToHave) {
    const std::string out = (folder_.path() / "out").string();
    const RunResult result = run_earshot({"ir",
                                          source_file("scenes/classroom.gltf").string(),
                                          "-o",
                                          out,
                                          "--order",
                                          "1",
                                          "--rays",
                                          "20000"});
    ASSERT_EQ(result.status, 0) << result.err;
    EXPECT_EQ(result.err.find("times Eyring's"), std::string::npos) << result.err;
    std::ifstream file(out + "/metrics.json");
    const Json metrics = Json::parse(file);
    for (const Json& pair : metrics["pairs"]) {
        for (const std::size_t band : {4U, 5U}) {
            EXPECT_GT(pair["response"]["t30"][band].get<double>(), 0.5);
            EXPECT_LT(pair["response"]["t30"][band].get<double>(), 0.8);
        }
    }
}

}  // namespace
}  // namespace earshot::test
