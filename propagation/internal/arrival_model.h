// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/facets.h"
#include "earshot/propagation/least_squares.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace earshot::propagation {

/// The plane of triangles that reflect.
struct ReflectingWall {
    geometry::Plane plane{};
    std::uint32_t material = 0;
    geometry::TriangleId triangle = 0;  ///< the lowest that was met
};

/// What a fit of arrivals may change, or the errors of that.
struct ArrivalState {
    std::vector<geometry::Vec3> sources{}, listeners{};
    double speed = 0.0;                  ///< metres per second
    std::vector<double> latencies{};     ///< seconds, per source
    std::vector<double> wall_offsets{};  ///< of the planes along their normals, metres
};

/// A measured arrival on its path: the walls that mirror it, in order.
struct ArrivalTerm {
    std::size_t source = 0, listener = 0;
    std::vector<std::size_t> walls{};
    double time = 0.0;  ///< seconds
};

/// How a path's length changes.
struct LengthGradient {
    geometry::Vec3 source{0.0}, listener{0.0};
    std::vector<double> walls{};  ///< per reflection
};

/// The length of the path that is mirrored at the term's walls, from the source's image. Its
/// derivatives by the ends are unit vectors along the first and the last leg.
double path_length(const ArrivalState& state,
                   std::span<const ReflectingWall> walls,
                   const ArrivalTerm& term,
                   LengthGradient* gradient = nullptr);

/// Seconds from emission to arrival, latency included.
double arrival_time(const ArrivalState& state,
                    std::span<const ReflectingWall> walls,
                    const ArrivalTerm& term);

/// The parameters of a fit: the numbers of a state that are not held, in units of their errors from
/// what is stated (in metres or seconds where the error is infinite).
class ArrivalParameters {
public:
    ArrivalParameters(const ArrivalState& stated, const ArrivalState& errors);

    static constexpr std::size_t kHeld = static_cast<std::size_t>(-1);

    struct Entry {
        double scale = 1.0;      ///< the number is stated + scale * parameter
        bool has_prior = false;  ///< else its error is infinite
    };

    std::size_t count() const noexcept { return entries_.size(); }
    const std::vector<Entry>& entries() const noexcept { return entries_; }

    /// Places among the parameters; kHeld: the number is held.
    std::size_t source(std::size_t i, int axis) const noexcept {
        return sources_[3 * i + static_cast<std::size_t>(axis)];
    }
    std::size_t listener(std::size_t i, int axis) const noexcept {
        return listeners_[3 * i + static_cast<std::size_t>(axis)];
    }
    std::size_t speed() const noexcept { return speed_; }
    std::size_t latency(std::size_t source) const noexcept { return latencies_[source]; }
    std::size_t wall(std::size_t i) const noexcept { return walls_[i]; }

    ArrivalState state_at(std::span<const double> parameters) const;
    std::vector<double> parameters_of(const ArrivalState& state) const;

private:
    std::size_t add(double error);

    const ArrivalState stated_;
    std::vector<Entry> entries_;
    std::vector<std::size_t> sources_, listeners_, latencies_, walls_;
    std::size_t speed_ = kHeld;
};

/// Residuals of the terms, in units of `timing_error` and robust, then those of the priors. All
/// that is referred to must outlive the problem.
LeastSquaresProblem arrival_problem(const ArrivalParameters& parameters,
                                    std::span<const ReflectingWall> walls,
                                    std::span<const ArrivalTerm> terms,
                                    double timing_error);

}  // namespace earshot::propagation
