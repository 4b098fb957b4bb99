// SPDX-License-Identifier: MIT
#include "earshot/geometry/tolerance.h"

#include "earshot/geometry/vector.h"

#include <algorithm>
#include <limits>

namespace earshot::geometry {
namespace {

// Storing a coordinate x as a float moves it by at most |x| 2^-24, a point by sqrt(3) times that.
// Programs that make models compute in floats as well: two or three rounded transformations before
// the file make it about four times as much, |x| 2^-22. A point and the plane or line through other
// points may be off in opposite directions: twice that.
constexpr double kRelativeTolerance = 0x1p-21;

}  // namespace

double coplanar_tolerance(const MeshView& mesh) noexcept {
    double largest = 0.0;
    for (const Triangle& triangle : mesh.triangles) {
        for (const VertexId vertex : triangle) {
            largest = std::max(largest, max_abs(mesh.positions[vertex]));
        }
    }
    return std::max(largest * kRelativeTolerance, std::numeric_limits<double>::min());
}

}  // namespace earshot::geometry
