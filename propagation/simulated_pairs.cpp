// SPDX-License-Identifier: MIT
// What the simulator finds out about the pairs of a source: paths, arrivals and late sound.
#include "earshot/base/math.h"
#include "earshot/base/stage_progress.h"
#include "earshot/geometry/vector.h"
#include "earshot/propagation/internal/diffracted_paths.h"
#include "earshot/propagation/internal/first_facets.h"
#include "earshot/propagation/internal/lattice_arrivals.h"
#include "earshot/propagation/internal/radiated_sound.h"
#include "earshot/propagation/internal/simulator_state.h"
#include "earshot/propagation/late_rays.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

namespace earshot::propagation {

using geometry::Vec3;

RayOptions Simulator::State::ray_options(const RaySource& source, Executor& executor) const {
    RayOptions rays = {.rays = options.rays,
                       .max_error = options.max_error,
                       .seed = options.seed,
                       .specular_order = options.specular_order,
                       .bands = options.bands,
                       .air = options.air,
                       .air_absorption = options.air_absorption,
                       .transmission = options.transmission,
                       .rain_radius = options.rain_radius,
                       .weight_window = options.weight_window,
                       .report_directions = options.late_directions,
                       .report_materials = options.report_materials,
                       .report_scattering = options.report_scattering};
    constexpr double kDecades = 6.5;  // that late_length() holds
    const double decay_length = late_length(geometry.ray_scene(), source, rays, executor);
    rays.length = options.late_length > 0.0 ? options.late_length : decay_length;
    rays.decay_time = decay_length * 6.0 / kDecades;
    return rays;
}

bool Simulator::State::is_wanted(const Path& path) const {
    return path.length > 0.0 &&
           std::any_of(path.pressure.begin(),
                       path.pressure.begin() + static_cast<std::ptrdiff_t>(options.bands.count()),
                       [&](double p) { return std::abs(p) >= min_pressure; });
}

// `air_pressures`: per band, over the path's length.
Path Simulator::State::describe(const frustum::SpecularPath& specular,
                                const double* air_pressures) const {
    Path path;
    path.order = static_cast<int>(specular.triangles.size());
    path.kind = path.order == 0                ? PathKind::direct
                : specular.transmitted.empty() ? PathKind::specular
                                               : PathKind::transmitted;
    path.length = specular.length;
    path.delay = specular.length / speed_of_sound;
    path.points = specular.points;
    const std::size_t bands = options.bands.count();
    std::fill_n(path.pressure.begin(), bands, 1.0 / specular.length);
    if (options.air_absorption) {
        for (std::size_t band = 0; band < bands; ++band) {
            path.pressure[band] *= air_pressures[band];
        }
    }
    path.transmitted = specular.transmitted;
    path.triangles.reserve(specular.triangles.size());
    path.materials.reserve(specular.triangles.size());
    for (std::size_t i = 0; i < specular.triangles.size(); ++i) {
        const bool transmitted = !specular.transmitted.empty() && specular.transmitted[i] != 0;
        const geometry::TriangleId in_file = geometry.kept()[specular.triangles[i]];
        const std::uint32_t material = scene.material_of_triangle[in_file];
        path.triangles.push_back(in_file);
        path.materials.push_back(material);
        for (std::size_t band = 0; band < bands; ++band) {
            path.pressure[band] *= (transmitted ? transmission : reflection)[material][band];
        }
    }
    // At a corner two reflection points coincide; the last two distinct points give the direction.
    path.departure = geometry::direction_between(path.points[0], path.points[1]);
    path.arrival =
        geometry::direction_between(path.points[path.points.size() - 2], path.points.back());
    return path;
}

void Simulator::State::add_paths(std::size_t source,
                                 const RaySource& sender,
                                 const frustum::PlacedPairs& placed,
                                 std::span<PairResult> pairs,
                                 Executor& executor,
                                 Progress* progress) {
    const Vec3& position = sender.pose.position;
    const frustum::TraceResult traced = trace(source, position, placed, executor, progress);
    progress->report("tracing", 1, 1);  // also where there was no beam tree to report
    statistics += traced.statistics;
    queries +=
        traced.statistics.candidates * static_cast<std::uint64_t>(options.specular_order + 1);
    std::vector<double> lengths;
    lengths.reserve(traced.paths.size());
    for (const frustum::SpecularPath& specular : traced.paths) {
        lengths.push_back(specular.length);
    }
    const std::vector<double> air_pressures = air.pressures(lengths);
    const double* of_air = air_pressures.data();
    for (const frustum::SpecularPath& specular : traced.paths) {
        Path path = describe(specular, of_air);
        of_air += air.stride();
        radiate(sender, options.bands, path);
        if (placed.is_moved) {
            path.points.front() = position;
            path.points.back() = listeners->listeners()[specular.listener];
        }
        if (is_wanted(path)) {
            pairs[specular.listener].paths.push_back(std::move(path));
        }
    }
}

void Simulator::State::add_diffracted_paths(const RaySource& sender,
                                            const frustum::PlacedPairs& placed,
                                            std::span<PairResult> pairs,
                                            Executor& executor) {
    if (options.diffraction == 0) {
        return;
    }
    if (!diffracted) {
        const DiffractionSettings settings = {
            .bands = options.bands,
            .air = air,
            .reflection = reflection,
            .speed_of_sound = speed_of_sound,
            .air_absorption = options.air_absorption,
            .max_order = options.specular_order,
            .max_edges = options.diffraction,
            .keep_traces = options.keep_traces,
            .max_length = options.max_length,
            .min_pressure = min_pressure,
            .min_pressure_ratio = math::pow10(options.min_diffraction_level_db / 20.0)};
        diffracted.emplace(scene, geometry, settings, executor);
    }
    diffracted->add(sender, placed, listeners->listeners(), pairs, executor);
}

// The arrivals of the pairs in a box, without their paths. False: some pair needs its paths.
bool Simulator::State::add_arrivals(const RaySource& sender,
                                    const frustum::PlacedPairs& placed,
                                    std::span<PairResult> pairs,
                                    Executor& executor) {
    const Vec3& position = sender.pose.position;
    if (!needs_facets || options.diffraction > 0 || placed.is_moved ||
        !sender.directivity.is_omnidirectional() || !finder->is_box() ||
        !first_facets(position, executor).empty()) {
        return false;
    }
    std::vector<audio::Spectrum> reflection_of_facet;
    for (const geometry::Facet& facet : geometry.facets(executor).facets) {
        const geometry::TriangleId in_file = geometry.kept()[facet.triangles.front()];
        reflection_of_facet.push_back(reflection[scene.material_of_triangle[in_file]]);
    }
    const ArrivalModel model = {.bands = options.bands.count(),
                                .speed_of_sound = speed_of_sound,
                                .air = air,
                                .air_absorption = options.air_absorption,
                                .reflection = reflection_of_facet,
                                .min_pressure = min_pressure};
    std::vector<std::uint8_t> is_done(pairs.size(), 0);
    executor.for_each(pairs.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const Vec3& listener = listeners->listeners()[i];
            if (auto found = finder->find_arrivals(position, listener)) {
                pairs[i].arrivals = describe_arrivals(*found, listener, model);
                is_done[i] = 1;
            }
        }
    });
    const bool is_complete = std::find(is_done.begin(), is_done.end(), 0) == is_done.end();
    for (PairResult& pair : pairs) {
        if (is_complete) {
            statistics.paths += pair.arrivals.size();
        } else {
            pair.arrivals.clear();
        }
    }
    return is_complete;
}

// Adds late sound to the pairs of a source, and gives them away.
void Simulator::State::add_late_sound(const RaySource& sender,
                                      const frustum::PlacedPairs& placed,
                                      std::span<PairResult> pairs,
                                      const VisitPair& visit,
                                      Executor& executor,
                                      Progress* progress) {
    for (std::size_t i = 0; i < placed.groups.size(); ++i) {
        const frustum::PlacedListeners& group = placed.groups[i];
        PartProgress part(progress, i, placed.groups.size());
        RaySource placed_sender = sender;
        placed_sender.pose.position = group.source;
        const auto add = [&](std::size_t k, LateSound&& late) {
            PairResult& pair = pairs[group.numbers[k]];
            pair.late_errors = late.errors;
            pair.visible_volume = late.visible_volume;
            if (!is_silent(late.histogram)) {
                pair.late = std::move(late.histogram);
                pair.late.full_decay = options.late_length == 0.0;
                pair.late_replicates = std::move(late.replicates);
                pair.late_materials = std::move(late.materials);
            }
            visit(std::move(pair));
        };
        const LateTotals totals = visit_late_sound(geometry.ray_scene(),
                                                   placed_sender,
                                                   group.positions,
                                                   add,
                                                   ray_options(placed_sender, executor),
                                                   executor,
                                                   &part);
        // A leg of a ray, and a shadow ray to each listener.
        queries += totals.balance.bounces * (1 + group.positions.size());
    }
}

}  // namespace earshot::propagation
