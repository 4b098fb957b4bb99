// SPDX-License-Identifier: MIT
//
// bench_air_cut [SCENE ...]: the visibility graph cut in its printed form (Zhou et al. 2008): the
// series of its table 3 over rays per node, border and random samples, of its table 4 over the
// tolerance, on a house of stacked bricks whose answer is known; and the breakdown of its tables 2
// and 5 on that house and, in place of the series, on scenes.

#include "earshot/visibility/air_cut.h"

#include "earshot/base/random.h"
#include "earshot/bvh/deformable_bvh.h"
#include "earshot/geometry/clean.h"
#include "earshot/geometry/tolerance.h"
#include "earshot/io/scene_file.h"

#include "harness.h"
#include <array>
#include <cmath>
#include <cstdio>
#include <vector>

namespace {

using namespace earshot;
using geometry::TriangleId;
using geometry::Vec3;
using visibility::AirCut;
using visibility::AirCutOptions;
using visibility::SideLabel;

/// A mesh of welded vertices with its hierarchy.
struct Model {
    explicit Model(const geometry::Mesh& mesh) : positions(mesh.positions) {
        const geometry::CleanMesh clean = geometry::clean(mesh.view());
        for (const TriangleId id : clean.kept) {
            const auto& [a, b, c] = mesh.triangles[id];
            triangles.push_back({clean.weld[a], clean.weld[b], clean.weld[c]});
        }
        tolerance = geometry::coplanar_tolerance({positions, triangles});
        hierarchy = bvh::DeformableBvh({positions, triangles});
    }

    std::vector<Vec3> positions;
    std::vector<geometry::Triangle> triangles;
    double tolerance = 0.0;
    bvh::DeformableBvh hierarchy;
};

/// Bricks of 2 x 1 x 1 in layers that are staggered by one, some of them missing: nearly all edges
/// are non-manifold, and faces are coplanar with several others.
class BrickHouse {
public:
    static constexpr int kX = 8, kY = 5, kZ = 5;

    BrickHouse() {
        for (int y = 0; y < kY; ++y) {
            for (int z = 0; z < kZ; ++z) {
                for (int x = y % 2; x + 1 < kX; x += 2) {
                    const auto index = static_cast<std::uint64_t>((y * kZ + z) * kX + x);
                    if (random(1, 0, index) < 0.85) {
                        add_brick(x, y, z);
                    }
                }
            }
        }
        flood();
    }

    geometry::Mesh mesh;

    /// Whether a point lies in a cell that is empty and linked to the outside.
    bool is_outside(const Vec3& p) const {
        const int x = static_cast<int>(std::floor(p.x));
        const int y = static_cast<int>(std::floor(p.y));
        const int z = static_cast<int>(std::floor(p.z));
        return !contains(x, y, z) || reached_[cell(x, y, z)];
    }

private:
    static bool contains(int x, int y, int z) {
        return x >= 0 && y >= 0 && z >= 0 && x < kX && y < kY && z < kZ;
    }
    static std::size_t cell(int x, int y, int z) {
        return static_cast<std::size_t>((y * kZ + z) * kX + x);
    }

    void add_brick(int x, int y, int z) {
        filled_[cell(x, y, z)] = filled_[cell(x + 1, y, z)] = true;
        const auto first = static_cast<geometry::VertexId>(mesh.positions.size());
        for (unsigned corner = 0; corner < 8; ++corner) {
            mesh.positions.emplace_back(x + ((corner & 1U) != 0 ? 2 : 0),
                                        y + ((corner & 2U) != 0 ? 1 : 0),
                                        z + ((corner & 4U) != 0 ? 1 : 0));
        }
        constexpr std::array<std::array<unsigned, 4>, 6> kSides{
            {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}};
        for (const auto& side : kSides) {
            for (const unsigned k : {1U, 2U}) {
                mesh.triangles.push_back({first + side[0], first + side[k], first + side[k + 1]});
            }
        }
    }

    void flood() {
        const auto is_linked = [&](int x, int y, int z) {
            constexpr std::array<std::array<int, 3>, 6> kSteps{
                {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}}};
            for (const auto& [dx, dy, dz] : kSteps) {
                if (!contains(x + dx, y + dy, z + dz) || reached_[cell(x + dx, y + dy, z + dz)]) {
                    return true;
                }
            }
            return false;
        };
        for (bool changed = true; changed;) {
            changed = false;
            for (int y = 0; y < kY; ++y) {
                for (int z = 0; z < kZ; ++z) {
                    for (int x = 0; x < kX; ++x) {
                        const std::size_t at = cell(x, y, z);
                        if (!filled_[at] && !reached_[at] && is_linked(x, y, z)) {
                            reached_[at] = true;
                            changed = true;
                        }
                    }
                }
            }
        }
    }

    std::vector<bool> filled_ = std::vector<bool>(kX * kY * kZ, false);
    std::vector<bool> reached_ = std::vector<bool>(kX * kY * kZ, false);
};

/// Fronts of which a part is outside, by points on a grid of the triangle.
std::vector<bool> exposed_fronts(const BrickHouse& house, const Model& model) {
    std::vector<bool> exposed;
    for (const geometry::Triangle& triangle : model.triangles) {
        const auto [a, b, c] = geometry::corners(model.positions, triangle);
        const Vec3 normal = glm::normalize(glm::cross(b - a, c - a));
        bool is_exposed = false;
        constexpr int kSteps = 12;
        for (int i = 0; i < kSteps; ++i) {
            for (int k = 0; i + k < kSteps; ++k) {
                const Vec3 p =
                    a + ((i + 1.0 / 3.0) / kSteps) * (b - a) + ((k + 1.0 / 3.0) / kSteps) * (c - a);
                is_exposed = is_exposed || house.is_outside(p + 0.01 * normal);
            }
        }
        exposed.push_back(is_exposed);
    }
    return exposed;
}

AirCut cut(const Model& model, AirCutOptions options) {
    options.lambda = 1.0;
    options.max_rays = 1'000'000'000;
    options.tolerance = options.tolerance > 0.0 ? options.tolerance : model.tolerance;
    return visibility::cut_air(model.hierarchy.view(), {}, {}, options);
}

/// Triangles that are kept although nothing of them is outside, and the reverse.
struct Faults {
    std::size_t kept = 0, lost = 0;
};

Faults faults_of(const std::vector<bool>& exposed, const AirCut& result) {
    Faults faults;
    for (TriangleId t = 0; t < exposed.size(); ++t) {
        const bool is_air = result.label_of_side[visibility::front_of(t)] != SideLabel::solid ||
                            result.label_of_side[visibility::back_of(t)] != SideLabel::solid;
        faults.kept += is_air && !exposed[t] ? 1 : 0;
        faults.lost += !is_air && exposed[t] ? 1 : 0;
    }
    return faults;
}

void print_series(const Model& house, const std::vector<bool>& exposed) {
    std::printf("| RperN | RS | BS | processor s | kept wrongly | lost wrongly |\n");
    std::printf("| ---: | ---: | ---: | ---: | ---: | ---: |\n");
    const auto row = [&](std::uint64_t rays, std::size_t inside, std::size_t border) {
        AirCut result;
        const bench::Times times = bench::times_of([&] {
            result = cut(
                house, {.rays_per_node = rays, .random_samples = inside, .border_samples = border});
        });
        const auto [kept, lost] = faults_of(exposed, result);
        std::printf("| %llu | %zu | %zu | %.2f | %zu | %zu |\n",
                    static_cast<unsigned long long>(rays),
                    inside,
                    border,
                    times.processor,
                    kept,
                    lost);
        std::fflush(stdout);
    };
    for (const std::uint64_t rays : {8U, 16U, 32U, 48U, 64U}) {
        row(rays, 5, 30);
    }
    for (const std::size_t border : {0U, 6U, 15U, 24U, 36U}) {
        row(16, 5, border);
    }
    for (const std::size_t inside : {0U, 10U, 15U, 20U, 25U}) {
        row(16, inside, 30);
    }
    std::printf("\n| tolerance | kept wrongly | lost wrongly |\n| ---: | ---: | ---: |\n");
    for (const double tolerance : {1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2}) {
        const auto [kept, lost] = faults_of(exposed, cut(house, {.tolerance = tolerance}));
        std::printf("| %.0e | %zu | %zu |\n", tolerance, kept, lost);
    }
}

void print_breakdown(const char* name, const Model& model) {
    for (const bool cluster : {true, false}) {
        const AirCut result = cut(model, {.cluster = cluster});
        std::size_t kept = 0;
        for (TriangleId t = 0; t < model.triangles.size(); ++t) {
            kept += result.label_of_side[visibility::front_of(t)] != SideLabel::solid ||
                            result.label_of_side[visibility::back_of(t)] != SideLabel::solid
                        ? 1
                        : 0;
        }
        std::printf("| %s | %s | %zu | %zu | %.2f | %.2f | %.3f | %.2f M | %zu | %zu |\n",
                    name,
                    cluster ? "yes" : "no",
                    model.triangles.size(),
                    kept,
                    result.cluster_seconds,
                    result.sampling_seconds,
                    result.cut_seconds,
                    1e-6 * static_cast<double>(result.rays),
                    result.nodes,
                    result.edges);
        std::fflush(stdout);
    }
}

int run(int argc, char** argv) {
    const BrickHouse bricks;
    const Model house(bricks.mesh);
    if (argc == 1) {
        print_series(house, exposed_fronts(bricks, house));
    }
    std::printf(
        "\n| model | clusters | triangles | kept | C s | S s | G s | rays | nodes | edges |\n");
    std::printf("| --- | --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |\n");
    print_breakdown("bricks", house);
    for (int i = 1; i < argc; ++i) {
        const io::LoadedScene loaded = io::load_scene(argv[i]);
        print_breakdown(
            loaded.scene.name.c_str(),
            Model({loaded.scene.mesh.positions_at(0.0), loaded.scene.mesh.triangles()}));
    }
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    return bench::run_main("bench_air_cut", argc, argv, run);
}
