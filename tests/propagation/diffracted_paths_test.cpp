// SPDX-License-Identifier: MIT
// Diffracted sound of whole scenes: what the simulator makes of it, and that the sum with direct
// and reflected sound has no step.
#include "earshot/audio/bands.h"
#include "earshot/base/error.h"
#include "earshot/base/math.h"
#include "earshot/base/simd.h"
#include "earshot/bvh/deformable_bvh.h"
#include "earshot/frustum/edge_paths.h"
#include "earshot/frustum/find_specular_paths.h"
#include "earshot/geometry/clean.h"
#include "earshot/geometry/wedges.h"
#include "earshot/propagation/diffraction.h"
#include "earshot/propagation/internal/diffracted_sound.h"
#include "earshot/propagation/second_order_diffraction.h"
#include "earshot/propagation/simulator.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <iterator>
#include <limits>
#include <string>
#include <vector>

namespace earshot::propagation {
namespace {

using Complex = std::complex<double>;
using geometry::Vec3;

void add_quad(geometry::Mesh& mesh, const std::array<Vec3, 4>& corners) {
    const auto first = static_cast<geometry::VertexId>(mesh.positions.size());
    mesh.positions.insert(mesh.positions.end(), corners.begin(), corners.end());
    mesh.triangles.push_back({first, first + 1, first + 2});
    mesh.triangles.push_back({first, first + 2, first + 3});
}

/// A screen of 2.4 x 1.2 m that floats 0.3 m above an absorbing floor of 20 x 20 m.
Scene screen_scene() {
    geometry::Mesh mesh;
    add_quad(mesh, {Vec3(-10, 0, 10), Vec3(10, 0, 10), Vec3(10, 0, -10), Vec3(-10, 0, -10)});
    add_quad(mesh, {Vec3(-1.2, 0.3, 0), Vec3(1.2, 0.3, 0), Vec3(1.2, 1.5, 0), Vec3(-1.2, 1.5, 0)});
    Scene scene;
    scene.name = "screen";
    scene.material_of_triangle = {0, 0, 1, 1};
    scene.materials.resize(2);
    scene.materials[0].name = "floor";
    scene.materials[0].absorption = EnergyCoefficient(0.4);
    scene.materials[1].name = "screen";
    scene.materials[1].absorption = EnergyCoefficient(0.2);
    scene.sources = {{.name = "s", .node = -1, .position = {0.2, 1.1, 2.0}}};
    scene.listeners = {{.name = "l", .node = -1, .position = {-0.3, 1.0, -1.5}}};
    scene.mesh = geometry::AnimatedMesh::fixed(std::move(mesh));
    return scene;
}

/// Without the floor.
Scene screen_alone() {
    Scene scene = screen_scene();
    geometry::Mesh mesh;
    add_quad(mesh, {Vec3(-1.2, 0.3, 0), Vec3(1.2, 0.3, 0), Vec3(1.2, 1.5, 0), Vec3(-1.2, 1.5, 0)});
    scene.material_of_triangle = {1, 1};
    scene.mesh = geometry::AnimatedMesh::fixed(std::move(mesh));
    return scene;
}

std::vector<Path> paths_of(const Scene& scene, const Options& options) {
    Simulator simulator(scene, options);
    return simulator.run()[0].paths;
}

TEST(DiffractedPaths, ReachBehindAScreen) {
    const Scene scene = screen_scene();
    const Options options{.specular_order = 0, .diffraction = 1, .air_absorption = false};
    EXPECT_TRUE(paths_of(scene, {.specular_order = 0}).empty());
    const auto paths = paths_of(scene, options);
    // The screen's edges, and those of the floor that are not behind it from either side.
    ASSERT_GE(paths.size(), 4U);
    for (std::size_t i = 0; i < 4; ++i) {
        const Path& path = paths[i];
        EXPECT_EQ(path.kind, PathKind::diffracted);
        EXPECT_EQ(path.order, 1);
        ASSERT_EQ(path.points.size(), 3U);
        ASSERT_EQ(path.edges.size(), 1U);
        EXPECT_EQ(path.points[1].z, 0.0);
        EXPECT_EQ(path.edges[0][0].z, 0.0);
        EXPECT_GE(path.triangles[0], 2U);
        EXPECT_EQ(path.materials[0], 1U);
        EXPECT_NEAR(path.delay, path.length / 343.2, 1e-12);
        // Of one edge the terms of direct sound add to the pressure in its shadow.
        EXPECT_GT(path.parts[0][4], 0.0);
    }
    EXPECT_TRUE(std::is_sorted(paths.begin(), paths.end(), [](const Path& a, const Path& b) {
        return a.delay < b.delay;
    }));
}

// The upper edge by itself: what the integral gives, with a factor per kind of term.
TEST(DiffractedPaths, HaveThePressureOfTheIntegral) {
    const Scene scene = screen_scene();
    const auto paths =
        paths_of(scene, {.specular_order = 1, .diffraction = 1, .air_absorption = false});
    const auto upper = std::find_if(paths.begin(), paths.end(), [](const Path& path) {
        return path.kind == PathKind::diffracted && path.order == 1 && path.points[1].y == 1.5;
    });
    ASSERT_NE(upper, paths.end());
    // From the source's side of the screen: angles from its face, which hangs down.
    EdgeDiffraction edge;
    edge.open_angle = 2.0 * math::kPi;
    edge.source = {std::hypot(0.4, 2.0), std::atan2(2.0, 0.4), 0.2};
    edge.listener = {std::hypot(0.5, 1.5), 2.0 * math::kPi - std::atan2(1.5, 0.5), -0.3};
    edge.z_begin = -1.2;
    edge.z_end = 1.2;
    const double face = std::sqrt(0.8);
    edge.pressure_factors = {1.0, face, face};
    for (std::size_t band = 0; band < 10; ++band) {
        const double k = 2.0 * math::kPi * audio::Bands::octaves().exact_hz()[band] / 343.2;
        EXPECT_NEAR(upper->pressure[band], std::abs(diffracted_pressure(edge, k).total()), 1e-5);
    }
}

TEST(DiffractedPaths, ComeWithReflectionsBeforeAndAfter) {
    const auto paths = paths_of(screen_scene(), {.specular_order = 1, .diffraction = 1});
    std::size_t before = 0, after = 0;
    for (const Path& path : paths) {
        if (path.kind == PathKind::diffracted && path.order == 2 && path.edges[0][0].z == 0.0 &&
            path.edges[0][1].z == 0.0) {
            before += path.points[1].y == 0.0 && path.points[2].z == 0.0 ? 1 : 0;
            after += path.points[1].z == 0.0 && path.points[2].y == 0.0 ? 1 : 0;
            EXPECT_EQ(path.materials.size(), 2U);
        }
    }
    EXPECT_EQ(before, 4U);
    EXPECT_EQ(after, 4U);
}

TEST(DiffractedPaths, LevelsAndLengthsLeaveOutThoseBeyond) {
    const Scene scene = screen_scene();
    const auto all = paths_of(scene, {.specular_order = 1, .diffraction = 1});
    const auto near = paths_of(scene, {.specular_order = 1, .diffraction = 1, .max_length = 5.0});
    const auto loud =
        paths_of(scene, {.specular_order = 1, .diffraction = 1, .min_level_db = -30.0});
    std::size_t count_near = 0, count_loud = 0;
    for (const Path& path : all) {
        count_near += path.length <= 5.0 ? 1 : 0;
        double loudest = 0.0;
        for (const double pressure : path.pressure) {
            loudest = std::max(loudest, std::abs(pressure));
        }
        count_loud += loudest >= std::pow(10.0, -1.5) ? 1 : 0;
    }
    EXPECT_EQ(near.size(), count_near);
    EXPECT_EQ(loud.size(), count_loud);
    EXPECT_LT(count_near, all.size());
    EXPECT_LT(count_loud, all.size());
}

// The level alone tells what is left out, whatever is decided before paths are evaluated.
TEST(DiffractedPaths, OfALevelAreThoseOfAllThatAreAsLoud) {
    const Scene scene = screen_scene();
    constexpr double kNone = -std::numeric_limits<double>::infinity();
    const auto paths_above = [&](double level_db) {
        return paths_of(
            scene, {.specular_order = 2, .diffraction = 1, .min_diffraction_level_db = level_db});
    };
    const auto all = paths_above(kNone);
    const double distance = glm::distance(scene.sources[0].position, scene.listeners[0].position);
    std::size_t last = all.size();
    for (const double level_db : {-200.0, -60.0, -50.0, -40.0, -30.0, -20.0, -10.0}) {
        std::vector<Path> expected;
        for (const Path& path : all) {
            const auto [quietest, loudest] =
                std::minmax_element(path.pressure.begin(), path.pressure.end());
            const double pressure = std::max(*loudest, -*quietest);
            if (path.kind != PathKind::diffracted ||
                20.0 * std::log10(pressure * distance) >= level_db) {
                expected.push_back(path);
            }
        }
        const auto found = paths_above(level_db);
        ASSERT_EQ(found.size(), expected.size()) << level_db << " dB";
        for (std::size_t i = 0; i < found.size(); ++i) {
            EXPECT_EQ(found[i].points, expected[i].points);
            EXPECT_EQ(found[i].pressure, expected[i].pressure);
        }
        EXPECT_LE(found.size(), last);
        last = found.size();
    }
    EXPECT_LT(last, all.size() / 2);
}

TEST(DiffractedPaths, AreTheSameForAnyNumberOfThreads) {
    const Scene scene = screen_scene();
    const Options options{.specular_order = 2, .diffraction = 1};
    Executor two(2);
    Simulator simulator(scene, options);
    const auto there = simulator.run(two)[0].paths;
    const auto here = paths_of(scene, options);
    ASSERT_EQ(there.size(), here.size());
    for (std::size_t i = 0; i < here.size(); ++i) {
        EXPECT_EQ(there[i].points, here[i].points);
        EXPECT_EQ(there[i].pressure, here[i].pressure);
    }
}

void expect_same(const std::vector<PairResult>& found, const std::vector<PairResult>& expected) {
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t i = 0; i < found.size(); ++i) {
        ASSERT_EQ(found[i].paths.size(), expected[i].paths.size());
        for (std::size_t k = 0; k < found[i].paths.size(); ++k) {
            EXPECT_EQ(found[i].paths[k].points, expected[i].paths[k].points);
            EXPECT_EQ(found[i].paths[k].pressure, expected[i].paths[k].pressure);
            EXPECT_EQ(found[i].paths[k].triangles, expected[i].paths[k].triangles);
        }
        ASSERT_EQ(found[i].energy_arrivals.size(), expected[i].energy_arrivals.size());
        for (std::size_t k = 0; k < found[i].energy_arrivals.size(); ++k) {
            EXPECT_EQ(found[i].energy_arrivals[k].delay, expected[i].energy_arrivals[k].delay);
            EXPECT_EQ(found[i].energy_arrivals[k].pressure,
                      expected[i].energy_arrivals[k].pressure);
        }
    }
}

TEST(DiffractedPaths, KeptTracesFollowSourcesAndListenersThatMove) {
    Scene scene = screen_scene();
    scene.sources.push_back({.name = "t", .node = -1, .position = {0.9, 0.8, 1.0}});
    // One listener on the floor, whose pairs are moved off it.
    scene.listeners.push_back({.name = "m", .node = -1, .position = {0.5, 0.0, -2.0}});
    const Options options{.specular_order = 2, .diffraction = 1};
    Options keep = options;
    keep.keep_traces = true;
    Simulator keeping(scene, keep);
    for (int step = 0; step < 6; ++step) {
        if (step % 2 == 1) {
            scene.listeners[0].position.x -= 0.3;
        }
        if (step % 3 == 2) {
            scene.sources[1].position.y += 0.4;
        }
        Simulator fresh(scene, options);
        expect_same(keeping.run(), fresh.run());
    }
}

// Along the screen, from its left edge to its upper one, on the source's side and on the other.
TEST(DiffractedPaths, OverTwoEdgesHaveThePressureOfTheDoubleIntegral) {
    const Scene scene = screen_alone();
    const double face = std::sqrt(0.8);
    const auto paths = paths_of(scene,
                                {.specular_order = 2,
                                 .diffraction = 2,
                                 .min_diffraction_level_db = -200.0,
                                 .air_absorption = false});
    std::vector<const Path*> found;
    for (const Path& path : paths) {
        if (path.edges.size() == 2 && path.edges[0][0].x == -1.2 && path.edges[0][1].x == -1.2 &&
            path.edges[1][0].y == 1.5 && path.edges[1][1].y == 1.5) {
            found.push_back(&path);
        }
    }
    ASSERT_EQ(found.size(), 2U);
    const Vec3 middle(0.0, 0.9, 0.0);
    const auto plate_edge = [&](const Vec3& from, const Vec3& to) {
        return geometry::make_wedge(from, to, middle, 2.0 * math::kPi);
    };
    const auto wave_number = [](std::size_t band) {
        return 2.0 * math::kPi * audio::Bands::octaves().exact_hz()[band] / 343.2;
    };
    std::vector<EdgePairSpectrum> spectra;
    for (const int side : {0, 1}) {
        DoubleDiffraction edges;
        edges.first = plate_edge({-1.2, 0.3, 0.0}, {-1.2, 1.5, 0.0});
        edges.second = plate_edge({1.2, 1.5, 0.0}, {-1.2, 1.5, 0.0});
        edges.first_end = edges.first.length();
        edges.second_end = edges.second.length();
        // Both run with the screen to the one side, so that their first faces are unlike ones.
        edges.common_face = DoubleDiffraction::CommonFace{side, 1 - side};
        edges.source = scene.sources[0].position;
        edges.listener = scene.listeners[0].position;
        spectra.emplace_back(edges, wave_number(9));
    }
    for (std::size_t band = 0; band < 10; ++band) {
        std::array<double, 2> expected{};
        for (const int side : {0, 1}) {
            const auto kinds = spectra[static_cast<std::size_t>(side)].pressure(wave_number(band));
            Complex sum{0.0};
            for (std::size_t i = 0; i < 3; ++i) {
                for (std::size_t j = 0; j < 3; ++j) {
                    sum += (i > 0 ? face : 1.0) * (j > 0 ? face : 1.0) *
                           (kinds.upright[i][j] + kinds.inverted[i][j]);
                }
            }
            expected[static_cast<std::size_t>(side)] = 2.0 / (1.0 + face) * std::abs(sum);
        }
        std::array<double, 2> pressures{found[0]->pressure[band], found[1]->pressure[band]};
        std::sort(pressures.begin(), pressures.end());
        std::sort(expected.begin(), expected.end());
        EXPECT_NEAR(pressures[0], expected[0], 1e-9);
        EXPECT_NEAR(pressures[1], expected[1], 1e-9);
    }
}

/// Two plates, askew: ways along their sides and through the air between them.
Scene screens_alone() {
    Scene scene = screen_scene();
    geometry::Mesh mesh;
    add_quad(mesh, {Vec3(-1.2, 0.3, 0), Vec3(1.2, 0.3, 0), Vec3(1.2, 1.5, 0), Vec3(-1.2, 1.5, 0)});
    add_quad(
        mesh,
        {Vec3(-0.9, 0.2, -0.7), Vec3(1.1, 0.2, -0.8), Vec3(1.2, 1.4, -0.7), Vec3(-0.8, 1.4, -0.6)});
    scene.material_of_triangle = {1, 1, 1, 1};
    scene.mesh = geometry::AnimatedMesh::fixed(std::move(mesh));
    return scene;
}

std::size_t edges_of(const Path& path) {
    return path.edges.size();
}

double loudest_band(const Path& path) {
    const auto [quietest, loudest] =
        std::minmax_element(path.pressure.begin(), path.pressure.end());
    return std::max(*loudest, -*quietest);
}

void expect_same_paths(const std::vector<Path>& found, const std::vector<Path>& expected) {
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t i = 0; i < found.size(); ++i) {
        EXPECT_EQ(found[i].points, expected[i].points);
        EXPECT_EQ(found[i].pressure, expected[i].pressure);
        EXPECT_EQ(found[i].triangles, expected[i].triangles);
    }
}

// Level and length alone tell what is left out, whatever is decided before the integrals.
TEST(DiffractedPaths, OverTwoEdgesAreThoseOfAllWithinLevelAndLength) {
    const Scene scene = screens_alone();
    constexpr double kNone = -std::numeric_limits<double>::infinity();
    const Options every{.specular_order = 1, .diffraction = 2, .min_diffraction_level_db = kNone};
    const auto all = paths_of(scene, every);
    const double distance = glm::distance(scene.sources[0].position, scene.listeners[0].position);
    const auto filtered = [&](const auto& is_wanted) {
        std::vector<Path> wanted;
        std::copy_if(all.begin(), all.end(), std::back_inserter(wanted), is_wanted);
        return wanted;
    };
    const auto over_two = static_cast<std::size_t>(std::count_if(
        all.begin(), all.end(), [](const Path& path) { return edges_of(path) == 2; }));
    ASSERT_GT(over_two, 25U);
    for (const double level_db : {-55.0, -40.0, -30.0}) {
        Options options = every;
        options.min_diffraction_level_db = level_db;
        expect_same_paths(paths_of(scene, options), filtered([&](const Path& path) {
                              return path.kind != PathKind::diffracted ||
                                     20.0 * std::log10(loudest_band(path) * distance) >= level_db;
                          }));
    }
    for (const double level_db : {-50.0, -40.0}) {
        Options options = every;
        options.min_level_db = level_db;
        expect_same_paths(paths_of(scene, options), filtered([&](const Path& path) {
                              return 20.0 * std::log10(loudest_band(path)) >= level_db;
                          }));
    }
    for (const double length : {4.2, 4.8}) {
        Options options = every;
        options.max_length = length;
        expect_same_paths(paths_of(scene, options),
                          filtered([&](const Path& path) { return path.length <= length; }));
    }
}

TEST(DiffractedPaths, OverTwoEdgesAreTheSameForAnyNumberOfThreadsAndInstructions) {
    const Scene scene = screens_alone();
    const Options options{.specular_order = 1, .diffraction = 2};
    const auto expected = paths_of(scene, options);
    for (const std::string& target : simd_targets()) {
        override_simd_target(target);
        expect_same_paths(paths_of(scene, options), expected);
    }
    override_simd_target("auto");
    for (const int threads : {2, 3}) {
        Executor executor(threads);
        Simulator simulator(scene, options);
        expect_same_paths(simulator.run(executor)[0].paths, expected);
    }
}

TEST(DiffractedPaths, OfThreeEdgesAreRefused) {
    const Scene scene = screen_scene();
    EXPECT_THROW(Simulator(scene, {.diffraction = 3}), Error);
    EXPECT_THROW(Simulator(scene, {.diffraction = -1}), Error);
}

/// All of the sound at a listener at the centre of each band, and the energies that are expected.
struct Field {
    std::vector<Complex> pressure;
    std::vector<double> energy;
    std::size_t specular_paths = 0;
};

/// The screen scene as the library has it, for listeners by the hundred.
class ScreenField {
public:
    ScreenField() : scene_(screen_scene()) {
        mesh_.triangles.assign(scene_.mesh.triangles().begin(), scene_.mesh.triangles().end());
        mesh_.positions = scene_.mesh.positions_at(0.0);
        const auto clean = geometry::clean(mesh_.view());
        facets_ = geometry::find_facets(mesh_.view(), clean.weld, scene_.material_of_triangle);
        bvh_ = bvh::DeformableBvh(mesh_.view());
        wedges_ = geometry::find_wedges(facets_);
        for (const geometry::Facet& facet : facets_.facets) {
            const bool is_floor = facet.triangles.front() < 2;
            audio::Spectrum factor{};
            factor.fill(std::sqrt(is_floor ? 0.6 : 0.8));
            reflection_.push_back(factor);
        }
    }

    Field at(const Vec3& listener) const {
        const audio::Bands& bands = audio::Bands::octaves();
        const AirAbsorption air({}, bands);
        const DiffractionModel model{.bands = bands,
                                     .speed_of_sound = 343.0,
                                     .air = air,
                                     .air_absorption = false,
                                     .reflection = reflection_,
                                     .max_order = 1};
        const frustum::SceneView view{.bvh = {bvh_.tree(), mesh_.view()}, .facets = facets_};
        const Vec3 source = scene_.sources[0].position;
        const std::array listeners{listener};
        const auto traced =
            frustum::find_specular_paths(view, source, listeners, {.max_order = 1}).paths;
        Field field{.pressure = std::vector<Complex>(bands.count()),
                    .energy = std::vector<double>(bands.count()),
                    .specular_paths = traced.size()};
        std::vector<Path> paths;
        SpecularPaths specular;
        for (const frustum::SpecularPath& found : traced) {
            Path path;
            path.length = found.length;
            path.delay = found.length / 343.0;
            FacetSequence sequence;
            path.pressure.fill(1.0 / found.length);
            for (const geometry::TriangleId triangle : found.triangles) {
                sequence.push_back(facets_.of_triangle[triangle]);
                for (double& pressure : path.pressure) {
                    pressure *= reflection_[sequence.back()][0];
                }
            }
            specular[sequence] = paths.size();
            paths.push_back(path);
            for (std::size_t band = 0; band < bands.count(); ++band) {
                field.pressure[band] += std::polar(
                    path.pressure[band], -2.0 * math::kPi * bands.exact_hz()[band] * path.delay);
            }
        }
        std::vector<DiffractedSound> sounds;
        for (frustum::EdgePath& way :
             frustum::find_edge_paths(view, wedges_, source, listeners, {.max_reflections = 1})
                 .paths) {
            sounds.push_back(*diffracted_sound(std::move(way), view, wedges_, specular, model));
            for (std::size_t band = 0; band < bands.count(); ++band) {
                for (const auto& of_kind : sounds.back().pressure) {
                    field.pressure[band] += of_kind[band];
                }
            }
        }
        for (const audio::Arrival& arrival : energy_arrivals(paths, specular, sounds, model)) {
            for (std::size_t band = 0; band < bands.count(); ++band) {
                field.energy[band] += arrival.pressure[band] * arrival.pressure[band];
            }
        }
        return field;
    }

private:
    Scene scene_;
    geometry::Mesh mesh_;
    geometry::Facets facets_;
    bvh::DeformableBvh bvh_;
    std::vector<geometry::Wedge> wedges_;
    std::vector<audio::Spectrum> reflection_;
};

// A listener walks from behind the screen into the open and past the zones of its reflections. Each
// place where a specular path begins or ends is found to a tenth of a nanometre.
TEST(DiffractedPaths, PressureAndEnergyAreContinuousWherePathsBeginAndEnd) {
    const ScreenField scene;
    const std::array<std::array<Vec3, 2>, 4> walks{{{Vec3(-0.3, 1.0, -1.5), Vec3(-0.2, 2.9, -1.4)},
                                                    {Vec3(0.1, 1.1, -2.0), Vec3(5.0, 0.9, -2.2)},
                                                    {Vec3(0.3, 1.0, 3.0), Vec3(4.0, 1.6, 2.5)},
                                                    {Vec3(-0.5, 0.9, -0.7), Vec3(-0.6, 0.05, -3)}}};
    std::size_t boundaries = 0;
    for (const auto& [from, to] : walks) {
        constexpr int kSteps = 40;
        const auto place = [&, a = from, b = to](double t) { return a + t * (b - a); };
        double previous = 0.0;
        std::size_t paths = scene.at(from).specular_paths;
        for (int i = 1; i <= kSteps; ++i) {
            const double t = static_cast<double>(i) / kSteps;
            if (scene.at(place(t)).specular_paths != paths) {
                double low = previous, high = t;
                while (high - low > 1e-11) {
                    const double middle = 0.5 * (low + high);
                    (scene.at(place(middle)).specular_paths == paths ? low : high) = middle;
                }
                const Field before = scene.at(place(low));
                const Field after = scene.at(place(high));
                ++boundaries;
                for (std::size_t band = 0; band < before.pressure.size(); ++band) {
                    EXPECT_LT(std::abs(after.pressure[band] - before.pressure[band]), 1e-7);
                    EXPECT_LT(std::abs(after.energy[band] - before.energy[band]), 1e-7);
                }
                paths = after.specular_paths;
            }
            paths = scene.at(place(t)).specular_paths;
            previous = t;
        }
    }
    EXPECT_GE(boundaries, 6U);
}

}  // namespace
}  // namespace earshot::propagation
