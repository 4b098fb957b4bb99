// SPDX-License-Identifier: MIT
#include "earshot/propagation/simulator.h"

#include "earshot/base/stage_progress.h"
#include "earshot/frustum/find_specular_paths.h"
#include "earshot/frustum/path_finder.h"
#include "earshot/frustum/surface_points.h"
#include "earshot/geometry/tolerance.h"
#include "earshot/propagation/internal/coincident_materials.h"
#include "earshot/propagation/internal/first_facets.h"
#include "earshot/propagation/internal/simulator_state.h"
#include "earshot/propagation/internal/undecided_point.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <limits>
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
