// SPDX-License-Identifier: MIT
#include "earshot/audio/internal/representatives_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "earshot/audio/representatives_kernel.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which includes this file again for every instruction set.
#include "earshot/base/simd/math-inl.h"

HWY_BEFORE_NAMESPACE();
namespace earshot::audio::HWY_NAMESPACE {

using namespace earshot::HWY_NAMESPACE;

void node_vectors(const NodeRows& nodes,
                  const double* log_pressure,
                  double* vectors,
                  double* norms) {
    for (std::size_t lane = 0; lane < kLanes; lane += Doubles::kCount) {
        const double* logs = log_pressure + lane;
        double* out = vectors + lane;
        Doubles energy(0.0);
        for (std::size_t k = 0; k < nodes.count; ++k) {
            const double* lower = logs + nodes.lower_band[k] * kLanes;
            const Doubles below = Doubles::load(lower);
            const Doubles rise = Doubles::load(lower + kLanes) - below;
            const Doubles log_magnitude = below + Doubles(nodes.upper_weight[k]) * rise;
            Doubles phase(0.0);
            const double* row = nodes.phase + k * nodes.bands;
            for (std::size_t band = 0; band < nodes.bands; ++band) {
                phase = phase + Doubles(row[band]) * Doubles::load(logs + band * kLanes);
            }
            const Doubles magnitude = Doubles(nodes.weight[k]) * exp(log_magnitude);
            const SinCos turn = sin_cos(phase);
            const Doubles re = magnitude * turn.cos;
            const Doubles im = magnitude * turn.sin;
            re.store(out + 2 * k * kLanes);
            im.store(out + (2 * k + 1) * kLanes);
            energy = energy + (re * re + im * im);
        }
        const Doubles norm = sqrt(energy);
        norm.store(norms + lane);
        const Doubles scale = Doubles(1.0) / norm;
        for (std::size_t k = 0; k < 2 * nodes.count; ++k) {
            (scale * Doubles::load(out + k * kLanes)).store(out + k * kLanes);
        }
        for (std::size_t k = 2 * nodes.count; k < vector_size(nodes.count); ++k) {
            Doubles(0.0).store(out + k * kLanes);
        }
    }
}

/// kRows rows of the basis at once: as many sums in flight hide the latency of additions.
template <std::size_t kRows>
HWY_INLINE void project_rows(const double* vectors,
                             const double* basis,
                             std::size_t size,
                             std::size_t row,
                             double* coefficients,
                             double* remainders) {
    for (std::size_t lane = 0; lane < kLanes; lane += Doubles::kCount) {
        Doubles sums[kRows];
        for (Doubles& sum : sums) {
            sum = Doubles(0.0);
        }
        for (std::size_t k = 0; k < size; ++k) {
            const Doubles value = Doubles::load(vectors + k * kLanes + lane);
            for (std::size_t u = 0; u < kRows; ++u) {
                sums[u] = sums[u] + value * Doubles(basis[u * size + k]);
            }
        }
        Doubles remainder = Doubles::load(remainders + lane);
        for (std::size_t u = 0; u < kRows; ++u) {
            sums[u].store(coefficients + u * row + lane);
            remainder = remainder - sums[u] * sums[u];
        }
        remainder.store(remainders + lane);
    }
}

void project(const double* vectors,
             const double* basis,
             std::size_t size,
             std::size_t count,
             std::size_t row,
             double* coefficients,
             double* remainders) {
    std::size_t u = 0;
    for (; u + 4 <= count; u += 4) {
        project_rows<4>(vectors, basis + u * size, size, row, coefficients + u * row, remainders);
    }
    for (; u < count; ++u) {
        project_rows<1>(vectors, basis + u * size, size, row, coefficients + u * row, remainders);
    }
}

template <std::size_t kGroups>
HWY_INLINE void project_some_groups(const double* const* vectors,
                                    const double* basis,
                                    std::size_t size,
                                    double* const* coefficients,
                                    double* const* remainders) {
    for (std::size_t lane = 0; lane < kLanes; lane += Doubles::kCount) {
        Doubles sums[kGroups];
        for (Doubles& sum : sums) {
            sum = Doubles(0.0);
        }
        for (std::size_t k = 0; k < size; ++k) {
            const Doubles factor(basis[k]);
            for (std::size_t g = 0; g < kGroups; ++g) {
                sums[g] = sums[g] + Doubles::load(vectors[g] + k * kLanes + lane) * factor;
            }
        }
        for (std::size_t g = 0; g < kGroups; ++g) {
            sums[g].store(coefficients[g] + lane);
            const Doubles remainder = Doubles::load(remainders[g] + lane);
            (remainder - sums[g] * sums[g]).store(remainders[g] + lane);
        }
    }
}

void project_groups(const double* const* vectors,
                    const double* basis,
                    std::size_t size,
                    std::size_t groups,
                    double* const* coefficients,
                    double* const* remainders) {
    std::size_t g = 0;
    for (; g + 4 <= groups; g += 4) {
        project_some_groups<4>(vectors + g, basis, size, coefficients + g, remainders + g);
    }
    for (; g < groups; ++g) {
        project_some_groups<1>(vectors + g, basis, size, coefficients + g, remainders + g);
    }
}

/// The sum of kLanes partial sums, in a fixed order.
HWY_INLINE double dot(const double* a, const double* b, std::size_t size) {
    alignas(64) double sums[kLanes];
    for (std::size_t lane = 0; lane < kLanes; lane += Doubles::kCount) {
        Doubles sum(0.0);
        for (std::size_t k = lane; k < size; k += kLanes) {
            sum = sum + Doubles::load(a + k) * Doubles::load(b + k);
        }
        sum.store(sums + lane);
    }
    return ((sums[0] + sums[4]) + (sums[2] + sums[6])) +
           ((sums[1] + sums[5]) + (sums[3] + sums[7]));
}

void orthogonalise(const double* basis, std::size_t size, std::size_t count, double* vector) {
    // Once more than in exact arithmetic: the first pass leaves rounding errors that are large
    // beside a small remainder (Daniel et al. 1976).
    for (int pass = 0; pass < 2; ++pass) {
        for (std::size_t u = 0; u < count; ++u) {
            const double* row = basis + u * size;
            const Doubles along(dot(row, vector, size));
            for (std::size_t k = 0; k < size; k += Doubles::kCount) {
                (Doubles::load(vector + k) - along * Doubles::load(row + k)).store(vector + k);
            }
        }
    }
    alignas(64) double energy[kLanes] = {dot(vector, vector, size)};
    const Doubles scale = Doubles(1.0) / sqrt(Doubles(energy[0]));
    for (std::size_t k = 0; k < size; k += Doubles::kCount) {
        (scale * Doubles::load(vector + k)).store(vector + k);
    }
}

void solve_weights(const double* pivots, std::size_t count, double* coefficients) {
    for (std::size_t lane = 0; lane < kLanes; lane += Doubles::kCount) {
        double* column = coefficients + lane;
        for (std::size_t j = count; j-- > 0;) {
            const double* row = pivots + j * count;
            const Doubles weight = Doubles::load(column + j * kLanes) / Doubles(row[j]);
            weight.store(column + j * kLanes);
            for (std::size_t i = 0; i < j; ++i) {
                const Doubles rest = Doubles::load(column + i * kLanes) - weight * Doubles(row[i]);
                rest.store(column + i * kLanes);
            }
        }
    }
}

}  // namespace earshot::audio::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace earshot::audio {

HWY_EXPORT(node_vectors);
HWY_EXPORT(project);
HWY_EXPORT(project_groups);
HWY_EXPORT(orthogonalise);
HWY_EXPORT(solve_weights);

void node_vectors(const NodeRows& nodes,
                  const double* log_pressure,
                  double* vectors,
                  double* norms) {
    HWY_DYNAMIC_DISPATCH(node_vectors)(nodes, log_pressure, vectors, norms);
}

void project(const double* vectors,
             const double* basis,
             std::size_t size,
             std::size_t count,
             std::size_t row,
             double* coefficients,
             double* remainders) {
    HWY_DYNAMIC_DISPATCH(project)
    (vectors, basis, size, count, row, coefficients, remainders);
}

void project_groups(const double* const* vectors,
                    const double* basis,
                    std::size_t size,
                    std::size_t groups,
                    double* const* coefficients,
                    double* const* remainders) {
    HWY_DYNAMIC_DISPATCH(project_groups)
    (vectors, basis, size, groups, coefficients, remainders);
}

void orthogonalise(const double* basis, std::size_t size, std::size_t count, double* vector) {
    HWY_DYNAMIC_DISPATCH(orthogonalise)(basis, size, count, vector);
}

void solve_weights(const double* pivots, std::size_t count, double* coefficients) {
    HWY_DYNAMIC_DISPATCH(solve_weights)(pivots, count, coefficients);
}

}  // namespace earshot::audio
#endif
