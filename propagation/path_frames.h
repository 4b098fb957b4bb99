// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/bands.h"
#include "earshot/base/floating_point.h"
#include "earshot/base/parallel.h"
#include "earshot/base/progress.h"
#include "earshot/geometry/types.h"
#include "earshot/propagation/moving_sound.h"
#include "earshot/propagation/pair_result.h"
#include "earshot/propagation/response.h"

#include <span>
#include <string>
#include <vector>

namespace earshot::propagation {

/// The paths of a pair at an instant. What is used of a path: kind, points, triangles, transmitted,
/// pressure, edges and parts; its points lie where they are at that instant.
struct PathFrame {
    double time = 0.0;  ///< seconds
    std::vector<Path> paths{};
    /// How the listener is turned, as by pose_towards().
    geometry::Vec3 listener_front{0.0, 0.0, -1.0}, listener_up{0.0, 1.0, 0.0};
};

/// The paths of a pair at consecutive instants without the scene in which they were found.
struct PathFrames {
    std::string name{};  ///< where they come from, for errors
    audio::Bands bands = audio::Bands::octaves();
    double speed_of_sound = 343.2;      ///< metres per second
    std::vector<PathFrame> instants{};  ///< times ascend
};

/// What the listener hears of a mono recording at ResponseFormat::sample_rate that begins at the
/// first instant, as render_moving_pair() without late sound. Planes of reflections follow from the
/// points of the paths, ways of source and listener go through the points at which paths begin and
/// end; between instants the listener's front and up go straight from one to the next. All stay as
/// they are after the last instant. Throws Error if there are no two instants, if their times do
/// not ascend by a microsecond, if there is no path, if a path bends round several edges or its
/// points are not those of reflections, if a path is longer than the way of sound in 100 s, if
/// source or listener move at more than 0.9 of the speed of sound or are at two places at an
/// instant, and as ResponseRenderer. Reports the stage "sound".
MovingSound render_path_frames(const PathFrames& frames,
                               const ResponseFormat& format,
                               std::span<const double> recording,
                               Executor& executor = Executor::serial(),
                               Progress* progress = nullptr);

}  // namespace earshot::propagation
