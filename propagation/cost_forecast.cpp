// SPDX-License-Identifier: MIT
#include "earshot/propagation/cost_forecast.h"

#include "earshot/propagation/simulator.h"

#include <algorithm>
#include <chrono>

namespace earshot::propagation {
namespace {

constexpr int kMinOrder = 2;
constexpr int kMaxOrder = 6;
/// Growth before two orders have been measured, and the least that is extrapolated with.
constexpr double kUsualGrowth = 6.0;
constexpr double kMinGrowth = 1.5;

double seconds_of_order(const Scene& scene, double time, int order, Executor& executor) {
    const auto start = std::chrono::steady_clock::now();
    Simulator simulator(scene, {.specular_order = order}, executor);
    simulator.set_time(time, executor);
    simulator.run(executor);
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

std::vector<OrderCost> forecast_costs(const Scene& scene,
                                      double time,
                                      double budget,
                                      Executor& executor) {
    std::vector<OrderCost> costs;
    if (scene.sources.empty() || scene.listeners.empty()) {
        return costs;
    }
    // Order 1 is the base: preparing the scene is a large part of it, and no growth.
    const double first = seconds_of_order(scene, time, 1, executor);
    double spent = first;
    double last = first;
    double growth = kUsualGrowth;
    for (int order = kMinOrder; order <= kMaxOrder; ++order) {
        const bool is_measured = spent + growth * last <= budget;
        const double seconds =
            is_measured ? seconds_of_order(scene, time, order, executor) : growth * last;
        if (is_measured) {
            growth = order == kMinOrder ? kUsualGrowth : std::max(kMinGrowth, seconds / last);
            spent += seconds;
        }
        costs.push_back({order, seconds, is_measured});
        last = seconds;
    }
    return costs;
}

}  // namespace earshot::propagation
