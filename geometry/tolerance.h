// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/mesh.h"

namespace earshot::geometry {

/// How far, in metres, a vertex may lie from where it was meant to be, because files store floats:
/// four units in the last place of single precision at the largest coordinate of a triangle's
/// vertex. What lies in one plane, or on one line, before a file is written lies within this
/// distance of it afterwards. The smallest normal double for a mesh that is all at the origin.
double coplanar_tolerance(const MeshView& mesh) noexcept;

}  // namespace earshot::geometry
