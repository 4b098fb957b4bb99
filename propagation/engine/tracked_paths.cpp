// SPDX-License-Identifier: MIT
#include "earshot/propagation/engine/internal/tracked_paths.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace earshot::propagation {

namespace {

/// (to - from) / seconds, number by number.
UnfoldedPath rate_between(const UnfoldedPath& from, const UnfoldedPath& to, double seconds) {
    const double per_second = 1.0 / seconds;
    const auto map = [&](const AffineMap& a, const AffineMap& b) {
        return AffineMap{.linear = per_second * (b.linear - a.linear),
                         .offset = per_second * (b.offset - a.offset)};
    };
    return {.before = map(from.before, to.before),
            .after = map(from.after, to.after),
            .has_edge = to.has_edge,
            .edge = {per_second * (to.edge[0] - from.edge[0]),
                     per_second * (to.edge[1] - from.edge[1])}};
}

/// Of the filters that make the path's pressure at 1 m; the largest error.
double set_weights(const Path& path, const audio::FilterBasis& basis, TrackedPath& tracked) {
    std::vector<double> weights(basis.filters(), 0.0);
    double error = 0.0;
    const auto add = [&](audio::Spectrum pressure) {
        for (double& value : pressure) {
            value *= path.length;
        }
        error = std::max(error, basis.add_weights(pressure, weights));
    };
    if (path.parts.empty()) {
        add(path.pressure);
    }
    for (const audio::Spectrum& part : path.parts) {
        add(part);
    }
    tracked.weights.assign(weights.begin(), weights.end());
    return error;
}

double level_of(const Path& path) {
    double level = 0.0;
    for (const double pressure : path.pressure) {
        level = std::max(level, std::abs(pressure));
    }
    return level;
}

}  // namespace

double TrackedPaths::follow(double time,
                            std::span<const Path> paths,
                            const FacetTable& facets,
                            const audio::FilterBasis& basis,
                            std::uint64_t& next_id,
                            std::vector<std::uint32_t>& ended) {
    std::map<PathKey, TrackedPath> found;
    double error = 0.0;
    energy_ = 0.0;
    for (const Path& path : paths) {
        PathKey key = path_key(path, facets);
        // Equal keys, as of two parts of one edge, are told apart by their order.
        key.elements.push_back(0);
        while (found.count(key) != 0) {
            ++key.elements.back();
        }
        TrackedPath tracked;
        tracked.unfolded.value = unfold(path, facets);
        const auto before = paths_.find(key);
        if (before != paths_.end()) {
            const TrackedPath& last = before->second;
            tracked.id = last.id;
            tracked.slot = last.slot;
            if (time > time_ && !(last.unfolded.value == tracked.unfolded.value)) {
                tracked.unfolded.rate =
                    rate_between(last.unfolded.value, tracked.unfolded.value, time - time_);
            }
            paths_.erase(before);
        } else {
            tracked.id = next_id;
            ++next_id;
        }
        error = std::max(error, set_weights(path, basis, tracked));
        tracked.level = level_of(path);
        tracked.length = path.length;
        energy_ += tracked.level * tracked.level;
        found.emplace(std::move(key), std::move(tracked));
    }
    end_all(ended);  // those that are left were not found
    paths_ = std::move(found);
    time_ = time;
    return error;
}

void TrackedPaths::end_all(std::vector<std::uint32_t>& ended) {
    for (const auto& [key, path] : paths_) {
        if (path.slot != VoiceSlots::kNone) {
            ended.push_back(path.slot);
        }
    }
    paths_.clear();
}

}  // namespace earshot::propagation
