// SPDX-License-Identifier: MIT
#include "earshot/visibility/render_cost.h"

#include "earshot/base/error.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace earshot::visibility {

std::vector<double> object_costs(const Objects& objects, const RenderCost& cost) {
    for (const double part : {cost.per_object, cost.per_triangle}) {
        if (!std::isfinite(part) || part < 0.0) {
            throw Error("render cost", "a part is negative or not finite", "give numbers from 0");
        }
    }
    std::vector<double> costs(objects.size());
    for (ObjectId object = 0; object < objects.size(); ++object) {
        const auto triangles = static_cast<double>(objects.triangles_of(object).size());
        costs[object] = std::max(cost.per_object, cost.per_triangle * triangles);
    }
    return costs;
}

double set_cost(std::span<const ObjectId> set, std::span<const double> costs) noexcept {
    double sum = 0.0;
    for (const ObjectId object : set) {
        sum += costs[object];
    }
    return sum;
}

std::vector<ObjectId> union_of(std::span<const ObjectId> a, std::span<const ObjectId> b) {
    std::vector<ObjectId> both;
    both.reserve(a.size() + b.size());
    std::set_union(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(both));
    return both;
}

}  // namespace earshot::visibility
