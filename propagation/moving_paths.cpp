// SPDX-License-Identifier: MIT
#include "earshot/propagation/moving_paths.h"

#include "earshot/base/assert.h"
#include "earshot/base/math.h"
#include "earshot/propagation/internal/path_reception.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace earshot::propagation {

namespace {

PathInstant instant_of(const Path& path, const FacetTable& facets) {
    PathInstant instant{.unfolded = unfold(path, facets)};
    for (std::size_t part = 0; part < instant.pressure_at_1_m.size(); ++part) {
        if (path.parts.empty() && part > 0) {
            continue;
        }
        instant.pressure_at_1_m[part] = path.parts.empty() ? path.pressure : path.parts[part];
        for (double& value : instant.pressure_at_1_m[part]) {
            value *= path.length;
        }
    }
    return instant;
}

/// of_a * a + of_b * b, number by number.
UnfoldedPath combined(const UnfoldedPath& a, double of_a, const UnfoldedPath& b, double of_b) {
    const auto map = [&](const AffineMap& first, const AffineMap& second) {
        return AffineMap{.linear = of_a * first.linear + of_b * second.linear,
                         .offset = of_a * first.offset + of_b * second.offset};
    };
    return {.before = map(a.before, b.before),
            .after = map(a.after, b.after),
            .has_edge = a.has_edge,
            .edge = {of_a * a.edge[0] + of_b * b.edge[0], of_a * a.edge[1] + of_b * b.edge[1]}};
}

}  // namespace

void MovingPaths::add(double time, std::span<const Path> paths, const FacetTable& facets) {
    EARSHOT_ASSERT(times_.empty() || times_.back() < time);
    const std::size_t instant = times_.size();
    times_.push_back(time);
    std::map<PathKey, std::size_t> found;
    for (const Path& path : paths) {
        PathKey key = path_key(path, facets);
        // Equal keys, as of two parts of one edge, are told apart by their order.
        key.elements.push_back(0);
        while (found.count(key) != 0) {
            ++key.elements.back();
        }
        const auto before = current_.find(key);
        const std::size_t index = before != current_.end() ? before->second : paths_.size();
        if (index == paths_.size()) {
            paths_.push_back({.first = instant});
        }
        MovingPath& moving = paths_[index];
        moving.instants.push_back(instant_of(path, facets));
        moving.is_fixed =
            moving.is_fixed && moving.instants.back().unfolded == moving.instants.front().unfolded;
        found.emplace(std::move(key), index);
    }
    current_ = std::move(found);
}

double MovingPaths::begin_of(const MovingPath& path) const noexcept {
    return times_[path.first == 0 ? 0 : path.first - 1];
}

double MovingPaths::end_of(const MovingPath& path) const noexcept {
    return times_[std::min(path.last() + 1, times_.size() - 1)];
}

PathShare MovingPaths::share_at(const MovingPath& path, double time) const noexcept {
    const auto above = std::upper_bound(times_.begin(), times_.end(), time);
    if (above == times_.begin() || above == times_.end()) {
        const std::size_t held = above == times_.end() ? times_.size() - 1 : 0;
        const bool is_there = path.first <= held && held <= path.last();
        return {.lower = is_there ? held - path.first : 0, .of_lower = is_there ? 1.0 : 0.0};
    }
    const auto upper = static_cast<std::size_t>(above - times_.begin());
    const std::size_t lower = upper - 1;
    const double along = (time - times_[lower]) / (times_[upper] - times_[lower]);
    const bool at_lower = path.first <= lower && lower <= path.last();
    const bool at_upper = path.first <= upper && upper <= path.last();
    if (at_lower && at_upper) {
        return {.lower = lower - path.first, .of_lower = 1.0 - along, .of_upper = along};
    }
    const double cosine = math::cos(math::kPi * along);
    if (at_lower) {
        return {.lower = lower - path.first, .of_lower = 0.5 * (1.0 + cosine)};
    }
    return {.lower = 0, .of_lower = at_upper ? 0.5 * (1.0 - cosine) : 0.0};
}

MovingUnfoldedPath MovingPaths::unfolded_at(const MovingPath& path, double time) const noexcept {
    const UnfoldedPath& first = path.instants.front().unfolded;
    const UnfoldedPath& last = path.instants.back().unfolded;
    if (path.is_fixed || time <= times_[path.first]) {
        return {.value = first};
    }
    if (time >= times_[path.last()]) {
        return {.value = last};
    }
    const auto above = std::upper_bound(times_.begin(), times_.end(), time);
    const auto upper = static_cast<std::size_t>(above - times_.begin());
    const auto value_at = [&](std::size_t instant) -> const UnfoldedPath& {
        return path.instants[instant - path.first].unfolded;
    };
    // The slope at an instant is that of the line through its neighbours.
    const auto slope_at = [&](std::size_t instant) {
        const std::size_t before = std::max(instant, path.first + 1) - 1;
        const std::size_t after = std::min(instant + 1, path.last());
        const double per_second = 1.0 / (times_[after] - times_[before]);
        return combined(value_at(before), -per_second, value_at(after), per_second);
    };
    const double seconds = times_[upper] - times_[upper - 1];
    const double u = (time - times_[upper - 1]) / seconds;
    const UnfoldedPath& from = value_at(upper - 1);
    const UnfoldedPath& to = value_at(upper);
    const UnfoldedPath slope_from = slope_at(upper - 1);
    const UnfoldedPath slope_to = slope_at(upper);
    // The basis of Hermite's cubic and its derivative.
    const double rise = u * u * (3.0 - 2.0 * u);
    const double out = u * (1.0 - u) * (1.0 - u) * seconds;
    const double in = u * u * (u - 1.0) * seconds;
    const double rise_rate = 6.0 * u * (1.0 - u) / seconds;
    const double out_rate = (1.0 - u) * (1.0 - 3.0 * u);
    const double in_rate = u * (3.0 * u - 2.0);
    return {.value = combined(combined(from, 1.0 - rise, to, rise),
                              1.0,
                              combined(slope_from, out, slope_to, in),
                              1.0),
            .rate = combined(combined(from, -rise_rate, to, rise_rate),
                             1.0,
                             combined(slope_from, out_rate, slope_to, in_rate),
                             1.0)};
}

PathReception MovingPaths::receive(const MovingPath& path,
                                   const Trajectory& source,
                                   const Motion& listener,
                                   double time,
                                   double speed_of_sound,
                                   double near) const noexcept {
    return receive_path([&](double emission) { return unfolded_at(path, emission); },
                        source,
                        listener,
                        time,
                        speed_of_sound,
                        near);
}

}  // namespace earshot::propagation
