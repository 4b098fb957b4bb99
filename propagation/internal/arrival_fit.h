// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/propagation/internal/arrival_matching.h"
#include "earshot/propagation/internal/arrival_model.h"

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace earshot::propagation {

/// A fit of arrivals, unrounded.
struct ArrivalFit {
    ArrivalState stated{}, at{};
    MatchedPaths paths{};
    std::vector<ArrivalTerm> terms{};            ///< of the arrivals that have a path
    std::vector<std::size_t> arrival_of_term{};  ///< ascending
    std::optional<ArrivalParameters> parameters{};
    LeastSquaresSolution solution{};
    int rounds = 0;
    bool converged = false;
};

/// Fits of one scene, with other arrivals each.
class ArrivalFitter {
public:
    /// All that is referred to must outlive the fitter.
    ArrivalFitter(const Scene& scene,
                  const LocateOptions& options,
                  int specular_order,
                  Executor& executor);

    /// Throws Error if no arrival has a path.
    ArrivalFit fit(std::span<const MeasuredArrival> arrivals, Progress* progress);

    /// Model - measured of other arrivals after a fit, seconds; nothing where no path fits.
    std::vector<std::optional<double>> errors_of(const ArrivalFit& fit,
                                                 std::span<const MeasuredArrival> arrivals);

    const std::vector<ReflectingWall>& walls() const noexcept { return walls_.walls(); }

private:
    void find_terms(std::span<const MeasuredArrival> arrivals, ArrivalFit& fit, bool is_first);
    void solve(ArrivalFit& fit) const;
    ArrivalState errors_of_stated(const ArrivalState& stated) const;
    /// Of the arrivals that have a path; the state gets the offsets of the walls that are new.
    std::vector<ArrivalTerm> terms_of(std::span<const MeasuredArrival> arrivals,
                                      const MatchedPaths& paths,
                                      ArrivalState& state);

    const Scene& scene_;
    const LocateOptions& options_;
    const int specular_order_;
    Executor& executor_;
    WallPlanes walls_;
};

/// See CommonMotion. Precondition: the fit has been made by a fitter with these walls.
std::vector<CommonMotion> common_motions(const ArrivalFit& fit,
                                         std::span<const ReflectingWall> walls,
                                         double timing_error);

}  // namespace earshot::propagation
