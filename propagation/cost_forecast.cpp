// SPDX-License-Identifier: MIT
#include "earshot/propagation/cost_forecast.h"

#include "earshot/frustum/path_finder.h"
#include "earshot/propagation/simulator.h"

#include <algorithm>
#include <chrono>

namespace earshot::propagation {
namespace {

using geometry::Vec3;

constexpr int kMinOrder = 2;
constexpr int kMaxOrder = 6;
/// Growth from order to order before it is known.
constexpr double kUsualGrowth = 6.0;
/// A time of less is the shorter of two.
constexpr double kMinSeconds = 0.05;

/// Orders whose expected time is a larger part of the budget are estimated.
constexpr double kMaxMeasuredPart = 0.25;
/// Of the time for an order, the part at which samples aim, and the least that they shall take.
constexpr double kAim = 0.4;
constexpr double kMinPart = 0.15;
constexpr int kMaxSamples = 3;
constexpr double kMinShare = 1e-7;

template <typename Work>
double seconds_of(Work&& work) {
    const auto once = [&] {
        const auto start = std::chrono::steady_clock::now();
        work();
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    };
    const double seconds = once();
    return seconds < kMinSeconds ? std::min(seconds, once()) : seconds;
}

class Forecast {
public:
    Forecast(const Scene& scene, double time, double budget, Executor& executor, Progress* progress)
        : scene_(scene),
          time_(time),
          budget_(budget),
          executor_(executor),
          progress_(progress),
          start_(std::chrono::steady_clock::now()) {
        for (const Emitter& source : scene.sources) {
            sources_.push_back(scene.position_at(source, time));
        }
        for (const Emitter& listener : scene.listeners) {
            listeners_.push_back(scene.position_at(listener, time));
        }
    }

    std::vector<OrderCost> run() {
        std::vector<OrderCost> costs;
        double last = seconds_of_order(1);
        double growth = kUsualGrowth;
        int order = kMinOrder;
        for (; order <= kMaxOrder && growth * last <= kMaxMeasuredPart * budget_; ++order) {
            tell(order);
            const double seconds = seconds_of_order(order);
            growth = order == kMinOrder ? kUsualGrowth : std::max(1.0, seconds / last);
            costs.push_back({order, seconds, true});
            last = seconds;
        }
        const int measured = order - 1;
        if (order <= kMaxOrder) {
            estimate(measured, last, growth, costs);
        }
        tell(kMaxOrder + 1);
        return costs;
    }

private:
    double seconds_spent() const {
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    }

    void tell(int order) const {
        if (progress_ != nullptr) {
            progress_->report("forecast",
                              static_cast<std::size_t>(order - kMinOrder),
                              static_cast<std::size_t>(kMaxOrder + 1 - kMinOrder));
        }
    }

    double seconds_of_order(int order) const {
        return seconds_of([&] {
            Simulator simulator(scene_, {.specular_order = order}, executor_);
            simulator.set_time(time_, executor_);
            simulator.run(executor_);
        });
    }

    /// Orders beyond those that were measured. Their beam trees are complete where that of the last
    /// one is; of the frusta that come next a share is followed to the end.
    void estimate(int measured, double base, double growth, std::vector<OrderCost>& costs) const {
        Simulator simulator(scene_, {}, executor_);
        simulator.set_time(time_, executor_);
        const frustum::SceneView view = simulator.scene_view(executor_);
        // Bidirectional tracing of order n follows frusta of up to order n - 3 or n - 2.
        const int first = std::max(1, measured - 2);
        double last = base;
        for (int order = measured + 1; order <= kMaxOrder; ++order) {
            tell(order);
            const double left = std::max(0.1 * budget_, budget_ - seconds_spent());
            const double allotted = left / (kMaxOrder + 1 - order);
            const double above = seconds_of_share(view, order, {.order = first, .share = 0.0});
            double share = std::clamp(kAim * allotted / (growth * last), kMinShare, 1.0);
            double below = 0.0;
            for (int sample = 0; sample < kMaxSamples; ++sample) {
                below = std::max(
                    0.0, seconds_of_share(view, order, {.order = first, .share = share}) - above);
                if (below >= kMinPart * allotted || share == 1.0) {
                    break;
                }
                if (sample + 1 < kMaxSamples) {
                    share =
                        std::min(1.0, share * kAim * allotted / std::max(below, 0.02 * allotted));
                }
            }
            const double seconds = std::max(last, std::max(base, above) + below / share);
            growth = std::max(1.5, seconds / last);
            costs.push_back({order, seconds, false});
            last = seconds;
        }
    }

    double seconds_of_share(const frustum::SceneView& view,
                            int order,
                            const frustum::BeamSample& sample) const {
        const frustum::PathFinder finder(
            view,
            {.trace = {.max_order = order},
             .sample = sample,
             .forward_only = frustum::prefer_forward(listeners_.size(), order),
             .listener_count = listeners_.size()},
            executor_);
        return seconds_of([&] {
            const frustum::ListenerBeamTree beams = finder.trace_listeners(listeners_, executor_);
            for (const Vec3& source : sources_) {
                finder.find(source, beams, {}, executor_);
            }
        });
    }

    const Scene& scene_;
    double time_, budget_;
    Executor& executor_;
    Progress* progress_;
    std::chrono::steady_clock::time_point start_;
    std::vector<Vec3> sources_, listeners_;
};

}  // namespace

std::vector<OrderCost> forecast_costs(
    const Scene& scene, double time, double budget, Executor& executor, Progress* progress) {
    if (scene.sources.empty() || scene.listeners.empty()) {
        return {};
    }
    return Forecast(scene, time, budget, executor, progress).run();
}

}  // namespace earshot::propagation
