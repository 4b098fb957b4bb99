// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/error.h"
#include "earshot/base/floating_point.h"
#include "earshot/base/parallel.h"
#include "earshot/base/progress.h"
#include "earshot/geometry/facets.h"
#include "earshot/propagation/air.h"
#include "earshot/propagation/scene.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace earshot::propagation {

// Positions of sources and listeners, and the speed of sound, from measured arrival times:
// docs/locate.md.

/// When sound of a source was measured to arrive at a listener.
struct MeasuredArrival {
    std::size_t source = 0;    ///< index into Scene::sources
    std::size_t listener = 0;  ///< index into Scene::listeners
    double time = 0.0;         ///< seconds since the emission, the source's latency included
    /// Names of the materials or meshes that reflected it, in order; empty: the direct sound. Of
    /// several paths that fit the one closest in time is meant. Nothing: it is not known.
    std::optional<std::vector<std::string>> surfaces{};

    friend bool operator==(const MeasuredArrival&, const MeasuredArrival&) = default;
};

/// Errors are standard deviations of what is stated: 0 holds it, infinity says that nothing is
/// known.
struct LocateOptions {
    double source_error = 0.01;      ///< of each coordinate of a source, metres
    double listener_error = 0.01;    ///< and of a listener
    double temperature_error = 2.0;  ///< of the air, kelvin: the speed of sound
    double latency_error = 0.0;      ///< seconds that a source starts late; stated as 0
    double wall_error = 0.0;         ///< of the planes of reflecting surfaces, metres
    /// Of the measured times but for outliers, seconds, > 0: two samples at 48 kHz. Larger, the
    /// arrivals move less of what is stated.
    double timing_error = 4e-5;
    /// An arrival without surfaces takes a path at most so many seconds away.
    double match_window = 1e-3;
    /// Max reflections of a path; nothing: those of the longest list of surfaces, and at least one
    /// if an arrival has none.
    std::optional<int> specular_order{};
    Air air{};
    double time = 0.0;    ///< seconds, of the scene's animation
    int max_rounds = 20;  ///< of paths found and fitted, >= 1
};

/// A stated number and what the arrivals make of it.
struct LocatedValue {
    double stated = 0.0;
    double value = 0.0;
    double standard_error = 0.0;  ///< of data and prior together; infinite if neither tells it
    /// The part of what is known that the data have told: 1 - (standard error / stated error)^2.
    double data_share = 0.0;

    /// Of 95 %.
    double lower() const noexcept { return value - 1.96 * standard_error; }
    double upper() const noexcept { return value + 1.96 * standard_error; }
};

struct LocatedPoint {
    LocatedValue x{}, y{}, z{};  ///< metres, of the scene
    std::size_t arrivals = 0;    ///< that were fitted

    geometry::Vec3 stated() const noexcept { return {x.stated, y.stated, z.stated}; }
    geometry::Vec3 position() const noexcept { return {x.value, y.value, z.value}; }
};

/// Coplanar triangles that reflect arrivals, and how far their plane lies along its normal.
struct LocatedWall {
    std::uint32_t material = 0;            ///< of the first triangle
    geometry::TriangleId triangle = 0;     ///< the lowest that reflects an arrival
    geometry::Vec3 normal{0.0, 1.0, 0.0};  ///< its largest component positive
    LocatedValue offset{};                 ///< normal . x of the plane's points, metres
    std::size_t arrivals = 0;
};

/// A measured arrival and the model's.
struct LocatedArrival {
    bool is_matched = false;                        ///< else no path fits: left out
    std::vector<geometry::TriangleId> triangles{};  ///< that reflect its path
    double before = 0.0, after = 0.0;               ///< model - measured, seconds
    double weight = 0.0;                            ///< 1; less for outliers; 0 if left out
};

/// A motion of all sources and listeners together (and of the walls, if they are not held).
struct CommonMotion {
    std::string name;         ///< "translation x", "rotation y", "scale", ...
    double data_share = 0.0;  ///< near 0: what is stated alone tells it

    bool is_told_by_data() const noexcept { return data_share >= 0.01; }
};

struct LocateResult {
    std::vector<LocatedPoint> sources{}, listeners{};
    LocatedValue speed_of_sound{};           ///< metres per second
    double temperature_c = 0.0;              ///< of air in which sound is so fast
    std::vector<LocatedValue> latencies{};   ///< seconds, of the sources
    std::vector<LocatedWall> walls{};        ///< by their lowest triangles
    std::vector<LocatedArrival> arrivals{};  ///< as they were measured
    std::vector<CommonMotion> motions{};     ///< empty if sources or listeners are held
    std::size_t matched = 0;                 ///< arrivals that were fitted
    /// Root mean square of the moves of coordinates that are neither held nor unknown, in their
    /// errors: far above 1, the errors are stated too small, or the model is wrong.
    double rms_move = 0.0;
    double timing_error = 0.0;                       ///< seconds, stated or estimated
    double median_before = 0.0, median_after = 0.0;  ///< of absolute errors, seconds
    int specular_order = 0;                          ///< of the paths that were looked for
    int rounds = 0;
    bool converged = false;
};

/// The most probable positions, speed of sound, latencies and walls, under normal errors of what is
/// stated and errors of the times of which some are outliers (Huber's loss). The model of an
/// arrival is the length of an exact specular path, found by Simulator at the current positions and
/// mirrored at its walls' planes, over the speed of sound; paths are found and matched anew until
/// they stay. Lengths are rounded to 0.1 mm, speeds to 0.001 m/s, times to 0.1 us and shares to
/// 0.001. Throws Error if an option, index, time or name is out of range, no arrival fits a path,
/// the fit runs away, or this build is without the solver (least_squares_available()). Reports the
/// stage "locating", by rounds.
LocateResult locate(const Scene& scene,
                    std::span<const MeasuredArrival> arrivals,
                    const LocateOptions& options = {},
                    Executor& executor = Executor::serial(),
                    Progress* progress = nullptr);

/// Model - measured of each arrival, seconds, from locate() without it: in turn each of `folds`
/// (>= 2) equal parts, drawn by `seed`, is left out. Rounded to 0.1 us; nothing where no path fits.
/// Reports the stage "cross-validation", by folds.
std::vector<std::optional<double>> cross_validate_locate(const Scene& scene,
                                                         std::span<const MeasuredArrival> arrivals,
                                                         std::size_t folds,
                                                         std::uint64_t seed,
                                                         const LocateOptions& options = {},
                                                         Executor& executor = Executor::serial(),
                                                         Progress* progress = nullptr);

/// The median of the absolute values of those that are there; nothing if none is.
std::optional<double> median_absolute(std::span<const std::optional<double>> errors);

}  // namespace earshot::propagation
