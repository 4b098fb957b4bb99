// SPDX-License-Identifier: MIT
#include "earshot/cli/collide_motion.h"

#include "earshot/base/math.h"
#include "earshot/collision/weld.h"

#include <cmath>
#include <filesystem>
#include <span>
#include <utility>

namespace earshot::cli {

using collision::World;
using geometry::Triangle;
using geometry::Vec3;

CollideMotion motion_of_scene(geometry::AnimatedMesh mesh,
                              std::vector<double> times,
                              bool weld,
                              collision::Path path) {
    CollideMotion motion;
    motion.mesh_names = mesh.mesh_names();
    motion.triangles = mesh.triangles().size();
    motion.times = std::move(times);
    motion.world.add(std::move(mesh), weld);
    motion.set_step = [times = motion.times, path](World& world, std::size_t from, std::size_t to) {
        world.set_step(times[from], times[to], path);
    };
    return motion;
}

CollideMotion motion_of_poses(const std::vector<std::string>& files,
                              const std::vector<geometry::AnimatedMesh>& meshes,
                              bool weld) {
    std::vector<Triangle> triangles = meshes.front().triangles();
    CollideMotion motion;
    std::vector<std::vector<Vec3>> poses;
    for (std::size_t i = 0; i < meshes.size(); ++i) {
        if (meshes[i].triangles() != triangles ||
            meshes[i].vertex_count() != meshes.front().vertex_count()) {
            throw Error(files[i],
                        "has other vertices or triangles than " + files.front(),
                        "give poses of one mesh");
        }
        poses.push_back(meshes[i].positions_at(0.0));
        motion.times.push_back(static_cast<double>(i));
    }
    if (weld) {
        collision::replace_vertices(triangles, collision::weld(triangles, poses));
    }
    motion.mesh_names = {std::filesystem::path(files.front()).stem().string()};
    motion.triangles = triangles.size();
    motion.world.add_mesh(triangles, poses.front().size());
    motion.set_step = [poses = std::move(poses)](World& world, std::size_t from, std::size_t to) {
        world.update(0, poses[from], poses[to]);
    };
    return motion;
}

Warnings warn_of_turns(const CollideMotion& motion, const std::string& file) {
    // The chord of an arc of 10 degrees is 0.4 % of the radius away from it.
    constexpr double kFar = math::kPi / 18.0;
    double largest = kFar;
    std::size_t step = 0;
    std::uint32_t mesh = 0;
    for (std::size_t i = 0; i + 1 < motion.times.size(); ++i) {
        for (std::uint32_t m = 0; m < motion.world.mesh_count(); ++m) {
            const double turn = motion.world.turn(m, motion.times[i], motion.times[i + 1]);
            if (turn > largest * (1.0 + 1e-9)) {
                largest = turn;
                step = i;
                mesh = m;
            }
        }
    }
    if (!(largest > kFar)) {
        return {};
    }
    const auto degrees = static_cast<int>(std::lround(largest * 180.0 / math::kPi));
    const std::string name =
        motion.mesh_names[mesh].empty() ? std::to_string(mesh) : motion.mesh_names[mesh];
    return {{file,
             "mesh \"" + name + "\" turns by " + std::to_string(degrees) + " degrees in step " +
                 std::to_string(step) +
                 ", but its vertices move on straight lines; use --rigid, or smaller steps of "
                 "--frames"}};
}

}  // namespace earshot::cli
