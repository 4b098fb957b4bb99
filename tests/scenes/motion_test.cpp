// SPDX-License-Identifier: MIT
#include "earshot/geometry/clean.h"
#include "earshot/geometry/facets.h"
#include "earshot/geometry/wedges.h"
#include "earshot/io/scene_file.h"
#include "earshot/propagation/simulator.h"
#include "earshot/scenes/models.h"

#include "scenes/generated_mesh.h"
#include "support/test_paths.h"
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

namespace earshot::scenes {
namespace {

constexpr double kPi = 3.14159265358979323846;

propagation::Scene load(const std::string& name) {
    return io::load_scene(test::source_file("scenes") / name).scene;
}

// Where the corners of all triangles of one material are at a time.
std::vector<Vec3> corners_of(const propagation::Scene& scene,
                             const std::string& material,
                             double time) {
    const std::vector<Vec3> positions = scene.mesh.positions_at(time);
    std::vector<Vec3> corners;
    for (std::size_t triangle = 0; triangle < scene.material_of_triangle.size(); ++triangle) {
        if (scene.materials[scene.material_of_triangle[triangle]].name == material) {
            for (const geometry::VertexId vertex : scene.mesh.triangles()[triangle]) {
                corners.push_back(positions[vertex]);
            }
        }
    }
    EXPECT_FALSE(corners.empty()) << material;
    return corners;
}

// All that moves stays in the air of the room, at every time.
void expect_stays_in_the_air(const SceneDraft& draft, const std::string& material) {
    const propagation::Scene scene = load(draft.name + ".gltf");
    const geometry::Mesh room = mesh_of(draft.nodes[0]);
    const double duration = scene.mesh.duration();
    ASSERT_GT(duration, 1.0);
    for (int frame = 0; frame <= 60; ++frame) {
        const double time = duration * frame / 60.0;
        for (const Vec3& point : corners_of(scene, material, time)) {
            ASSERT_NEAR(winding_number(room, point), -1.0, 1e-9)
                << draft.name << " at " << time << " s: " << point.x << ", " << point.y << ", "
                << point.z;
        }
    }
}

TEST(Motion, DoorNeverMeetsItsFrame) {
    expect_stays_in_the_air(make_door(), "door-solid-wood");
}

TEST(Motion, CurtainNeverMeetsTheWalls) {
    expect_stays_in_the_air(make_curtain(), "curtain-heavy");
}

TEST(Motion, DoorOpensByItsAngle) {
    const SceneDraft draft = make_door();
    const propagation::Scene scene = load("door.gltf");
    const Vec3 hinge = draft.nodes[1].translation;
    const auto opening = [&](double time) {
        double farthest = 0.0;
        double angle = 0.0;
        for (const Vec3& point : corners_of(scene, "door-solid-wood", time)) {
            // The face towards the opening side holds the hinge; its far edge shows the angle.
            const double radius = std::hypot(point.x - hinge.x, point.z - hinge.z);
            if (std::fabs(radius - 0.98) < 1e-4) {
                farthest = radius;
                angle = std::atan2(point.z - hinge.z, point.x - hinge.x) * 180.0 / kPi;
            }
        }
        EXPECT_GT(farthest, 0.0);
        return angle;
    };
    // Key frames are single precision.
    EXPECT_NEAR(opening(0.0), 0.0, 1e-3);
    EXPECT_NEAR(opening(1.0), 50.0, 1e-3);
    EXPECT_NEAR(opening(2.5), 100.0, 1e-3);
    EXPECT_NEAR(opening(4.0), 0.0, 1e-3);
}

TEST(Motion, CurtainIsDrawnToOneSide) {
    const propagation::Scene scene = load("curtain.gltf");
    const auto width = [&](double time) {
        double low = 1e9;
        double high = -1e9;
        for (const Vec3& point : corners_of(scene, "curtain-heavy", time)) {
            low = std::min(low, point.x);
            high = std::max(high, point.x);
        }
        return high - low;
    };
    EXPECT_NEAR(width(0.0), 7.4, 1e-5);
    EXPECT_NEAR(width(0.7), 7.4, 1e-5) << "swaying does not draw it";
    EXPECT_NEAR(width(5.0), 1.5, 1e-5);
}

std::vector<propagation::PairResult> diffraction_at(propagation::Simulator& simulator,
                                                    double time) {
    simulator.set_time(time);
    return simulator.run();
}

// What a simulator keeps from instant to instant, edges among it, is what a fresh one finds.
void expect_diffraction_as_afresh(const std::string& name, int order, int diffraction) {
    const propagation::Scene scene = load(name);
    const propagation::Options options{.specular_order = order, .diffraction = diffraction};
    propagation::Options keep = options;
    keep.keep_traces = true;
    propagation::Simulator following(scene, keep);
    std::size_t diffracted = 0;
    // Forth, back, and at rest.
    for (const double time : {0.0, 0.3, 0.4, 0.4, 1.7, 0.3, 3.0, 0.0}) {
        propagation::Simulator fresh(scene, options);
        const auto expected = diffraction_at(fresh, time);
        const auto found = diffraction_at(following, time);
        ASSERT_EQ(found.size(), expected.size());
        for (std::size_t i = 0; i < found.size(); ++i) {
            ASSERT_EQ(found[i].paths.size(), expected[i].paths.size()) << name << " at " << time;
            for (std::size_t k = 0; k < found[i].paths.size(); ++k) {
                const propagation::Path& path = found[i].paths[k];
                EXPECT_EQ(path.points, expected[i].paths[k].points);
                EXPECT_EQ(path.pressure, expected[i].paths[k].pressure);
                EXPECT_EQ(path.triangles, expected[i].paths[k].triangles);
                diffracted += path.kind == propagation::PathKind::diffracted ? 1 : 0;
            }
        }
    }
    EXPECT_GT(diffracted, 100U) << name;
}

TEST(Motion, DiffractionOfADoorIsThatFoundAfresh) {
    expect_diffraction_as_afresh("door.gltf", 1, 1);
}

TEST(Motion, DiffractionOfACurtainIsThatFoundAfresh) {
    expect_diffraction_as_afresh("curtain.gltf", 1, 1);
}

// The edges alone, to the last bit, at instants in which the curtain moves and the hall does not.
TEST(Motion, WedgesAreThoseFoundAfresh) {
    for (const std::string name : {"door.gltf", "curtain.gltf"}) {
        const propagation::Scene scene = load(name);
        geometry::WedgeFinder finder;
        for (const double time : {0.0, 0.1, 0.2, 0.2, 1.3, 2.5, 0.1, 0.0}) {
            geometry::Mesh mesh{.positions = scene.mesh.positions_at(time), .triangles = {}};
            const std::vector<geometry::Triangle>& all = scene.mesh.triangles();
            const geometry::CleanMesh clean = geometry::clean({mesh.positions, all});
            std::vector<std::uint32_t> labels;
            for (const geometry::TriangleId triangle : clean.kept) {
                mesh.triangles.push_back(all[triangle]);
                labels.push_back(scene.material_of_triangle[triangle]);
            }
            const geometry::Facets facets = geometry::find_facets(mesh.view(), clean.weld, labels);
            const std::vector<geometry::Wedge> expected = geometry::find_wedges(facets);
            const std::vector<geometry::Wedge>& found = finder.find(facets);
            ASSERT_EQ(found.size(), expected.size()) << name << " at " << time;
            for (std::size_t i = 0; i < found.size(); ++i) {
                EXPECT_EQ(found[i].faces, expected[i].faces);
                EXPECT_EQ(found[i].begin, expected[i].begin);
                EXPECT_EQ(found[i].end, expected[i].end);
                EXPECT_EQ(found[i].tangent, expected[i].tangent);
                EXPECT_EQ(found[i].normal, expected[i].normal);
                EXPECT_EQ(found[i].open_angle, expected[i].open_angle);
            }
        }
        EXPECT_GT(finder.kept_lines(), 0U) << name;
    }
}

}  // namespace
}  // namespace earshot::scenes
