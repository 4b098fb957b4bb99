// SPDX-License-Identifier: MIT
#include "earshot/propagation/internal/diffracted_paths.h"

#include "earshot/frustum/edge_paths.h"
#include "earshot/geometry/vector.h"
#include "earshot/propagation/internal/doubly_diffracted_sound.h"
#include "earshot/propagation/internal/edge_level.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <tuple>
#include <utility>

namespace earshot::propagation {

using audio::Spectrum;
using geometry::FacetId;
using geometry::TriangleId;
using geometry::Vec3;

namespace {

double loudest_source(const Scene& scene) {
    double loudest = 1.0;
    for (const Emitter& source : scene.sources) {
        loudest = std::max(loudest, source.directivity.loudest());
    }
    return loudest;
}

bool is_as_loud(const Path& path, const audio::Bands& bands, double min_pressure) {
    return std::any_of(path.pressure.begin(),
                       path.pressure.begin() + static_cast<std::ptrdiff_t>(bands.count()),
                       [&](double p) { return std::abs(p) >= min_pressure; });
}

}  // namespace

DiffractedPaths::DiffractedPaths(const Scene& scene,
                                 const SceneGeometry& geometry,
                                 const DiffractionSettings& settings,
                                 Executor& executor)
    : scene_(scene),
      geometry_(geometry),
      settings_(settings),
      view_(geometry.scene_view(executor)),
      wedges_(geometry.wedges(executor)),
      facet_of_triangle_(scene.mesh.triangles().size(), 0),
      finder_(view_,
              wedges_,
              {.max_reflections = settings.max_order,
               .max_length = settings.max_length,
               .min_pressure = 0.5 * settings.min_pressure / loudest_source(scene),
               .keep_traces = settings.keep_traces},
              executor) {
    for (std::size_t i = 0; i < geometry.kept().size(); ++i) {
        facet_of_triangle_[geometry.kept()[i]] = view_.facets.of_triangle[i];
    }
    for (const geometry::Facet& facet : view_.facets.facets) {
        const TriangleId in_file = geometry.kept()[facet.triangles.front()];
        const Spectrum& reflection = settings.reflection[scene.material_of_triangle[in_file]];
        reflection_of_facet_.push_back(reflection);
        max_reflection_of_facet_.push_back(*std::max_element(reflection.begin(), reflection.end()));
    }
}

SpecularPaths DiffractedPaths::specular_paths(const PairResult& pair) const {
    SpecularPaths specular;
    for (std::size_t i = 0; i < pair.paths.size(); ++i) {
        if (pair.paths[i].transmitted.empty()) {
            FacetSequence sequence;
            for (const TriangleId triangle : pair.paths[i].triangles) {
                sequence.push_back(facet_of_triangle_[triangle]);
            }
            specular.emplace(std::move(sequence), i);
        }
    }
    return specular;
}

void DiffractedPaths::add(const RaySource& source,
                          const frustum::PlacedPairs& placed,
                          std::span<const Vec3> listeners,
                          std::span<PairResult> pairs,
                          Executor& executor) {
    for (const frustum::PlacedListeners& group : placed.groups) {
        EdgeLevelFilter filter(
            max_reflection_of_facet_, settings_.max_order, source.directivity.loudest());
        for (const std::size_t number : group.numbers) {
            filter.add_listener(min_pressure(source.pose.position, listeners[number]));
        }
        frustum::EdgePathResult found =
            finder_.find(group.source, group.positions, &filter, executor);
        std::vector<std::vector<SoundOverTwo>> over_two =
            sounds_over_two_edges(source, group, listeners, executor);
        executor.for_each(group.numbers.size(), 1, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                const auto [first, last] = std::equal_range(
                    found.paths.begin(),
                    found.paths.end(),
                    frustum::EdgePath{.listener = i},
                    [](const auto& a, const auto& b) { return a.listener < b.listener; });
                PairResult& pair = pairs[group.numbers[i]];
                const std::size_t specular = pair.paths.size();
                add_to_pair(source,
                            group.source,
                            group.positions[i],
                            min_pressure(source.pose.position, listeners[group.numbers[i]]),
                            {first, last},
                            over_two[i],
                            pair);
                // Points on surfaces were moved off them for the search.
                for (std::size_t k = specular; k < pair.paths.size(); ++k) {
                    pair.paths[k].points.front() = source.pose.position;
                    pair.paths[k].points.back() = listeners[group.numbers[i]];
                }
                // Ways along both sides of a plate are equal but for their pressures.
                std::stable_sort(
                    pair.paths.begin(), pair.paths.end(), [](const Path& a, const Path& b) {
                        return std::tie(a.delay, a.order, a.triangles) <
                               std::tie(b.delay, b.order, b.triangles);
                    });
            }
        });
    }
}

double DiffractedPaths::min_pressure(const Vec3& source, const Vec3& listener) const {
    const double distance = std::max(1.0, glm::distance(source, listener));
    return std::max(settings_.min_pressure, settings_.min_pressure_ratio / distance);
}

void DiffractedPaths::add_to_pair(const RaySource& source,
                                  const Vec3& from,
                                  const Vec3& to,
                                  double min_pressure,
                                  std::span<frustum::EdgePath> ways,
                                  std::span<SoundOverTwo> over_two,
                                  PairResult& pair) const {
    const DiffractionModel model = this->model();
    const SpecularPaths specular = specular_paths(pair);
    const double certain_pressure = min_pressure / source.directivity.loudest();
    PairSounds found;
    for (frustum::EdgePath& way : ways) {
        std::optional<DiffractedSound> possible =
            diffracted_sound(std::move(way), view_, wedges_, specular, model, certain_pressure);
        if (!possible) {
            continue;
        }
        DiffractedSound& sound = *possible;
        const std::vector<Vec3> points = frustum::points_of(sound.way, view_, wedges_, from, to);
        if (!source.directivity.is_omnidirectional()) {
            const Vec3 departure = geometry::direction_between(points[0], points[1]);
            radiate(source.directivity.pressure(settings_.bands, source.pose.seen_from(departure)),
                    sound);
        }
        Path path = describe(sound, view_, wedges_, from, to, model);
        if (!is_as_loud(path, settings_.bands, min_pressure)) {
            continue;
        }
        name_materials(path);
        found.sounds.push_back(std::move(sound));
        found.paths.push_back(std::move(path));
    }
    std::vector<DoublyDiffractedSound> sounds_over_two;
    for (SoundOverTwo& of_way : over_two) {
        sounds_over_two.push_back(std::move(of_way.sound));
        found.paths.push_back(std::move(of_way.path));
    }
    found.arrivals = join_mended_sounds(
        sounds_over_two, view_, wedges_, from, to, specular, model, found.sounds);
    if (found.paths.empty()) {
        return;
    }
    pair.energy_arrivals = energy_arrivals(pair.paths, specular, found.sounds, model);
    pair.energy_arrivals.insert(
        pair.energy_arrivals.end(), found.arrivals.begin(), found.arrivals.end());
    pair.paths.insert(pair.paths.end(),
                      std::make_move_iterator(found.paths.begin()),
                      std::make_move_iterator(found.paths.end()));
}

// Of the numbers of the scene view those of the scene.
void DiffractedPaths::name_materials(Path& path) const {
    for (TriangleId& triangle : path.triangles) {
        triangle = geometry_.kept()[triangle];
        path.materials.push_back(scene_.material_of_triangle[triangle]);
    }
}

DiffractionModel DiffractedPaths::model() const {
    return {.bands = settings_.bands,
            .speed_of_sound = settings_.speed_of_sound,
            .air = settings_.air,
            .air_absorption = settings_.air_absorption,
            .reflection = reflection_of_facet_,
            .max_order = settings_.max_order};
}

std::optional<DiffractedPaths::SoundOverTwo> DiffractedPaths::sound_over_two_edges(
    const RaySource& source,
    const Vec3& from,
    const Vec3& to,
    double min_pressure,
    const frustum::EdgePairPath& way) const {
    const DiffractionModel model = this->model();
    std::optional<DoublyDiffractedSound> sound =
        doubly_diffracted_sound(way,
                                wedges_,
                                from,
                                to,
                                model,
                                settings_.max_length,
                                min_pressure / source.directivity.loudest());
    if (!sound) {
        return std::nullopt;
    }
    if (!source.directivity.is_omnidirectional()) {
        const Vec3 departure = geometry::direction_between(from, sound->apexes[0]);
        radiate(source.directivity.pressure(settings_.bands, source.pose.seen_from(departure)),
                *sound);
    }
    Path path = describe(*sound, view_, wedges_, from, to, model);
    if (!is_as_loud(path, settings_.bands, min_pressure)) {
        return std::nullopt;
    }
    name_materials(path);
    return SoundOverTwo{std::move(*sound), std::move(path)};
}

std::vector<std::vector<DiffractedPaths::SoundOverTwo>> DiffractedPaths::sounds_over_two_edges(
    const RaySource& source,
    const frustum::PlacedListeners& group,
    std::span<const Vec3> listeners,
    Executor& executor) const {
    std::vector<std::vector<SoundOverTwo>> of_listener(group.numbers.size());
    if (settings_.max_edges < 2) {
        return of_listener;
    }
    EdgePairLevelFilter filter(group.source, group.positions, settings_.max_length, model());
    std::vector<double> min_pressures;
    for (const std::size_t number : group.numbers) {
        min_pressures.push_back(min_pressure(source.pose.position, listeners[number]));
        filter.add_listener(min_pressures.back() / source.directivity.loudest());
    }
    const frustum::EdgePairResult ways = frustum::find_edge_pair_paths(
        view_, wedges_, group.source, group.positions, &filter, executor);
    std::vector<std::optional<SoundOverTwo>> sounds(ways.paths.size());
    executor.for_each(sounds.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const frustum::EdgePairPath& way = ways.paths[i];
            sounds[i] = sound_over_two_edges(source,
                                             group.source,
                                             group.positions[way.listener],
                                             min_pressures[way.listener],
                                             way);
        }
    });
    for (std::size_t i = 0; i < sounds.size(); ++i) {
        if (sounds[i]) {
            of_listener[ways.paths[i].listener].push_back(std::move(*sounds[i]));
        }
    }
    return of_listener;
}

}  // namespace earshot::propagation
