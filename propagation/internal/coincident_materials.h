// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/error.h"
#include "earshot/frustum/scene_view.h"
#include "earshot/geometry/clean.h"
#include "earshot/propagation/scene.h"

#include <span>

namespace earshot::propagation {

/// A warning for every two materials that claim one place, with the place: the first in the file
/// counts there. `kept`: the scene's triangle for each of the view's; `duplicates`: triangles that
/// are in none of the view's, because they repeat one of them.
Warnings coincident_materials(const Scene& scene,
                              const frustum::SceneView& view,
                              std::span<const geometry::TriangleId> kept,
                              std::span<const geometry::DuplicateTriangle> duplicates);

}  // namespace earshot::propagation
