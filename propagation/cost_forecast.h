// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/propagation/model_check.h"

#include <vector>

namespace earshot::propagation {

/// The times of orders 2 to 6: the orders whose expected time is within `budget` seconds are
/// traced, the others extrapolated by the growth from order to order. Seconds of this machine, not
/// a property of the scene. Empty without a source and a listener.
std::vector<OrderCost> forecast_costs(const Scene& scene,
                                      double time,
                                      double budget,
                                      Executor& executor);

}  // namespace earshot::propagation
