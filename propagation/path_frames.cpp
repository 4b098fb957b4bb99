// SPDX-License-Identifier: MIT
#include "earshot/propagation/path_frames.h"

#include "earshot/base/error.h"
#include "earshot/propagation/internal/moving_early_sound.h"
#include "earshot/propagation/internal/path_facets.h"
#include "earshot/propagation/internal/response_parts.h"
#include "earshot/propagation/moving_paths.h"
#include "earshot/propagation/pose.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>

namespace earshot::propagation {

using geometry::Vec3;

namespace {

constexpr double kMaxMach = 0.9;
constexpr double kMaxDelay = 100.0;  // seconds
// Far below what scenes are rendered at; rates of change over denormal times are no numbers.
constexpr double kMinStep = 1e-6;  // seconds
// Of points that are to be one and of lengths that are to be equal: beyond the rounding of points,
// and of a wall that counts as fixed although it moves by less (PathFacets).
constexpr double kMaxDeviation = 1e-5;  // metres, and more for each metre of a length
constexpr double kMaxDeviationPerMetre = 1e-6;

[[noreturn]] void refuse(const PathFrames& frames, const std::string& what) {
    throw Error(frames.name, what, "give paths as earshot ir --frames has written them");
}

double length_along(const std::vector<Vec3>& points) {
    double length = 0.0;
    for (std::size_t i = 1; i < points.size(); ++i) {
        length += glm::distance(points[i - 1], points[i]);
    }
    return length;
}

/// The ways of source and listener.
struct Ways {
    Trajectory source, listener;
};

Ways ways_of(const PathFrames& frames) {
    std::vector<TrajectoryKey> source, listener;
    for (const PathFrame& frame : frames.instants) {
        for (const Path& path : frame.paths) {
            const Vec3& begin = path.points.front();
            const Vec3& end = path.points.back();
            if (&path == &frame.paths.front()) {
                source.push_back({frame.time, begin});
                listener.push_back({frame.time, end});
            } else if (!(glm::distance(begin, source.back().position) <= kMaxDeviation &&
                         glm::distance(end, listener.back().position) <= kMaxDeviation)) {
                refuse(frames, "has a source or listener at two places at a time");
            }
        }
    }
    if (source.empty()) {
        throw Error(frames.name, "has no path of this source and listener", "choose others");
    }
    Ways ways{.source = Trajectory(std::move(source)), .listener = Trajectory(std::move(listener))};
    if (!(std::max(ways.source.max_speed(), ways.listener.max_speed()) <=
          kMaxMach * frames.speed_of_sound)) {
        throw Error(frames.name,
                    "has a source or listener that moves at more than 0.9 of the speed of sound",
                    "compute frames with a shorter step");
    }
    return ways;
}

void require_one_edge(const PathFrames& frames) {
    for (const PathFrame& frame : frames.instants) {
        for (const Path& path : frame.paths) {
            if (path.edges.size() > 1) {
                throw Error(frames.name,
                            "has a path that does not bend round one edge",
                            "compute the paths with a diffraction of 1");
            }
        }
    }
}

MovingPaths moving_paths_of(const PathFrames& frames) {
    const PathFacets facets(frames);
    MovingPaths paths;
    for (std::size_t instant = 0; instant < frames.instants.size(); ++instant) {
        PathFrame frame = frames.instants[instant];
        const FacetTable table = facets.at(instant);
        for (Path& path : frame.paths) {
            path.length = length_along(path.points);
            if (!(path.length <= kMaxDelay * frames.speed_of_sound)) {
                refuse(frames, "has a path that takes more than 100 s");
            }
            const double unfolded = length_of({.value = unfold(path, table)},
                                              {.position = path.points.front()},
                                              {.position = path.points.back()})
                                        .length;
            if (!(std::abs(unfolded - path.length) <=
                  kMaxDeviation + kMaxDeviationPerMetre * path.length)) {
                refuse(frames, "has a path whose points are not those of reflections");
            }
        }
        paths.add(frame.time, frame.paths, table);
    }
    return paths;
}

/// How the listener is turned at a time.
audio::Orientation orientation_at(const std::vector<PathFrame>& instants, double time) {
    const auto upper = std::upper_bound(
        instants.begin() + 1, instants.end() - 1, time, [](double t, const PathFrame& frame) {
            return t < frame.time;
        });
    const PathFrame& from = *(upper - 1);
    const double along = std::clamp((time - from.time) / (upper->time - from.time), 0.0, 1.0);
    const auto between = [&](const Vec3& a, const Vec3& b) { return a + along * (b - a); };
    return orientation_of(pose_towards(Vec3(0.0),
                                       between(from.listener_front, upper->listener_front),
                                       between(from.listener_up, upper->listener_up)));
}

}  // namespace

MovingSound render_path_frames(const PathFrames& frames,
                               const ResponseFormat& format,
                               std::span<const double> recording,
                               Executor& executor,
                               Progress* progress) {
    if (frames.instants.size() < 2) {
        throw Error(frames.name,
                    "has paths at one instant alone",
                    "compute them with earshot ir --frames BEGIN:END:STEP");
    }
    for (std::size_t i = 1; i < frames.instants.size(); ++i) {
        if (!(frames.instants[i].time - frames.instants[i - 1].time >= kMinStep)) {
            refuse(frames, "has instants whose times do not ascend by a microsecond");
        }
    }
    require_one_edge(frames);
    const Ways ways = ways_of(frames);
    const MovingPaths paths = moving_paths_of(frames);
    const ResponseFormat checked = checked_format(format);
    const std::optional<audio::HrirInterpolator> hrirs = prepared_hrirs(checked);
    const audio::Assembler assembler(frames.bands, checked.sample_rate);
    const MovingEarlySound sound = {
        .paths = paths,
        .source = ways.source,
        .listener = ways.listener,
        .orientation_at = [&](double time) { return orientation_at(frames.instants, time); },
        .format = checked,
        .hrirs = hrirs,
        .assembler = assembler,
        .speed_of_sound = frames.speed_of_sound,
        .start = frames.instants.front().time};
    MovingSound result{.instants = paths.times().size(), .paths = paths.paths().size()};
    result.signal = {.sample_rate = static_cast<std::int64_t>(checked.sample_rate),
                     .channels = render_early_sound(sound, recording, executor, progress)};
    return result;
}

}  // namespace earshot::propagation
