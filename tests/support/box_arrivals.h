// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/impulse_response.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <vector>

namespace earshot::support {

/// Pressure reflection factors of the walls of a box per band: low x, high x, low y ...
using WallFactors = std::array<audio::Spectrum, 6>;

/// Octave bands of plaster, carpet, wood, curtain, concrete and absorbent ceiling, or the first of
/// them on all walls.
inline WallFactors wall_factors(bool all_alike) {
    constexpr double kAbsorption[6][10] = {
        {0.28, 0.28, 0.26, 0.20, 0.12, 0.09, 0.10, 0.11, 0.12, 0.12},
        {0.02, 0.02, 0.03, 0.06, 0.14, 0.37, 0.60, 0.65, 0.66, 0.66},
        {0.18, 0.16, 0.15, 0.11, 0.10, 0.07, 0.06, 0.07, 0.08, 0.08},
        {0.05, 0.06, 0.07, 0.31, 0.49, 0.75, 0.70, 0.60, 0.60, 0.60},
        {0.01, 0.01, 0.01, 0.01, 0.02, 0.02, 0.02, 0.03, 0.03, 0.04},
        {0.30, 0.35, 0.45, 0.55, 0.70, 0.80, 0.75, 0.65, 0.60, 0.55}};
    WallFactors walls{};
    for (std::size_t wall = 0; wall < 6; ++wall) {
        for (std::size_t band = 0; band < 10; ++band) {
            walls[wall][band] = std::sqrt(1.0 - kAbsorption[all_alike ? 0 : wall][band]);
        }
    }
    return walls;
}

/// The image sources of a box of 8 x 6 x 3.5 m up to an order, with spherical spreading and the
/// absorption of air, and directions of travel. Ten octave bands.
inline std::vector<audio::Arrival> box_arrivals(int order, const WallFactors& walls) {
    constexpr double kSize[3] = {8.0, 6.0, 3.5};
    constexpr double kSource[3] = {2.0, 1.5, 1.2};
    constexpr double kListener[3] = {5.5, 4.0, 1.6};
    constexpr double kAir[10] = {
        1e-6, 4e-6, 2e-5, 6e-5, 1.5e-4, 3e-4, 6e-4, 1.7e-3, 6e-3, 2.1e-2};  // nepers per metre
    std::vector<audio::Arrival> arrivals;
    for (int i = -order; i <= order; ++i) {
        for (int j = std::abs(i) - order; j <= order - std::abs(i); ++j) {
            const int rest = order - std::abs(i) - std::abs(j);
            for (int k = -rest; k <= rest; ++k) {
                const int cell[3] = {i, j, k};
                audio::Arrival arrival;
                arrival.pressure.fill(1.0);
                double squared = 0.0;
                for (std::size_t axis = 0; axis < 3; ++axis) {
                    const int q = cell[axis];
                    const double image = q * kSize[axis] +
                                         (q % 2 == 0 ? kSource[axis] : kSize[axis] - kSource[axis]);
                    arrival.direction[axis] = kListener[axis] - image;
                    squared += arrival.direction[axis] * arrival.direction[axis];
                    // The wall on the image's side is hit first, then both in turn.
                    const int first = (std::abs(q) + 1) / 2;
                    const int second = std::abs(q) / 2;
                    const audio::Spectrum& near = walls[2 * axis + (q > 0 ? 1 : 0)];
                    const audio::Spectrum& far = walls[2 * axis + (q > 0 ? 0 : 1)];
                    for (std::size_t band = 0; band < 10; ++band) {
                        arrival.pressure[band] *=
                            std::pow(near[band], first) * std::pow(far[band], second);
                    }
                }
                const double distance = std::sqrt(squared);
                arrival.delay = distance / 343.0;
                for (std::size_t band = 0; band < 10; ++band) {
                    arrival.pressure[band] *= std::exp(-kAir[band] * distance) / distance;
                }
                for (double& component : arrival.direction) {
                    component /= distance;
                }
                arrivals.push_back(arrival);
            }
        }
    }
    return arrivals;
}

}  // namespace earshot::support
