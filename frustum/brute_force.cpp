// SPDX-License-Identifier: MIT
#include "earshot/frustum/brute_force.h"

#include "earshot/frustum/internal/path_order.h"
#include "earshot/frustum/path_verifier.h"

namespace earshot::frustum {
namespace {

/// Tries the sequence so far for every listener, then every longer one.
struct SequenceSearch {
    const SceneView& scene;
    PathVerifier verifier;
    std::span<const geometry::Vec3> listeners;
    std::size_t max_order = 0;
    std::vector<geometry::FacetId> sequence{};
    std::vector<geometry::Vec3> images{};
    TraceResult result{};

    void visit() {
        for (std::size_t i = 0; i < listeners.size(); ++i) {
            ++result.statistics.candidates;
            auto path = verifier.verify(sequence, images, listeners[i]);
            if (path && path->triangles.size() <= max_order) {
                path->listener = i;
                result.paths.push_back(std::move(*path));
            }
        }
        if (sequence.size() == max_order) {
            return;
        }
        const auto& facets = scene.facets.facets;
        for (std::size_t facet = 0; facet < facets.size(); ++facet) {
            if (!sequence.empty() && facet == sequence.back()) {
                continue;
            }
            sequence.push_back(static_cast<geometry::FacetId>(facet));
            images.push_back(facets[facet].plane.mirror(images.back()));
            visit();
            images.pop_back();
            sequence.pop_back();
        }
    }
};

}  // namespace

TraceResult find_specular_paths_brute_force(const SceneView& scene,
                                            const geometry::Vec3& source,
                                            std::span<const geometry::Vec3> listeners,
                                            int max_order) {
    SequenceSearch search{
        scene, PathVerifier(scene), listeners, static_cast<std::size_t>(max_order)};
    search.images.push_back(source);
    search.visit();
    sort_and_deduplicate(search.result.paths, scene.facets, search.verifier.extent());
    search.result.statistics.paths = search.result.paths.size();
    return std::move(search.result);
}

}  // namespace earshot::frustum
