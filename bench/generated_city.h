// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/mesh.h"

#include <cstddef>

namespace bench {

/// A city of `count` triangles or a few more: a grid of heights, level in blocks and rough on top.
earshot::geometry::Mesh generated_city(std::size_t count);

}  // namespace bench
