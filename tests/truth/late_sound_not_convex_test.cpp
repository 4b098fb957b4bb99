// SPDX-License-Identifier: MIT
// Late sound in rooms that are not convex against runs with source and listener exchanged: then the
// ball that measures it is about the other end.
#include "earshot/bvh/deformable_bvh.h"
#include "earshot/io/scene_file.h"
#include "earshot/propagation/late_rays.h"
#include "earshot/scenes/gltf_writer.h"
#include "earshot/scenes/models.h"

#include <gtest/gtest.h>

#include "support/temporary_folder.h"
#include <cmath>
#include <vector>

namespace earshot::propagation {
namespace {

using geometry::Vec3;

constexpr std::size_t kBand = 5;  // 1 kHz

struct Room {
    explicit Room(const scenes::SceneDraft& draft) {
        const test::TemporaryFolder folder;
        scene =
            io::load_scene(folder.file(draft.name + ".gltf",
                                       scenes::write_gltf(draft, scenes::GltfForm::text, 1).bytes))
                .scene;
        for (Material& material : scene.materials) {
            material.scattering = EnergyCoefficient(0.1);
        }
        mesh = {scene.mesh.positions_at(0.0),
                {scene.mesh.triangles().begin(), scene.mesh.triangles().end()}};
        bvh = bvh::DeformableBvh(mesh.view());
        for (const Emitter& source : scene.sources) {
            sources.push_back(scene.position_at(source, 0.0));
        }
        for (const Emitter& listener : scene.listeners) {
            listeners.push_back(scene.position_at(listener, 0.0));
        }
    }

    LateEnergy traced(const Vec3& from,
                      const std::vector<Vec3>& to,
                      std::size_t rays,
                      double radius) const {
        const RayScene seen = {
            {bvh.tree(), mesh.view()}, scene.material_of_triangle, scene.materials};
        const RayOptions options = {.rays = rays,
                                    .length = 1.5,
                                    .bin = 0.005,
                                    .specular_order = 0,
                                    .receiver_radius = radius,
                                    .decay_time = 1.5,
                                    .air_absorption = false};
        Executor executor(2);
        return trace_late_rays(seen, {.pose = {.position = from}}, to, options, executor);
    }

    Scene scene;
    geometry::Mesh mesh;
    bvh::DeformableBvh bvh;
    std::vector<Vec3> sources, listeners;
};

double level_db(const LateEnergy& late, std::size_t listener) {
    double sum = 0.0;
    for (const audio::Spectrum& energy : late.listeners[listener].energy) {
        sum += energy[kBand];
    }
    return 10.0 * std::log10(sum);
}

void compare_with_exchanged_runs(const Room& room, std::size_t rays) {
    constexpr double kMaxDifference = 0.2;  // decibels
    std::vector<LateEnergy> exchanged;
    for (const Vec3& listener : room.listeners) {
        exchanged.push_back(room.traced(listener, room.sources, rays, 1.0));
    }
    for (std::size_t s = 0; s < room.sources.size(); ++s) {
        const LateEnergy late = room.traced(room.sources[s], room.listeners, rays, 1.0);
        const LateEnergy narrow = room.traced(room.sources[s], room.listeners, rays, 0.5);
        for (std::size_t l = 0; l < room.listeners.size(); ++l) {
            EXPECT_NEAR(level_db(late, l), level_db(exchanged[l], s), kMaxDifference)
                << s << " to " << l;
            const double error = std::hypot(late.errors[l].level_db, narrow.errors[l].level_db);
            EXPECT_NEAR(level_db(late, l), level_db(narrow, l), 3.0 * error) << s << " to " << l;
            EXPECT_LT(error, 0.1) << s << " to " << l;
        }
    }
}

TEST(LateSoundNotConvex, AnLShapedRoomGivesTheExchangedRun) {
    compare_with_exchanged_runs(Room(scenes::make_lroom()), 60000);
}

TEST(SlowLateSoundNotConvex, CoupledRoomsGiveTheExchangedRun) {
    compare_with_exchanged_runs(Room(scenes::make_coupled_rooms()), 150000);
}

}  // namespace
}  // namespace earshot::propagation
