// SPDX-License-Identifier: MIT
#include "earshot/propagation/internal/arrival_matching.h"

#include "earshot/geometry/vector.h"
#include "earshot/propagation/simulator.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

namespace earshot::propagation {
namespace {

using geometry::TriangleId;
using geometry::Vec3;

/// Grid of planes that count as one: of normals, and of offsets in metres. Coarser than the
/// rounding of coordinates, finer than any wall is measured.
constexpr double kNormalCell = 1e-7;
constexpr double kOffsetCell = 1e-5;

bool has_name(const Scene& scene, TriangleId triangle, const std::string& name) {
    if (scene.materials[scene.material_of_triangle[triangle]].name == name) {
        return true;
    }
    const auto& meshes = scene.mesh.mesh_of_triangle();
    return triangle < meshes.size() && scene.mesh.mesh_names()[meshes[triangle]] == name;
}

bool fits(const Scene& scene, const Path& path, const MeasuredArrival& arrival) {
    return !arrival.surfaces || std::equal(path.triangles.begin(),
                                           path.triangles.end(),
                                           arrival.surfaces->begin(),
                                           arrival.surfaces->end(),
                                           [&](TriangleId triangle, const std::string& name) {
                                               return has_name(scene, triangle, name);
                                           });
}

const PairResult& pair_of(const Scene& scene,
                          std::span<const PairResult> pairs,
                          const MeasuredArrival& arrival) {
    return pairs[arrival.source * scene.listeners.size() + arrival.listener];
}

/// An arrival that may take a path of its pair.
struct Candidate {
    bool is_labelled = false;
    double away = 0.0;  // seconds
    std::size_t arrival = 0, pair = 0, path = 0;
};

}  // namespace

WallPlanes::WallPlanes(const Scene& scene, double time)
    : scene_(scene), positions_(scene.mesh.positions_at(time)) {}

std::size_t WallPlanes::wall_of(TriangleId triangle) {
    const auto& [a, b, c] = scene_.mesh.triangles()[triangle];
    const Vec3 cross = glm::cross(positions_[b] - positions_[a], positions_[c] - positions_[a]);
    Vec3 normal = geometry::normalized_or_zero(cross);
    const double largest = geometry::max_abs(normal) * (1.0 - 1e-6);
    for (int axis = 0; axis < 3; ++axis) {
        if (std::abs(normal[axis]) >= largest) {
            normal = (normal[axis] < 0.0 ? -normal : normal) + 0.0;  // no negative zeros
            break;
        }
    }
    const double offset = glm::dot(normal, positions_[a]) + 0.0;
    const auto [entry, is_new] = wall_of_plane_.try_emplace({std::llround(normal.x / kNormalCell),
                                                             std::llround(normal.y / kNormalCell),
                                                             std::llround(normal.z / kNormalCell),
                                                             std::llround(offset / kOffsetCell)},
                                                            walls_.size());
    if (is_new) {
        walls_.push_back({.plane = {normal, offset},
                          .material = scene_.material_of_triangle[triangle],
                          .triangle = triangle});
    }
    ReflectingWall& wall = walls_[entry->second];
    if (triangle < wall.triangle) {
        wall.triangle = triangle;
        wall.material = scene_.material_of_triangle[triangle];
    }
    return entry->second;
}

std::vector<PairResult> paths_at(const Scene& scene,
                                 const ArrivalState& state,
                                 const LocateOptions& options,
                                 int specular_order,
                                 Executor& executor) {
    Scene moved = scene;
    const auto place = [](std::vector<Emitter>& emitters, const std::vector<Vec3>& positions) {
        for (std::size_t i = 0; i < emitters.size(); ++i) {
            emitters[i] = {.name = emitters[i].name, .node = -1, .position = positions[i]};
        }
    };
    place(moved.sources, state.sources);
    place(moved.listeners, state.listeners);
    Simulator simulator(moved, {.specular_order = specular_order, .air = options.air}, executor);
    if (options.time != 0.0) {
        simulator.set_time(options.time, executor);
    }
    return simulator.run(executor);
}

MatchedPaths match_arrivals(const Scene& scene,
                            std::span<const MeasuredArrival> arrivals,
                            std::span<const PairResult> pairs,
                            const ArrivalState& state,
                            double window) {
    std::vector<Candidate> candidates;
    for (std::size_t i = 0; i < arrivals.size(); ++i) {
        const MeasuredArrival& arrival = arrivals[i];
        const std::size_t pair = arrival.source * scene.listeners.size() + arrival.listener;
        for (std::size_t k = 0; k < pairs[pair].paths.size(); ++k) {
            const Path& path = pairs[pair].paths[k];
            const double away = std::abs(path.length / state.speed +
                                         state.latencies[arrival.source] - arrival.time);
            if ((arrival.surfaces || away <= window) && fits(scene, path, arrival)) {
                candidates.push_back({arrival.surfaces.has_value(), away, i, pair, k});
            }
        }
    }
    std::sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
        return std::tuple(!a.is_labelled, a.away, a.arrival, a.path) <
               std::tuple(!b.is_labelled, b.away, b.arrival, b.path);
    });
    MatchedPaths matched(arrivals.size());
    std::vector<std::vector<bool>> is_taken(pairs.size());
    for (const Candidate& candidate : candidates) {
        std::vector<bool>& taken = is_taken[candidate.pair];
        taken.resize(pairs[candidate.pair].paths.size(), false);
        if (!matched[candidate.arrival] && (candidate.is_labelled || !taken[candidate.path])) {
            matched[candidate.arrival] = pairs[candidate.pair].paths[candidate.path].triangles;
            taken[candidate.path] = true;
        }
    }
    return matched;
}

namespace {

/// Of the arrivals of a source that one path alone fits.
std::vector<double> lags_of_single_paths(const Scene& scene,
                                         std::span<const MeasuredArrival> arrivals,
                                         std::span<const PairResult> pairs,
                                         std::size_t source,
                                         double speed) {
    std::vector<double> lags;
    for (const MeasuredArrival& arrival : arrivals) {
        if (arrival.source != source || !arrival.surfaces) {
            continue;
        }
        std::size_t fitting = 0;
        double lag = 0.0;
        for (const Path& path : pair_of(scene, pairs, arrival).paths) {
            if (fits(scene, path, arrival)) {
                ++fitting;
                lag = arrival.time - path.length / speed;
            }
        }
        if (fitting == 1) {
            lags.push_back(lag);
        }
    }
    return lags;
}

/// Of the first arrival of each of a source's pairs, taken for the first path.
std::vector<double> lags_of_first_arrivals(const Scene& scene,
                                           std::span<const MeasuredArrival> arrivals,
                                           std::span<const PairResult> pairs,
                                           std::size_t source,
                                           double speed) {
    constexpr double kNever = std::numeric_limits<double>::infinity();
    std::vector<double> first(scene.listeners.size(), kNever), lags;
    for (const MeasuredArrival& arrival : arrivals) {
        if (arrival.source == source) {
            first[arrival.listener] = std::min(first[arrival.listener], arrival.time);
        }
    }
    for (std::size_t listener = 0; listener < first.size(); ++listener) {
        const auto& paths = pairs[source * scene.listeners.size() + listener].paths;
        if (first[listener] < kNever && !paths.empty()) {
            lags.push_back(first[listener] - paths.front().length / speed);
        }
    }
    return lags;
}

}  // namespace

std::vector<double> first_latencies(const Scene& scene,
                                    std::span<const MeasuredArrival> arrivals,
                                    std::span<const PairResult> pairs,
                                    double speed) {
    std::vector<double> latencies;
    for (std::size_t source = 0; source < scene.sources.size(); ++source) {
        std::vector<double> lags = lags_of_single_paths(scene, arrivals, pairs, source, speed);
        if (lags.empty()) {
            lags = lags_of_first_arrivals(scene, arrivals, pairs, source, speed);
        }
        latencies.push_back(lags.empty() ? 0.0 : median(lags));
    }
    return latencies;
}

double median(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    return (values[(values.size() - 1) / 2] + values[values.size() / 2]) / 2.0;
}

}  // namespace earshot::propagation
