// SPDX-License-Identifier: MIT
#include "earshot/propagation/internal/diffracted_paths.h"

#include "earshot/frustum/edge_paths.h"
#include "earshot/geometry/vector.h"
#include "earshot/geometry/wedges.h"

#include <algorithm>
#include <iterator>
#include <tuple>
#include <utility>

namespace earshot::propagation {

using audio::Spectrum;
using geometry::FacetId;
using geometry::TriangleId;
using geometry::Vec3;

DiffractedPaths::DiffractedPaths(const Scene& scene,
                                 const SceneGeometry& geometry,
                                 const DiffractionSettings& settings,
                                 Executor& executor)
    : scene_(scene),
      geometry_(geometry),
      settings_(settings),
      view_(geometry.scene_view(executor)),
      wedges_(geometry::find_wedges(
          view_.facets, {.one_sided = view_.one_sided, .transmissive = view_.transmissive})),
      facet_of_triangle_(scene.mesh.triangles().size(), 0) {
    for (std::size_t i = 0; i < geometry.kept().size(); ++i) {
        facet_of_triangle_[geometry.kept()[i]] = view_.facets.of_triangle[i];
    }
    for (const geometry::Facet& facet : view_.facets.facets) {
        const TriangleId in_file = geometry.kept()[facet.triangles.front()];
        reflection_of_facet_.push_back(settings.reflection[scene.material_of_triangle[in_file]]);
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
                          Executor& executor) const {
    for (const frustum::PlacedListeners& group : placed.groups) {
        frustum::EdgePathResult found = frustum::find_edge_paths(
            view_,
            wedges_,
            group.source,
            group.positions,
            {.max_reflections = settings_.max_order, .max_length = settings_.max_length},
            executor);
        executor.for_each(group.numbers.size(), 1, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                const auto [first, last] = std::equal_range(
                    found.paths.begin(),
                    found.paths.end(),
                    frustum::EdgePath{.listener = i},
                    [](const auto& a, const auto& b) { return a.listener < b.listener; });
                PairResult& pair = pairs[group.numbers[i]];
                const std::size_t specular = pair.paths.size();
                add_to_pair(source, group.source, group.positions[i], {first, last}, pair);
                // Points on surfaces were moved off them for the search.
                for (std::size_t k = specular; k < pair.paths.size(); ++k) {
                    pair.paths[k].points.front() = source.pose.position;
                    pair.paths[k].points.back() = listeners[group.numbers[i]];
                }
                std::sort(pair.paths.begin(), pair.paths.end(), [](const Path& a, const Path& b) {
                    return std::tie(a.delay, a.order, a.triangles) <
                           std::tie(b.delay, b.order, b.triangles);
                });
            }
        });
    }
}

// No edge diffracts more than twice the free field at the distance of the shortest way, with
// factors of at most 1 beside it.
bool DiffractedPaths::may_be_wanted(const frustum::EdgePath& way, double loudest) const {
    double factor = 2.0 * loudest;
    for (const FacetSequence* sequence : {&way.before, &way.after}) {
        for (const FacetId facet : *sequence) {
            const Spectrum& of_facet = reflection_of_facet_[facet];
            factor *= *std::max_element(of_facet.begin(), of_facet.end());
        }
    }
    constexpr double kRoundedUp = 1.0 + 0x1p-10;
    return !(kRoundedUp * factor < settings_.min_pressure * way.length);
}

void DiffractedPaths::add_to_pair(const RaySource& source,
                                  const Vec3& from,
                                  const Vec3& to,
                                  std::span<frustum::EdgePath> ways,
                                  PairResult& pair) const {
    const DiffractionModel model{.bands = settings_.bands,
                                 .speed_of_sound = settings_.speed_of_sound,
                                 .air = settings_.air,
                                 .air_absorption = settings_.air_absorption,
                                 .reflection = reflection_of_facet_,
                                 .max_order = settings_.max_order};
    const SpecularPaths specular = specular_paths(pair);
    std::vector<DiffractedSound> sounds;
    std::vector<Path> paths;
    for (frustum::EdgePath& way : ways) {
        if (!may_be_wanted(way, source.directivity.loudest())) {
            continue;
        }
        DiffractedSound sound = diffracted_sound(std::move(way), view_, wedges_, specular, model);
        const std::vector<Vec3> points = frustum::points_of(sound.way, view_, wedges_, from, to);
        if (!source.directivity.is_omnidirectional()) {
            const Vec3 departure = geometry::direction_between(points[0], points[1]);
            radiate(source.directivity.pressure(settings_.bands, source.pose.seen_from(departure)),
                    sound);
        }
        Path path = describe(sound, view_, wedges_, from, to, model);
        if (!settings_.is_wanted(path)) {
            continue;
        }
        for (TriangleId& triangle : path.triangles) {
            triangle = geometry_.kept()[triangle];
            path.materials.push_back(scene_.material_of_triangle[triangle]);
        }
        sounds.push_back(std::move(sound));
        paths.push_back(std::move(path));
    }
    if (sounds.empty()) {
        return;
    }
    pair.energy_arrivals = energy_arrivals(pair.paths, specular, sounds, model);
    pair.paths.insert(pair.paths.end(),
                      std::make_move_iterator(paths.begin()),
                      std::make_move_iterator(paths.end()));
}

}  // namespace earshot::propagation
