// SPDX-License-Identifier: MIT
#include "earshot/propagation/simulator.h"

#include "earshot/bvh/quality.h"
#include "earshot/geometry/facets.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <utility>

namespace earshot::propagation {

using geometry::Vec3;

namespace {

/// A refitted tree is kept until its cost has grown by this factor. The answers are the same either
/// way; a rebuild costs some tens of refits.
constexpr double kRebuildAtCost = 1.5;

Vec3 direction_between(const Vec3& from, const Vec3& to) {
    const double length = glm::distance(from, to);
    return length > 0.0 ? (to - from) / length : Vec3(0.0);
}

}  // namespace

std::string_view name_of(PathKind kind) noexcept {
    return kind == PathKind::direct ? "direct" : "specular";
}

struct Simulator::State {
    State(const Scene& the_scene, const Options& the_options)
        : scene(the_scene),
          options(the_options),
          speed_of_sound(propagation::speed_of_sound(the_options.air)) {
        for (const Material& material : scene.materials) {
            reflection.push_back(reflected_pressure(material, options.bands));
        }
    }

    const Scene& scene;
    Options options;
    double speed_of_sound = 0.0;
    std::vector<audio::Spectrum> reflection;  // pressure factor per material

    double time = 0.0;
    std::vector<Vec3> positions;
    std::vector<geometry::TriangleId> kept;
    std::vector<geometry::Triangle> triangles;  // the kept ones
    geometry::Facets facets;
    std::vector<std::uint8_t> one_sided;  // per facet
    bvh::Tree tree;
    double cost_when_built = 0.0;
    GeometrySummary summary;
    frustum::TraceStatistics statistics;

    geometry::MeshView mesh() const { return {positions, triangles}; }
    void move_geometry(Executor& executor);
    void update_tree(bool same_triangles, Executor& executor);
    void find_facets();
    Path describe(const frustum::SpecularPath& specular) const;
};

void Simulator::State::move_geometry(Executor& executor) {
    positions = scene.mesh.positions_at(time);
    geometry::CleanMesh clean = geometry::clean({positions, scene.mesh.triangles()});
    if (clean.kept.empty()) {
        throw Error(scene.name,
                    "no triangle with an area is left after clean-up",
                    "export the scene with triangles");
    }
    const bool same_triangles = clean.kept == kept;
    kept = std::move(clean.kept);
    triangles.resize(kept.size());
    std::vector<std::uint32_t> labels(kept.size());
    for (std::size_t i = 0; i < kept.size(); ++i) {
        triangles[i] = scene.mesh.triangles()[kept[i]];
        labels[i] = scene.material_of_triangle[kept[i]];
    }
    update_tree(same_triangles, executor);
    facets = geometry::find_facets(mesh(), clean.weld, labels);
    one_sided.clear();
    for (const geometry::Facet& facet : facets.facets) {
        const std::uint32_t material = labels[facet.triangles.front()];
        one_sided.push_back(scene.materials[material].one_sided ? 1 : 0);
    }
    summary = {.clean = clean.report, .triangles = kept.size(), .facets = facets.facets.size()};
}

void Simulator::State::update_tree(bool same_triangles, Executor& executor) {
    const auto boxes = bvh::triangle_boxes(mesh(), executor);
    if (same_triangles) {
        tree.refit(boxes, executor);
        if (bvh::sah_cost(tree) <= kRebuildAtCost * cost_when_built) {
            return;
        }
    }
    tree = bvh::Tree::build(boxes, {}, executor);
    cost_when_built = bvh::sah_cost(tree);
}

Path Simulator::State::describe(const frustum::SpecularPath& specular) const {
    Path path;
    path.order = static_cast<int>(specular.triangles.size());
    path.kind = path.order == 0 ? PathKind::direct : PathKind::specular;
    path.length = specular.length;
    path.delay = specular.length / speed_of_sound;
    path.points = specular.points;
    const std::size_t bands = options.bands.count();
    std::fill_n(path.pressure.begin(), bands, 1.0 / specular.length);
    if (options.air_absorption) {
        const audio::Spectrum air = air_pressure(options.air, options.bands, specular.length);
        for (std::size_t band = 0; band < bands; ++band) {
            path.pressure[band] *= air[band];
        }
    }
    for (const geometry::TriangleId triangle : specular.triangles) {
        const geometry::TriangleId in_file = kept[triangle];
        const std::uint32_t material = scene.material_of_triangle[in_file];
        path.triangles.push_back(in_file);
        path.materials.push_back(material);
        for (std::size_t band = 0; band < bands; ++band) {
            path.pressure[band] *= reflection[material][band];
        }
    }
    // At a corner two reflection points coincide; the last two distinct points give the direction.
    path.departure = direction_between(path.points[0], path.points[1]);
    path.arrival = direction_between(path.points[path.points.size() - 2], path.points.back());
    return path;
}

Simulator::Simulator(const Scene& scene, const Options& options, Executor& executor) {
    validate(options.air);
    state_ = std::make_unique<State>(scene, options);
    state_->move_geometry(executor);
}

Simulator::~Simulator() = default;
Simulator::Simulator(Simulator&&) noexcept = default;
Simulator& Simulator::operator=(Simulator&&) noexcept = default;

void Simulator::set_time(double time, Executor& executor) {
    if (time != state_->time && state_->scene.mesh.duration() > 0.0) {
        state_->time = time;
        state_->move_geometry(executor);
    }
    state_->time = time;
}

std::vector<PairResult> Simulator::run(Executor& executor) {
    const State& state = *state_;
    const Scene& scene = state.scene;
    std::vector<Vec3> listeners;
    for (const Emitter& listener : scene.listeners) {
        listeners.push_back(scene.position_at(listener, state.time));
    }
    const frustum::TraceOptions trace_options = {.max_order = state.options.specular_order,
                                                 .mode = state.options.mode,
                                                 .resolution = state.options.resolution};
    state_->statistics = {};
    std::vector<PairResult> pairs;
    for (std::size_t source = 0; source < scene.sources.size(); ++source) {
        const auto trace =
            frustum::find_specular_paths(surroundings(),
                                         scene.position_at(scene.sources[source], state.time),
                                         listeners,
                                         trace_options,
                                         executor);
        state_->statistics.frusta += trace.statistics.frusta;
        state_->statistics.candidates += trace.statistics.candidates;
        state_->statistics.paths += trace.statistics.paths;
        const std::size_t first = pairs.size();
        for (std::size_t listener = 0; listener < listeners.size(); ++listener) {
            pairs.push_back(
                {.source = source, .listener = listener, .time = state.time, .paths = {}});
        }
        for (const frustum::SpecularPath& specular : trace.paths) {
            if (specular.length > 0.0) {
                pairs[first + specular.listener].paths.push_back(state.describe(specular));
            }
        }
    }
    return pairs;
}

frustum::Surroundings Simulator::surroundings() const noexcept {
    return {.tree = state_->tree,
            .mesh = state_->mesh(),
            .facets = state_->facets,
            .one_sided = state_->one_sided};
}

const GeometrySummary& Simulator::geometry() const noexcept {
    return state_->summary;
}

const frustum::TraceStatistics& Simulator::statistics() const noexcept {
    return state_->statistics;
}

std::vector<audio::Arrival> arrivals_of(const PairResult& pair) {
    std::vector<audio::Arrival> arrivals;
    for (const Path& path : pair.paths) {
        arrivals.push_back({.delay = path.delay,
                            .pressure = path.pressure,
                            .direction = {path.arrival.x, path.arrival.y, path.arrival.z}});
    }
    return arrivals;
}

}  // namespace earshot::propagation
