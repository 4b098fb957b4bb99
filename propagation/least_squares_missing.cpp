// SPDX-License-Identifier: MIT
#include "earshot/base/error.h"
#include "earshot/propagation/least_squares.h"

namespace earshot::propagation {

bool least_squares_available() noexcept {
    return false;
}

LeastSquaresSolution solve_least_squares(const LeastSquaresProblem& /*problem*/,
                                         std::span<const double> /*start*/,
                                         const LeastSquaresOptions& /*options*/) {
    throw Error("least squares",
                "this build is without Ceres",
                "install libceres-dev, configure and build again");
}

}  // namespace earshot::propagation
