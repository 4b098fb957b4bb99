// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/internal/logical_lanes.h"

#include <cstddef>
#include <cstdint>

namespace earshot::audio {

/// The bins at which filters are compared.
struct NodeRows {
    std::size_t bands = 0;
    std::size_t count = 0;
    const std::uint32_t* lower_band = nullptr;
    const double* upper_weight = nullptr;
    const double* weight = nullptr;  ///< square root of the bins that a node stands for
    const double* phase = nullptr;   ///< row of `bands` per node
};

/// Numbers of a filter's vector: real and imaginary parts at the nodes, padded by zeros.
constexpr std::size_t vector_size(std::size_t nodes) noexcept {
    return padded(2 * nodes);
}

// A group is kLanes arrivals side by side: element k of lane i is at [k * kLanes + i].

/// The weighted spectra at the nodes of the group's filters, of unit length in `vectors`; the
/// lengths go to `norms`. `log_pressure`: bands + 1 rows.
void node_vectors(const NodeRows& nodes,
                  const double* log_pressure,
                  double* vectors,
                  double* norms);

/// coefficients[u * row] = vectors . basis_u for `count` rows of the basis, `size` numbers each,
/// and the remainders (squared) less the squares of the coefficients.
void project(const double* vectors,
             const double* basis,
             std::size_t size,
             std::size_t count,
             std::size_t row,
             double* coefficients,
             double* remainders);

/// project() on one row, for `groups` groups side by side in memory: vectors and coefficients.
void project_groups(const double* const* vectors,
                    const double* basis,
                    std::size_t size,
                    std::size_t groups,
                    double* const* coefficients,
                    double* const* remainders);

/// Takes out of `vector` its components along `count` rows of the basis, twice, and gives the rest
/// unit length.
void orthogonalise(const double* basis, std::size_t size, std::size_t count, double* vector);

/// From coefficients (count rows of a group) to the weights t that solve sum_m t_m pivots[m][j] =
/// c_j, in place. `pivots`: lower triangle, rows of `count`.
void solve_weights(const double* pivots, std::size_t count, double* coefficients);

}  // namespace earshot::audio
