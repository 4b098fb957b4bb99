// SPDX-License-Identifier: MIT
#include "earshot/propagation/engine/internal/emitter_history.h"

#include <glm/geometric.hpp>

#include <cmath>
#include <limits>

namespace earshot::propagation {

bool EmitterHistory::add(double time, const geometry::Vec3& position) {
    if (!keys_.empty() && keys_.back().time >= time) {
        keys_.pop_back();
    }
    bool moved = true;
    if (!keys_.empty()) {
        const double way = glm::distance(keys_.back().position, position);
        moved = way <= max_speed_ * (time - keys_.back().time);
        if (!moved) {
            keys_.clear();
        }
    }
    keys_.push_back({time, position});
    // One key before the span, and three for a parabola, are kept.
    std::size_t old = 0;
    while (keys_.size() - old > 3 && keys_[old + 1].time < time - seconds_) {
        ++old;
    }
    keys_.erase(keys_.begin(), keys_.begin() + static_cast<std::ptrdiff_t>(old));
    trajectory_ = Trajectory(keys_);
    if (!(trajectory_.max_speed() <= max_speed_)) {
        // A turn so sharp that its parabola is faster than sound.
        keys_ = {{time, position}};
        trajectory_ = Trajectory(keys_);
        return false;
    }
    return moved;
}

Motion EmitterHistory::motion() const noexcept {
    // Just before the last time: after it a trajectory rests.
    const double last = keys_.back().time;
    Motion motion = trajectory_.at(std::nextafter(last, -std::numeric_limits<double>::infinity()));
    motion.position = keys_.back().position;
    return motion;
}

}  // namespace earshot::propagation
