// SPDX-License-Identifier: MIT
#include "earshot/propagation/trajectory.h"

#include "earshot/base/error.h"
#include "earshot/geometry/vector.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace earshot::propagation {

using geometry::Vec3;

namespace {

// Between keys this far apart a cubic misses a circle of radius 5 m, once a second, by 2e-11 m.
constexpr double kKeyInterval = 1e-3;

void check_keys(const std::vector<TrajectoryKey>& keys) {
    if (keys.empty()) {
        throw Error("trajectory", "has no instant", "give at least one time and position");
    }
    for (std::size_t k = 0; k < keys.size(); ++k) {
        if (!std::isfinite(keys[k].time) || !geometry::is_finite(keys[k].position)) {
            throw Error("trajectory", "has a time or position that is not finite");
        }
        if (k > 0 && !(keys[k - 1].time < keys[k].time)) {
            throw Error("trajectory", "times do not ascend", "sort its instants by time");
        }
    }
}

Vec3 mean_velocity(const TrajectoryKey& from, const TrajectoryKey& to) {
    return (to.position - from.position) / (to.time - from.time);
}

/// At every key, of the parabola through three of them.
std::vector<Vec3> velocities_of(const std::vector<TrajectoryKey>& keys) {
    const std::size_t count = keys.size();
    std::vector<Vec3> velocities(count, Vec3(0.0));
    if (count == 2) {
        velocities.assign(2, mean_velocity(keys[0], keys[1]));
    }
    for (std::size_t k = 1; k + 1 < count; ++k) {
        const double before = keys[k].time - keys[k - 1].time;
        const double after = keys[k + 1].time - keys[k].time;
        velocities[k] = (after * mean_velocity(keys[k - 1], keys[k]) +
                         before * mean_velocity(keys[k], keys[k + 1])) /
                        (before + after);
    }
    if (count > 2) {
        // The mean of a parabola's velocities at both ends is its mean velocity.
        velocities.front() = 2.0 * mean_velocity(keys[0], keys[1]) - velocities[1];
        velocities.back() =
            2.0 * mean_velocity(keys[count - 2], keys[count - 1]) - velocities[count - 2];
    }
    return velocities;
}

}  // namespace

Trajectory::Trajectory(const Vec3& position)
    : Trajectory(std::vector{TrajectoryKey{0.0, position}}) {}

Trajectory::Trajectory(std::vector<TrajectoryKey> keys) : keys_(std::move(keys)) {
    check_keys(keys_);
    velocities_ = velocities_of(keys_);
}

Motion Trajectory::at(double time) const noexcept {
    const auto after =
        std::upper_bound(keys_.begin(), keys_.end(), time, [](double t, const TrajectoryKey& key) {
            return t < key.time;
        });
    if (after == keys_.begin()) {
        return {.position = keys_.front().position};
    }
    if (after == keys_.end()) {
        return {.position = keys_.back().position};
    }
    const auto k = static_cast<std::size_t>(after - keys_.begin()) - 1;
    const double seconds = keys_[k + 1].time - keys_[k].time;
    const double u = (time - keys_[k].time) / seconds;
    // Hermite's cubic by Horner's rule.
    const Vec3 rise = keys_[k + 1].position - keys_[k].position;
    const Vec3 linear = seconds * velocities_[k];
    const Vec3 end = seconds * velocities_[k + 1];
    const Vec3 square = 3.0 * rise - 2.0 * linear - end;
    const Vec3 cube = linear + end - 2.0 * rise;
    return {.position = keys_[k].position + u * (linear + u * (square + u * cube)),
            .velocity = (linear + u * (2.0 * square + u * 3.0 * cube)) / seconds};
}

// The velocity of a cubic is a parabola: no more than 1.5 times the mean velocity and half of what
// is lost at its ends, in turn no more than the sum of these.
double Trajectory::max_speed() const noexcept {
    double bound = 0.0;
    for (std::size_t k = 0; k + 1 < keys_.size(); ++k) {
        const Vec3 mean = mean_velocity(keys_[k], keys_[k + 1]);
        const Vec3 bulge = 1.5 * mean - 0.75 * (velocities_[k] + velocities_[k + 1]);
        const double ends = std::max(glm::length(velocities_[k]), glm::length(velocities_[k + 1]));
        bound = std::max(bound, ends + glm::length(bulge));
    }
    return bound;
}

Trajectory trajectory_of(const Scene& scene, const Emitter& emitter, double begin, double end) {
    if (emitter.node < 0 || !(scene.mesh.duration() > 0.0)) {
        return Trajectory(scene.position_at(emitter, begin));
    }
    std::vector<TrajectoryKey> keys;
    const double first = std::floor(begin / kKeyInterval);
    const double last = std::ceil(end / kKeyInterval);
    for (double k = first; k <= last; k += 1.0) {
        // A multiple of the interval: what is looked up does not depend on the span.
        const double time = k * kKeyInterval;
        keys.push_back({time, scene.position_at(emitter, time)});
    }
    return Trajectory(std::move(keys));
}

}  // namespace earshot::propagation
