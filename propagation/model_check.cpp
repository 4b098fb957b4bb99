// SPDX-License-Identifier: MIT
#include "earshot/propagation/model_check.h"

#include "earshot/base/halton.h"
#include "earshot/base/math.h"
#include "earshot/geometry/facets.h"
#include "earshot/propagation/cost_forecast.h"
#include "earshot/propagation/internal/checked_mesh.h"
#include "earshot/propagation/internal/emitter_faults.h"
#include "earshot/propagation/internal/exposed_layers.h"
#include "earshot/propagation/internal/leak_search.h"
#include "earshot/propagation/internal/separation.h"
#include "earshot/propagation/internal/spiral.h"
#include "earshot/visibility/reached_sides.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

namespace earshot::propagation {

using geometry::TriangleId;
using geometry::Vec3;
using visibility::ReachedSides;
using visibility::SideLabel;

namespace {

/// Volume and surface that the reached sides enclose are taken where they agree so far with those
/// of rays, which are sure to a few per cent.
constexpr double kMaxVolumeDeviation = 0.05;

double triangle_area(const geometry::Corners& c) {
    return 0.5 * glm::length(glm::cross(c[1] - c[0], c[2] - c[0]));
}

/// Where most of the air is: of points spread over the scene the one with the largest visible
/// volume, of those from which little sound leaves the scene if there are any.
Vec3 find_probe(const CheckedMesh& mesh, const SceneExtent& extent, Executor& executor) {
    constexpr std::uint64_t kPoints = 128;
    constexpr std::size_t kRays = 256;
    constexpr double kMaxEscapes = 0.1;
    Vec3 best = 0.5 * (extent.lower + extent.upper);
    std::pair best_score{-1.0, -1.0};  // keeps its sound, volume or share that stays
    for (std::uint64_t i = 0; i < kPoints; ++i) {
        const Vec3 share(
            radical_inverse(i + 1, 2), radical_inverse(i + 1, 3), radical_inverse(i + 1, 5));
        const Vec3 point = extent.lower + share * extent.size();
        std::vector<geometry::Ray> rays(kRays);
        for (std::size_t k = 0; k < kRays; ++k) {
            rays[k] = {point, spiral_direction(k, static_cast<double>(kRays))};
        }
        double volume = 0.0;
        std::size_t met = 0;
        for (const auto& hit : mesh.bvh().closest_hits(rays, executor)) {
            met += hit ? 1 : 0;
            volume += hit ? hit->t * hit->t * hit->t : 0.0;
        }
        const double stays = static_cast<double>(met) / kRays;
        const std::pair score =
            stays >= 1.0 - kMaxEscapes ? std::pair{1.0, volume} : std::pair{0.0, stays};
        if (score > best_score) {
            best_score = score;
            best = point;
        }
    }
    return best;
}

/// Groups triangles by a key, in the order of their first ones.
template <typename Key>
std::vector<FaceGroup> grouped(std::span<const geometry::Vec3> positions,
                               std::span<const geometry::Triangle> triangles,
                               const std::vector<std::pair<Key, TriangleId>>& members) {
    struct Box {
        Vec3 lower, upper;
    };
    std::map<Key, std::size_t> place;
    std::vector<FaceGroup> groups;
    std::vector<Box> boxes;
    for (const auto& [key, id] : members) {
        const geometry::Corners corners = geometry::corners(positions, triangles[id]);
        const auto [at, is_new] = place.try_emplace(key, groups.size());
        if (is_new) {
            groups.push_back({.first_triangle = id});
            boxes.push_back({corners[0], corners[0]});
        }
        FaceGroup& group = groups[at->second];
        ++group.triangles;
        group.place.area += triangle_area(corners);
        for (const Vec3& corner : corners) {
            boxes[at->second].lower = glm::min(boxes[at->second].lower, corner);
            boxes[at->second].upper = glm::max(boxes[at->second].upper, corner);
        }
    }
    for (std::size_t i = 0; i < groups.size(); ++i) {
        groups[i].place.centre = 0.5 * (boxes[i].lower + boxes[i].upper);
        groups[i].place.size = boxes[i].upper - boxes[i].lower;
    }
    return groups;
}

/// One examination under way.
class Examination {
public:
    Examination(const Scene& scene, const ModelCheckOptions& options, Executor& executor)
        : scene_(scene),
          options_(options),
          executor_(executor),
          positions_(scene.mesh.positions_at(options.time)),
          emitters_(placed_emitters(scene, options.time)) {
        report_.extent = scene_extent(scene, options.time);
        report_.topology = geometry::find_topology({positions_, triangles()}, executor);
        if (report_.topology.clean.kept.empty()) {
            throw Error(scene.name, "no triangle has an area", "check the export");
        }
    }

    ModelReport run() {
        const CheckedMesh mesh(positions_, triangles(), report_.topology.clean, executor_);
        judge_materials();
        find_doubled();
        find_small_facets(mesh);
        if (options_.sampling) {
            sample(mesh);
        }
        double volume = 0.0;
        for (const SharedAir& air : report_.airs) {
            volume = std::max(volume, air.volume);
        }
        report_.kind = report_.is_open ? ModelKind::outdoors : model_kind(scene_, options_.time);
        report_.unit = propose_unit(report_.extent.size(), volume, options_.read_as, report_.kind);
        if (options_.forecast_seconds > 0.0) {
            report_.costs = forecast_costs(
                scene_, options_.time, options_.forecast_seconds, executor_, options_.progress);
        }
        return std::move(report_);
    }

private:
    const std::vector<geometry::Triangle>& triangles() const { return scene_.mesh.triangles(); }

    void sample(const CheckedMesh& mesh) {
        std::vector<Vec3> points;
        for (const PlacedEmitter& emitter : emitters_) {
            points.push_back(emitter.position);
        }
        if (points.empty()) {
            report_.probe = find_probe(mesh, report_.extent, executor_);
            points.push_back(*report_.probe);
        }
        const ReachedSides reached = visibility::sample_reached_sides(
            mesh.bvh(),
            points,
            {.seed = options_.seed,
             .rays_per_point =
                 std::min(options_.max_rays, visibility::ReachedSidesOptions{}.rays_per_point),
             .max_rays = options_.max_rays,
             .tolerance = mesh.tolerance(),
             .progress = options_.progress},
            executor_);
        report_.rays = reached.rays;
        const Separation separation = separate(mesh);
        judge_emitters(separation, reached, points);
        // What is reached from within a solid alone is no air.
        std::vector<Vec3> seeds;
        is_air_.assign(reached.airs, false);
        for (std::size_t i = 0; i < points.size(); ++i) {
            if (!is_misplaced(i)) {
                seeds.push_back(points[i]);
                is_air_[reached.air_of_point[i]] = true;
            }
        }
        if (seeds.empty()) {
            seeds = points;
            is_air_.assign(reached.airs, true);
        }
        LeakSearch search = find_leaks(
            mesh,
            report_.topology,
            seeds,
            {.seed = options_.seed,
             .lambda = options_.lambda,
             .rays_per_point =
                 std::min(options_.max_rays, visibility::AirCutOptions{}.rays_per_point),
             .max_rays = std::min(options_.max_rays, visibility::AirCutOptions{}.max_rays),
             .tolerance = mesh.tolerance(),
             .progress = options_.progress},
            executor_);
        report_.leaks = std::move(search.leaks);
        report_.is_open = search.cut.is_open;
        find_unreached(mesh, reached, separation, points);
        find_reversed(mesh, reached, search.cut);
        find_layers(mesh, reached);
        measure_airs(mesh, reached, points);
        measure_materials(mesh, reached);
    }

    bool is_misplaced(std::size_t emitter) const {
        return std::any_of(report_.misplaced.begin(),
                           report_.misplaced.end(),
                           [&](const MisplacedEmitter& misplaced) {
                               return emitter < emitters_.size() &&
                                      misplaced.fault != EmitterFault::sealed &&
                                      misplaced.is_source == emitters_[emitter].is_source &&
                                      misplaced.index == emitters_[emitter].index;
                           });
    }

    /// Closed islands are barriers unless one of their materials lets sound through.
    Separation separate(const CheckedMesh& mesh) {
        std::vector<bool> is_barrier;
        for (const geometry::Island& island : report_.topology.islands) {
            is_barrier.push_back(island.is_closed);
        }
        std::vector<bool> is_transmissive;
        for (const Material& material : scene_.materials) {
            const auto points = material.transmission.points();
            is_transmissive.push_back(std::any_of(
                points.begin(), points.end(), [](const auto& point) { return point.value > 0.0; }));
        }
        for (std::size_t t = 0; t < mesh.size(); ++t) {
            const TriangleId id = mesh.original(t);
            if (is_transmissive[scene_.material_of_triangle[id]]) {
                is_barrier[report_.topology.island_of_triangle[id]] = false;
            }
        }
        surface_of_triangle_.resize(mesh.size());
        for (std::size_t t = 0; t < mesh.size(); ++t) {
            const std::uint32_t island = report_.topology.island_of_triangle[mesh.original(t)];
            surface_of_triangle_[t] = is_barrier[island] ? island : Separation::kNone;
        }
        return {mesh.bvh(), surface_of_triangle_};
    }

    void judge_emitters(const Separation& separation,
                        const ReachedSides& reached,
                        std::span<const Vec3> points) {
        if (emitters_.empty()) {
            return;
        }
        std::vector<std::optional<Separation::Enclosure>> enclosures;
        for (const Vec3& point : points) {
            enclosures.push_back(separation.enclosure(point));
        }
        report_.misplaced = find_misplaced(emitters_,
                                           {.reached = reached,
                                            .enclosures = enclosures,
                                            .surfaces = report_.topology.islands,
                                            .extent = report_.extent});
    }

    void find_unreached(const CheckedMesh& mesh,
                        const ReachedSides& reached,
                        const Separation& separation,
                        std::span<const Vec3> points) {
        std::vector<TriangleId> unreached;
        for (TriangleId t = 0; t < mesh.size(); ++t) {
            if (reached.air_of_side[visibility::front_of(t)] == ReachedSides::kNone &&
                reached.air_of_side[visibility::back_of(t)] == ReachedSides::kNone) {
                unreached.push_back(t);
                report_.unreached.push_back(mesh.original(t));
            }
        }
        for (const TriangleId t : separation.separated(unreached, points)) {
            report_.proven_unreached.push_back(mesh.original(t));
        }
    }

    bool is_in_air(const ReachedSides& reached, visibility::SideId side) const {
        const std::uint32_t air = reached.air_of_side[side];
        return air != ReachedSides::kNone && is_air_[air];
    }

    void find_reversed(const CheckedMesh& mesh,
                       const ReachedSides& reached,
                       const visibility::AirCut& cut) {
        std::vector<std::pair<std::uint32_t, TriangleId>> members;
        for (TriangleId t = 0; t < mesh.size(); ++t) {
            const visibility::SideId front = visibility::front_of(t);
            if (is_in_air(reached, visibility::back_of(t)) && !is_in_air(reached, front) &&
                cut.label_of_side[front] == SideLabel::solid) {
                const TriangleId id = mesh.original(t);
                report_.reversed_triangles.push_back(id);
                members.emplace_back(report_.topology.island_of_triangle[id], id);
            }
        }
        report_.reversed = grouped(positions_, triangles(), members);
    }

    void find_doubled() {
        using Key = std::pair<std::uint32_t, bool>;
        std::vector<std::pair<Key, TriangleId>> members;
        for (const geometry::DoubledFace& pair : report_.topology.doubled) {
            members.emplace_back(
                Key{report_.topology.island_of_triangle[pair.first], pair.is_reversed},
                pair.repeated);
        }
        report_.doubled = grouped(positions_, triangles(), members);
        std::map<TriangleId, bool> is_reversed;
        for (const geometry::DoubledFace& pair : report_.topology.doubled) {
            is_reversed[pair.repeated] = pair.is_reversed;
        }
        for (FaceGroup& group : report_.doubled) {
            group.is_reversed = is_reversed[group.first_triangle];
        }
    }

    /// Doubled faces that are cut into triangles in another way.
    void find_layers(const CheckedMesh& mesh, const ReachedSides& reached) {
        using Key = std::pair<std::uint32_t, bool>;
        std::map<Key, double> areas;
        std::vector<std::pair<Key, TriangleId>> members;
        std::map<TriangleId, Key> known;
        for (const frustum::LayerOverlap& overlap :
             find_exposed_layers(mesh, facets_, [&](visibility::SideId side) {
                 return is_in_air(reached, side);
             })) {
            const auto [a, b, c] = mesh.bvh().corners(overlap.first);
            const auto [p, q, r] = mesh.bvh().corners(overlap.second);
            const bool is_reversed =
                glm::dot(glm::cross(b - a, c - a), glm::cross(q - p, r - p)) < 0.0;
            const TriangleId id = mesh.original(overlap.second);
            const Key key{report_.topology.island_of_triangle[id], is_reversed};
            areas[key] += overlap.area;
            layered_area_ += overlap.area;
            if (known.try_emplace(id, key).second) {
                members.emplace_back(key, id);
            }
        }
        for (FaceGroup& group : grouped(positions_, triangles(), members)) {
            const Key& key = known.at(group.first_triangle);
            group.is_reversed = key.second;
            group.place.area = areas[key];
            report_.doubled.push_back(group);
        }
    }

    /// Volume and surface of each air, by rays, and exactly where the reached sides agree with
    /// them.
    void measure_airs(const CheckedMesh& mesh,
                      const ReachedSides& reached,
                      std::span<const Vec3> points) {
        report_.airs.resize(reached.airs);
        for (std::size_t i = 0; i < emitters_.size(); ++i) {
            SharedAir& air = report_.airs[reached.air_of_point[i]];
            (emitters_[i].is_source ? air.sources : air.listeners).push_back(emitters_[i].index);
        }
        std::vector<double> volumes(reached.airs, 0.0), surfaces(reached.airs, 0.0);
        for (visibility::SideId side = 0; side < reached.air_of_side.size(); ++side) {
            const std::uint32_t air = reached.air_of_side[side];
            if (air == ReachedSides::kNone) {
                continue;
            }
            // The divergence theorem; from a corner of the scene, for small rounding.
            const auto corners = mesh.bvh().corners(visibility::triangle_of(side));
            const Vec3 a = corners[0] - report_.extent.lower;
            const Vec3 b = corners[1] - report_.extent.lower;
            const Vec3 c = corners[2] - report_.extent.lower;
            const double outward = visibility::is_back(side) ? 1.0 : -1.0;
            volumes[air] += outward * glm::dot(a, glm::cross(b, c)) / 6.0;
            surfaces[air] += triangle_area(corners);
        }
        const std::vector<std::uint32_t> materials = materials_of(mesh);
        const RayScene scene{
            .bvh = mesh.bvh(), .material_of_triangle = materials, .materials = scene_.materials};
        for (std::uint32_t air = 0; air < reached.airs; ++air) {
            std::vector<Vec3> seeds;
            for (std::size_t i = 0; i < points.size(); ++i) {
                if (reached.air_of_point[i] == air) {
                    seeds.push_back(points[i]);
                }
            }
            const auto room = room_statistics(scene, seeds, {}, executor_);
            if (!room) {
                continue;
            }
            const auto agrees = [](double exact, double sampled) {
                return std::abs(exact - sampled) <= kMaxVolumeDeviation * sampled;
            };
            const bool is_exact = layered_area_ == 0.0 && room->opening == 0.0 &&
                                  agrees(volumes[air], room->volume) &&
                                  agrees(surfaces[air], room->surface);
            report_.airs[air].volume = is_exact ? volumes[air] : room->volume;
            report_.airs[air].surface = is_exact ? surfaces[air] : room->surface;
            if (layered_area_ > 0.0 && reached.airs == 1) {
                // Rays meet either layer by rounding, so that both have counted as surface.
                const double single = std::max(0.0, room->surface - layered_area_);
                report_.airs[air].volume *= single / room->surface;
                report_.airs[air].surface = single;
            }
        }
    }

    std::vector<std::uint32_t> materials_of(const CheckedMesh& mesh) const {
        std::vector<std::uint32_t> materials;
        for (std::size_t t = 0; t < mesh.size(); ++t) {
            materials.push_back(scene_.material_of_triangle[mesh.original(t)]);
        }
        return materials;
    }

    void measure_materials(const CheckedMesh& mesh, const ReachedSides& reached) {
        for (visibility::SideId side = 0; side < reached.air_of_side.size(); ++side) {
            if (is_in_air(reached, side)) {
                const TriangleId t = visibility::triangle_of(side);
                report_.materials[scene_.material_of_triangle[mesh.original(t)]].area +=
                    mesh.area(t);
            }
        }
        double sum = 0.0;
        std::vector<double> absorbed;
        for (std::size_t i = 0; i < report_.materials.size(); ++i) {
            const EnergyCoefficient& absorption = scene_.materials[i].absorption;
            const double mid = 0.5 * (absorption.at(500.0) + absorption.at(1000.0));
            absorbed.push_back(report_.materials[i].area * mid);
            sum += absorbed.back();
        }
        for (std::size_t i = 0; i < report_.materials.size(); ++i) {
            report_.materials[i].absorption_share = sum > 0.0 ? absorbed[i] / sum : 0.0;
        }
    }

    void judge_materials() {
        const auto contains = [](std::span<const std::uint32_t> ascending, std::size_t value) {
            return std::binary_search(ascending.begin(), ascending.end(), value);
        };
        report_.materials.resize(scene_.materials.size());
        for (std::size_t i = 0; i < scene_.materials.size(); ++i) {
            MaterialUse& use = report_.materials[i];
            use.origin = contains(options_.default_materials, i)   ? MaterialOrigin::none
                         : contains(options_.materials_by_name, i) ? MaterialOrigin::by_name
                         : is_of_library(scene_.materials[i])      ? MaterialOrigin::library
                                                                   : MaterialOrigin::stated;
            // The library means what it says, an opening that absorbs everything included.
            if (use.origin == MaterialOrigin::stated) {
                add_doubts(scene_.materials[i], use.doubts);
            }
        }
    }

    static bool is_of_library(const Material& material) {
        const auto row = find_library_material(material.name);
        const auto equals = [](const EnergyCoefficient& a, const EnergyCoefficient& b) {
            return std::equal(a.points().begin(),
                              a.points().end(),
                              b.points().begin(),
                              b.points().end(),
                              [](const auto& p, const auto& q) {
                                  return p.frequency_hz == q.frequency_hz && p.value == q.value;
                              });
        };
        return row && equals(row->absorption, material.absorption) &&
               equals(row->scattering, material.scattering) &&
               equals(row->transmission, material.transmission);
    }

    static void add_doubts(const Material& material, std::vector<std::string>& doubts) {
        const auto is_all = [](const EnergyCoefficient& coefficient, double value) {
            const auto points = coefficient.points();
            return std::all_of(points.begin(), points.end(), [value](const auto& point) {
                return point.value == value;
            });
        };
        if (is_all(material.absorption, 0.0)) {
            doubts.emplace_back(kAbsorbsNothing);
        } else if (is_all(material.absorption, 1.0)) {
            doubts.emplace_back(kAbsorbsEverything);
        } else if (is_all(material.absorption, material.absorption.points().front().value)) {
            doubts.emplace_back(kAbsorbsTheSame);
        }
        if (is_all(material.scattering, 0.0)) {
            doubts.emplace_back(kScattersNothing);
        }
    }

    void find_small_facets(const CheckedMesh& mesh) {
        std::vector<geometry::VertexId> weld(positions_.size());
        std::iota(weld.begin(), weld.end(), geometry::VertexId{0});
        facets_ = geometry::find_facets(mesh.view(), weld, materials_of(mesh), executor_);
        std::vector<std::pair<double, double>> sizes;  // extent and area
        double area_of_all = 0.0;
        for (const geometry::Facet& facet : facets_.facets) {
            Vec3 lower = mesh.bvh().corners(facet.triangles.front())[0];
            Vec3 upper = lower;
            double area = 0.0;
            for (const TriangleId t : facet.triangles) {
                for (const Vec3& corner : mesh.bvh().corners(t)) {
                    lower = glm::min(lower, corner);
                    upper = glm::max(upper, corner);
                }
                area += mesh.area(t);
            }
            sizes.emplace_back(glm::length(upper - lower), area);
            area_of_all += area;
        }
        for (const double frequency : {125.0, 250.0, 500.0, 1000.0, 2000.0, 4000.0, 8000.0}) {
            SmallFacets small{.frequency_hz = frequency,
                              .half_wavelength = 0.5 * speed_of_sound(Air{}) / frequency};
            for (const auto& [extent, area] : sizes) {
                if (extent < small.half_wavelength) {
                    ++small.facets;
                    small.area += area;
                }
            }
            small.area_share = small.area / area_of_all;
            report_.small_facets.push_back(small);
        }
    }

    const Scene& scene_;
    const ModelCheckOptions& options_;
    Executor& executor_;
    std::vector<Vec3> positions_;
    std::vector<PlacedEmitter> emitters_;
    std::vector<std::uint32_t> surface_of_triangle_;  // of the checked mesh
    std::vector<bool> is_air_;                        // per air: not only that within solids
    geometry::Facets facets_;                         // of the checked mesh
    double layered_area_ = 0.0;                       // square metres of find_layers()
    ModelReport report_;
};

}  // namespace

ModelReport check_model(const Scene& scene, const ModelCheckOptions& options, Executor& executor) {
    return Examination(scene, options, executor).run();
}

}  // namespace earshot::propagation
