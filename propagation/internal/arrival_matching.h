// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/propagation/internal/arrival_model.h"
#include "earshot/propagation/locate.h"
#include "earshot/propagation/pair_result.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace earshot::propagation {

/// The planes of a scene's triangles at one instant, each once however many triangles lie in it.
class WallPlanes {
public:
    WallPlanes(const Scene& scene, double time);

    /// The wall of a triangle, found when it is first asked for. Planes that differ by less than
    /// rounding are one; where a limit of the rounding lies between them they are two.
    std::size_t wall_of(geometry::TriangleId triangle);

    const std::vector<ReflectingWall>& walls() const noexcept { return walls_; }

private:
    const Scene& scene_;
    std::vector<geometry::Vec3> positions_;
    std::vector<ReflectingWall> walls_;
    std::map<std::array<std::int64_t, 4>, std::size_t> wall_of_plane_;
};

/// The path of each arrival; nothing where none fits.
using MatchedPaths = std::vector<std::optional<std::vector<geometry::TriangleId>>>;

/// Paths between the sources and listeners of a state.
std::vector<PairResult> paths_at(const Scene& scene,
                                 const ArrivalState& state,
                                 const LocateOptions& options,
                                 int specular_order,
                                 Executor& executor);

/// What arrivals without surfaces may take: paths that are no more than the window away in time,
/// each for one arrival of a pair, the closest first. Those with surfaces take the closest path
/// with these, however far.
MatchedPaths match_arrivals(const Scene& scene,
                            std::span<const MeasuredArrival> arrivals,
                            std::span<const PairResult> pairs,
                            const ArrivalState& state,
                            double window);

/// Latencies of the sources that bring arrivals near to paths: medians over arrivals that one path
/// alone fits, or over pairs' first arrivals if there are none.
std::vector<double> first_latencies(const Scene& scene,
                                    std::span<const MeasuredArrival> arrivals,
                                    std::span<const PairResult> pairs,
                                    double speed);

/// The middle one, the mean of two if their number is even. Precondition: one at least.
double median(std::vector<double> values);

}  // namespace earshot::propagation
