// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/visibility/objects.h"

#include <span>
#include <vector>

namespace earshot::visibility {

/// The cost of rendering a visible object: the larger of a fixed part and a part per triangle, in
/// any unit (GameTools 2007, without its term of projected area, which is undefined for a region).
/// The cost of a set is the sum over its objects. The defaults count triangles.
struct RenderCost {
    double per_object = 1.0;
    double per_triangle = 1.0;
};

/// The cost of each object. Throws Error if a part is negative or not finite.
std::vector<double> object_costs(const Objects& objects, const RenderCost& cost = {});

/// The cost of a set. Precondition: `costs` covers its objects.
double set_cost(std::span<const ObjectId> set, std::span<const double> costs) noexcept;

/// The union of two ascending sets, ascending.
std::vector<ObjectId> union_of(std::span<const ObjectId> a, std::span<const ObjectId> b);

}  // namespace earshot::visibility
