// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/propagation/scene.h"

#include <string>

namespace earshot::io {

/// A scene that does not move as the bytes of a .glb file: a node per mesh, under its name or
/// "model", with a primitive per material, the materials' acoustic data in full, and a node per
/// source and listener. Coordinates are rounded to single precision, as glTF has them;
/// directivities other than omnidirectional are left out. Precondition: there is a triangle, and
/// scene.mesh.duration() is 0.
std::string encode_glb(const propagation::Scene& scene);

}  // namespace earshot::io
