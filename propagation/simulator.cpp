// SPDX-License-Identifier: MIT
#include "earshot/propagation/simulator.h"

#include "earshot/base/math.h"
#include "earshot/base/stage_progress.h"
#include "earshot/frustum/find_specular_paths.h"
#include "earshot/frustum/path_finder.h"
#include "earshot/frustum/surface_points.h"
#include "earshot/geometry/tolerance.h"
#include "earshot/geometry/vector.h"
#include "earshot/propagation/internal/coincident_materials.h"
#include "earshot/propagation/internal/diffracted_paths.h"
#include "earshot/propagation/internal/first_facets.h"
#include "earshot/propagation/internal/lattice_arrivals.h"
#include "earshot/propagation/internal/radiated_sound.h"
#include "earshot/propagation/internal/simulator_state.h"
#include "earshot/propagation/internal/undecided_point.h"
#include "earshot/propagation/late_rays.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <utility>

namespace earshot::propagation {

using geometry::Vec3;

namespace {

/// What pressures may differ by for having been multiplied in another order.
constexpr double kRoom = 1.0 - 0x1p-40;

}  // namespace

void Simulator::State::move_geometry(double to, Executor& executor) {
    if (geometry.move(to, static_cast<double>(queries), executor)) {
        finder_is_current = false;
        diffracted.reset();
    }
}

void Simulator::State::check_visible_sets() const {
    const visibility::VisibleSets* sets = options.visible_sets;
    if (sets != nullptr &&
        (sets->objects().object_of_triangle().size() != scene.mesh.triangles().size() ||
         sets->provenance().mesh_digest !=
             visibility::mesh_digest({geometry.positions(), scene.mesh.triangles()}))) {
        throw Error("visible sets",
                    "they are of " + sets->provenance().scene + " in another shape than " +
                        scene.name + " has now",
                    "build them for this scene and instant");
    }
}

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

Simulator::Simulator(const Scene& scene, const Options& options, Executor& executor) {
    validate(options.air);
    if (options.diffraction < 0 || options.diffraction > kMaxDiffraction) {
        throw Error("diffraction",
                    "over " + std::to_string(options.diffraction) + " edges",
                    "choose 0 to " + std::to_string(kMaxDiffraction));
    }
    for (const Material& material : scene.materials) {
        validate(material);
    }
    state_ = std::make_unique<State>(scene, options);
    state_->move_geometry(state_->time, executor);
}

Simulator::~Simulator() = default;
Simulator::Simulator(Simulator&&) noexcept = default;
Simulator& Simulator::operator=(Simulator&&) noexcept = default;

void Simulator::set_time(double time, Executor& executor) {
    if (time != state_->time && state_->scene.mesh.duration() > 0.0) {
        state_->move_geometry(time, executor);
    }
    state_->time = time;
}

// Direct sound alone, which nothing transmits, between points in the air needs no facets.
bool Simulator::State::requires_facets(std::span<const Vec3> from, std::span<const Vec3> to) const {
    const bvh::MeshBvh bvh = geometry.bvh();
    const double tolerance = geometry::coplanar_tolerance(bvh.mesh());
    const auto is_on_surface = [&](const Vec3& point) {
        return bvh.closest_point(point, tolerance).has_value();
    };
    return options.specular_order > 0 || options.transmission || options.diffraction > 0 ||
           std::any_of(from.begin(), from.end(), is_on_surface) ||
           std::any_of(to.begin(), to.end(), is_on_surface);
}

frustum::TraceOptions Simulator::State::trace_options() const {
    double loudest = 1.0;
    for (const Emitter& source : scene.sources) {
        loudest = std::max(loudest, source.directivity.loudest());
    }
    return {.max_order = options.specular_order,
            .mode = options.mode,
            .resolution = options.resolution,
            .max_length = options.max_length,
            // Air only takes; the last word is is_wanted().
            .min_pressure = kRoom * min_pressure / loudest,
            .box_lattice = options.box_lattice};
}

// A finder serves as long as the geometry and the farthest emitter stay. `frusta`: of the last run.
void Simulator::State::prepare_finder(std::span<const Vec3> from,
                                      std::span<const Vec3> to,
                                      std::uint64_t frusta,
                                      Executor& executor) {
    double max_radius = std::numeric_limits<double>::min();
    for (const auto& points : {from, to}) {
        for (const Vec3& point : points) {
            max_radius = std::max(max_radius, glm::length(point));
        }
    }
    const bool is_too_near = !finder || finder->max_radius() < max_radius;
    if (!finder_is_current || is_too_near) {
        constexpr double kRoomToMove = 4.0;
        // Nodes that a frustum visits, about, over those that a ray does.
        constexpr double kQueriesPerFrustum = 8.0;
        const frustum::FinderOptions finder_options = {
            .trace = trace_options(),
            .forward_only = frustum::prefer_forward(to.size(), options.specular_order),
            // As before if it serves, so that what is kept does.
            .max_radius = is_too_near ? kRoomToMove * max_radius : finder->max_radius(),
            .listener_count = to.size(),
            .track_changes = options.keep_traces};
        if (!options.keep_traces) {
            sources.clear();
            listeners.reset();
        }
        if (finder) {
            finder->move_to(geometry.scene_view(executor),
                            finder_options,
                            kQueriesPerFrustum * static_cast<double>(frusta),
                            executor);
        } else {
            finder.emplace(geometry.scene_view(executor), finder_options, executor);
        }
        finder_is_current = true;
    }
    sources.resize(from.size());
    prepare_listeners(to, executor);
}

void Simulator::State::prepare_listeners(std::span<const Vec3> to, Executor& executor) {
    const auto are_where = [&](std::span<const Vec3> others) {
        return std::equal(to.begin(), to.end(), others.begin(), others.end());
    };
    if (!listeners || !are_where(listeners->listeners())) {
        listeners.emplace(finder->trace_listeners(to, executor));
        statistics.frusta += listeners->frusta();
        return;
    }
    const bool is_current = finder->is_current(*listeners);
    finder->update(*listeners, executor);
    statistics.kept_frusta += is_current ? listeners->frusta() : listeners->kept_frusta();
    statistics.frusta += is_current ? 0 : listeners->frusta() - listeners->kept_frusta();
}

frustum::PlacedPairs Simulator::State::place(const Emitter& source,
                                             const Vec3& position,
                                             std::span<const Vec3> to,
                                             Executor& executor) const {
    if (!needs_facets) {
        return frustum::pairs_in_the_air(position, to);
    }
    frustum::PlacedPairs placed = frustum::place_pairs(geometry.scene_view(executor), position, to);
    if (placed.undecided) {
        const frustum::UndecidedPoint& point = *placed.undecided;
        throw undecided_point_error(
            point, source, scene.listeners[point.listener], geometry.kept()[point.triangle]);
    }
    return placed;
}

frustum::TraceResult Simulator::State::trace(std::size_t source,
                                             const Vec3& position,
                                             const frustum::PlacedPairs& placed,
                                             Executor& executor,
                                             Progress* progress) {
    if (!needs_facets) {
        return frustum::find_direct_paths(geometry.bvh(), placed, trace_options());
    }
    const std::vector<std::uint8_t> first = first_facets(position, executor);
    if (placed.is_moved) {
        return finder->find(placed, first, executor);
    }
    KeptSource& kept = sources[source];
    if (!options.keep_traces || kept.is_too_large) {
        return finder->find(position, *listeners, first, executor, progress);
    }
    return trace_kept(kept, position, first, executor, progress);
}

frustum::TraceResult Simulator::State::trace_kept(KeptSource& kept,
                                                  const Vec3& position,
                                                  std::span<const std::uint8_t> first,
                                                  Executor& executor,
                                                  Progress* progress) {
    auto& beams = kept.beams;
    std::size_t kept_frusta = 0;
    if (!beams || beams->source() != position) {
        beams.emplace(finder->trace_source(position, first, executor, progress));
    } else if (finder->is_current(*beams)) {
        kept_frusta = beams->frusta();
    } else {
        finder->update(*beams, first, executor, progress);
        kept_frusta = beams->kept_frusta();
    }
    frustum::TraceResult result = finder->connect(*beams, *listeners, kept.verdicts, executor);
    result.statistics.kept_frusta += kept_frusta;
    result.statistics.frusta += beams->frusta() - kept_frusta;
    if (beams->bytes() > kMaxKeptBytes / sources.size()) {
        kept = KeptSource();
        kept.is_too_large = true;
    }
    return result;
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

std::vector<PairResult> Simulator::run(Executor& executor, Progress* progress) {
    const std::size_t listeners = state_->scene.listeners.size();
    const std::vector<std::size_t>& selected = state_->selected;
    std::vector<PairResult> pairs(selected.size() * listeners);
    for_each_pair(
        [&](PairResult&& pair) {
            const auto place = std::lower_bound(selected.begin(), selected.end(), pair.source);
            const auto row = static_cast<std::size_t>(place - selected.begin());
            pairs[row * listeners + pair.listener] = std::move(pair);
        },
        executor,
        progress);
    return pairs;
}

void Simulator::select_sources(std::vector<std::size_t> sources) {
    state_->selected = std::move(sources);
}

void Simulator::for_each_pair(const VisitPair& visit, Executor& executor, Progress* progress) {
    State& state = *state_;
    state.check_visible_sets();
    // Where sources and listeners are, and a result for each pair of them.
    std::vector<RaySource> senders;
    std::vector<Vec3> sources, listeners;
    for (const Emitter& emitter : state.scene.sources) {
        senders.push_back(
            {.pose = state.scene.pose_at(emitter, state.time), .directivity = emitter.directivity});
        sources.push_back(senders.back().pose.position);
    }
    for (const Emitter& emitter : state.scene.listeners) {
        listeners.push_back(state.scene.position_at(emitter, state.time));
    }
    std::vector<PairResult> pairs;
    for (std::size_t source = 0; source < sources.size(); ++source) {
        for (std::size_t listener = 0; listener < listeners.size(); ++listener) {
            pairs.push_back({.source = source,
                             .listener = listener,
                             .key = pair_key(state.scene, source, listener),
                             .time = state.time});
        }
    }
    const auto pairs_of = [&](std::size_t source) {
        return std::span(pairs).subspan(source * listeners.size(), listeners.size());
    };

    // Early sound: exact paths.
    state.queries = 0;
    const std::uint64_t frusta = std::exchange(state.statistics, {}).frusta;
    state.needs_facets = state.requires_facets(sources, listeners);
    if (state.needs_facets) {
        state.prepare_finder(sources, listeners, frusta, executor);
    }
    const std::vector<std::size_t>& selected = state.selected;
    std::vector<frustum::PlacedPairs> placed(sources.size());
    for (std::size_t part_number = 0; part_number < selected.size(); ++part_number) {
        const std::size_t source = selected[part_number];
        placed[source] =
            state.place(state.scene.sources[source], sources[source], listeners, executor);
        PartProgress part(progress, part_number, selected.size());
        const std::span<PairResult> of_source = pairs_of(source);
        const RaySource& sender = senders[source];
        if (!state.options.report_paths &&
            state.add_arrivals(sender, placed[source], of_source, executor)) {
            part.report("tracing", 1, 1);
            continue;
        }
        state.add_paths(source, sender, placed[source], of_source, executor, &part);
        state.add_diffracted_paths(sender, placed[source], of_source, executor);
        for (PairResult& pair : of_source) {
            if (!state.options.report_paths) {
                pair.arrivals = arrivals_of(pair);
                pair.paths.clear();
            }
        }
    }
    if (state.diffracted && state.options.keep_traces) {
        state.diffracted->discard_unused();
    }
    // Late sound: rays.
    for (std::size_t part_number = 0; part_number < selected.size(); ++part_number) {
        const std::size_t source = selected[part_number];
        const std::span<PairResult> of_source = pairs_of(source);
        if (state.options.rays > 0) {
            PartProgress part(progress, part_number, selected.size());
            state.add_late_sound(
                senders[source], placed[source], of_source, visit, executor, &part);
        } else {
            executor.for_each(of_source.size(), 1, [&](std::size_t begin, std::size_t end) {
                for (std::size_t i = begin; i < end; ++i) {
                    visit(std::move(of_source[i]));
                }
            });
        }
    }
}

frustum::SceneView Simulator::scene_view(Executor& executor) const {
    return state_->geometry.scene_view(executor);
}

std::vector<geometry::FacetId> Simulator::facet_of_triangle(Executor& executor) const {
    const SceneGeometry& geometry = state_->geometry;
    std::vector<geometry::FacetId> facets(state_->scene.mesh.triangles().size(), kNoFacet);
    const geometry::Facets& found = geometry.facets(executor);
    for (std::size_t i = 0; i < geometry.kept().size(); ++i) {
        facets[geometry.kept()[i]] = found.of_triangle[i];
    }
    return facets;
}

RayScene Simulator::ray_scene() const noexcept {
    return state_->geometry.ray_scene();
}

GeometrySummary Simulator::geometry(Executor& executor) const {
    const SceneGeometry& geometry = state_->geometry;
    return {.clean = geometry.clean_report(executor),
            .triangles = geometry.kept().size(),
            .facets = geometry.facets(executor).facets.size()};
}

Warnings Simulator::warnings(Executor& executor) const {
    const SceneGeometry& geometry = state_->geometry;
    return coincident_materials(
        state_->scene, geometry.scene_view(executor), geometry.kept(), geometry.duplicates());
}

HierarchyStatistics Simulator::hierarchy_statistics() const noexcept {
    HierarchyStatistics statistics{.triangle_builds = state_->geometry.hierarchies_built(),
                                   .updates = state_->geometry.update_statistics()};
    if (state_->finder) {
        statistics.facet_builds = state_->finder->hierarchies_built();
        statistics.updates += state_->finder->updates();
    }
    return statistics;
}

const frustum::TraceStatistics& Simulator::statistics() const noexcept {
    return state_->statistics;
}

}  // namespace earshot::propagation
