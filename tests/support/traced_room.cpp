// SPDX-License-Identifier: MIT
#include "support/traced_room.h"

#include "earshot/frustum/find_specular_paths.h"
#include "earshot/frustum/path_finder.h"

#include <array>

namespace earshot::support {

TracedRoom::TracedRoom(const geometry::Mesh& mesh,
                       std::span<const std::uint32_t> labels,
                       std::span<const std::uint8_t> one_sided_labels) {
    const geometry::CleanMesh clean = geometry::clean(mesh.view());
    number_ = clean.kept;
    mesh_.positions = mesh.positions;
    std::vector<std::uint32_t> kept_labels;
    for (const geometry::TriangleId i : number_) {
        mesh_.triangles.push_back(mesh.triangles[i]);
        kept_labels.push_back(labels[i]);
    }
    facets_ = geometry::find_facets(mesh_.view(), clean.weld, kept_labels);
    if (!one_sided_labels.empty()) {
        for (const geometry::Facet& facet : facets_.facets) {
            const std::uint32_t label = kept_labels[facet.triangles.front()];
            one_sided_.push_back(label < one_sided_labels.size() ? one_sided_labels[label] : 0);
        }
    }
    bvh_ = bvh::DeformableBvh(mesh_.view());
}

frustum::SceneView TracedRoom::scene_view() const {
    return {.bvh = {bvh_.tree(), mesh_.view()}, .facets = facets_, .one_sided = one_sided_};
}

frustum::TraceResult TracedRoom::renumbered(frustum::TraceResult result) const {
    for (frustum::SpecularPath& path : result.paths) {
        for (geometry::TriangleId& triangle : path.triangles) {
            triangle = number_[triangle];
        }
    }
    return result;
}

frustum::TraceResult TracedRoom::trace(const geometry::Vec3& source,
                                       std::span<const geometry::Vec3> listeners,
                                       const frustum::TraceOptions& options,
                                       Executor& executor) const {
    return renumbered(
        frustum::find_specular_paths(scene_view(), source, listeners, options, executor));
}

frustum::PlacedPairs TracedRoom::place(const geometry::Vec3& source,
                                       std::span<const geometry::Vec3> listeners) const {
    return frustum::place_pairs(scene_view(), source, listeners);
}

frustum::TraceResult TracedRoom::trace_placed(const frustum::PlacedPairs& pairs,
                                              const frustum::TraceOptions& options) const {
    const frustum::PathFinder finder(scene_view(), {.trace = options});
    return renumbered(finder.find(pairs));
}

std::vector<frustum::SpecularPath> TracedRoom::paths(const geometry::Vec3& source,
                                                     const geometry::Vec3& listener,
                                                     const frustum::TraceOptions& options) const {
    const std::array listeners = {listener};
    return trace(source, listeners, options).paths;
}

std::vector<PathFacts> facts_of(std::span<const frustum::SpecularPath> paths,
                                std::span<const std::uint32_t> labels) {
    std::vector<PathFacts> facts;
    for (const frustum::SpecularPath& path : paths) {
        PathFacts one{.order = path.triangles.size(),
                      .length = path.length,
                      .labels = {},
                      .image = apparent_source(path.points, path.length)};
        for (const geometry::TriangleId triangle : path.triangles) {
            one.labels.push_back(labels[triangle]);
        }
        facts.push_back(std::move(one));
    }
    return facts;
}

}  // namespace earshot::support
