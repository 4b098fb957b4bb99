// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/base/progress.h"
#include "earshot/propagation/model_check.h"

#include <vector>

namespace earshot::propagation {

/// The times of orders 2 to 6, in about `budget` seconds: orders of which a small part of the
/// budget is expected are traced. Of the others the beam trees are sampled: they are complete as
/// far as those of the last order that was traced, and of the frusta that come next a random share
/// is followed to the end, whose time is taken for that of all in proportion. Seconds of this
/// machine, not a property of the scene. Empty without a source and a listener. Reports "forecast".
std::vector<OrderCost> forecast_costs(const Scene& scene,
                                      double time,
                                      double budget,
                                      Executor& executor,
                                      Progress* progress = nullptr);

}  // namespace earshot::propagation
