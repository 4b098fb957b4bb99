// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/mesh.h"
#include "earshot/scenes/scene_draft.h"

#include <gtest/gtest.h>

#include <string>

namespace earshot::scenes {

/// The geometry of a node as it stands in a file, in the node's space.
geometry::Mesh mesh_of(const DraftNode& node, int tessellation = 1);

/// The geometry of faces alone.
geometry::Mesh mesh_of(const Faces& faces, int tessellation = 1);

/// Every edge is used once in each direction.
testing::AssertionResult is_closed(const geometry::Mesh& mesh);

/// The volume inside, by the divergence theorem: positive if the faces look outwards.
double signed_volume(const geometry::Mesh& mesh);

/// How often the surface winds around a point, by its solid angle (van Oosterom & Strackee 1983):
/// 1 inside a solid, -1 inside a room, 0 outside of both; a fraction if it is not closed.
double winding_number(const geometry::Mesh& mesh, const Vec3& point);

/// The node of that name. Precondition: there is one.
const DraftNode& node_named(const SceneDraft& draft, const std::string& name);

}  // namespace earshot::scenes
