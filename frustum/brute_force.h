// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/frustum/paths.h"
#include "earshot/frustum/scene_view.h"

#include <span>

namespace earshot::frustum {

/// The answer of find_specular_paths by trying every facet sequence up to `max_order` (the
/// image-source method without pruning: facets^order candidates per listener). The oracle for
/// frusta and the baseline of benchmarks; same verification, same bits.
TraceResult find_specular_paths_brute_force(const SceneView& scene,
                                            const geometry::Vec3& source,
                                            std::span<const geometry::Vec3> listeners,
                                            int max_order);

}  // namespace earshot::frustum
