// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/bands.h"
#include "earshot/base/floating_point.h"
#include "earshot/propagation/pair_result.h"
#include "earshot/propagation/trajectory.h"
#include "earshot/propagation/unfolded_path.h"

#include <array>
#include <cstddef>
#include <map>
#include <span>
#include <vector>

namespace earshot::propagation {

/// A path at one of the instants at which paths were found.
struct PathInstant {
    UnfoldedPath unfolded{};
    /// Pressure times length, of the parts of a diffracted path or of the path and nothing.
    std::array<audio::Spectrum, 2> pressure_at_1_m{};
};

/// One path from instant to instant, as long as it exists.
struct MovingPath {
    std::size_t first = 0;  ///< the instant at which it was found first
    std::vector<PathInstant> instants{};
    bool is_fixed = true;  ///< all that it meets stays: PathInstant::unfolded is always the same

    std::size_t last() const noexcept { return first + instants.size() - 1; }
};

/// How much of a path's instants `lower` and `lower + 1` is heard between them.
struct PathShare {
    std::size_t lower = 0;  ///< index into MovingPath::instants
    double of_lower = 0.0, of_upper = 0.0;
};

/// What a listener receives of a path at an instant.
struct PathReception {
    double emission = 0.0;        ///< seconds, the time at which the sound was emitted
    double delay = 0.0;           ///< seconds since then
    double delay_rate = 0.0;      ///< its change, seconds per second of reception
    geometry::Vec3 arrival{0.0};  ///< unit direction of travel at the listener
};

/// The paths of a pair over time, matched by what they meet (path_key()).
class MovingPaths {
public:
    /// Adds those of the next instant. Precondition: times ascend.
    void add(double time, std::span<const Path> paths, const FacetTable& facets);

    std::span<const double> times() const noexcept { return times_; }
    /// In the order in which they were found first.
    std::span<const MovingPath> paths() const noexcept { return paths_; }

    /// From the first sound of a path until its last, in times of emission: it fades in from the
    /// instant before it was found, and out until the one after.
    double begin_of(const MovingPath& path) const noexcept;
    double end_of(const MovingPath& path) const noexcept;

    /// What is heard of a path's sound emitted at `time`: between two of its instants a share of
    /// each, linear; before the first and after the last a raised cosine. Those at the first or the
    /// last of all instants hold beyond them.
    PathShare share_at(const MovingPath& path, double time) const noexcept;

    /// The unfolded path for sound emitted at `time`: a cubic between instants where facets move.
    MovingUnfoldedPath unfolded_at(const MovingPath& path, double time) const noexcept;

    /// Of the sound that arrives at `time`: emission + length / c = time, the length being that
    /// from the source at the emission to the listener at `time`. `near`: an emission to begin
    /// the search at. Precondition: source and listener are slower than sound.
    PathReception receive(const MovingPath& path,
                          const Trajectory& source,
                          const Motion& listener,
                          double time,
                          double speed_of_sound,
                          double near) const noexcept;

private:
    std::vector<double> times_;
    std::vector<MovingPath> paths_;
    std::map<PathKey, std::size_t> current_;  // of the last instant: index into paths_
};

}  // namespace earshot::propagation
