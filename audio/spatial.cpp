// SPDX-License-Identifier: MIT
#include "earshot/audio/spatial.h"

#include "earshot/base/assert.h"
#include "earshot/base/error.h"

#include <cmath>
#include <string>

namespace earshot::audio {

namespace {

using Vector = std::array<double, 3>;

double dot(const Vector& a, const Vector& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

// sqrt((2 - [m == 0]) (l - m)! / (l + m)!)
double sn3d_factor(int degree, int order) {
    double ratio = order == 0 ? 1.0 : 2.0;
    for (int k = degree - order + 1; k <= degree + order; ++k) {
        ratio /= k;
    }
    return std::sqrt(ratio);
}

}  // namespace

Vector origin_seen_from(const Orientation& orientation, const Arrival& arrival) {
    const Vector& travel = arrival.direction;
    const double length = std::sqrt(dot(travel, travel));
    if (length == 0.0) {
        return {};
    }
    return {-dot(travel, orientation.front) / length,
            -dot(travel, orientation.left) / length,
            -dot(travel, orientation.up) / length};
}

std::size_t ambisonic_channels(int order) noexcept {
    const auto side = static_cast<std::size_t>(order + 1);
    return side * side;
}

void spherical_harmonics(int order, const Vector& towards, std::span<double> values) {
    EARSHOT_ASSERT(order >= 0 && order <= kMaxAmbisonicOrder);
    EARSHOT_ASSERT(values.size() == ambisonic_channels(order));
    const auto [x, y, z] = towards;
    // cos^m(elevation) times the cosine and sine of m times the azimuth: powers of x + iy, which
    // need no angle and have no pole.
    double cosine = 1.0;
    double sine = 0.0;
    double double_factorial = 1.0;  // (2m - 1)!!
    for (int m = 0; m <= order; ++m) {
        // Legendre functions without their power of cos(elevation), by the recurrence in the
        // degree.
        double below = 0.0;
        double legendre = double_factorial;
        for (int l = m; l <= order; ++l) {
            const double factor = sn3d_factor(l, m) * legendre;
            const int middle = l * l + l;
            values[static_cast<std::size_t>(middle + m)] = factor * cosine;
            if (m > 0) {
                values[static_cast<std::size_t>(middle - m)] = factor * sine;
            }
            const double above = ((2 * l + 1) * z * legendre - (l + m) * below) / (l + 1 - m);
            below = legendre;
            legendre = above;
        }
        const double next = x * cosine - y * sine;
        sine = x * sine + y * cosine;
        cosine = next;
        double_factorial *= 2 * m + 1;
    }
}

std::vector<ImpulseResponse> encode_ambisonic(const Assembler& assembler,
                                              std::span<const Arrival> arrivals,
                                              int order,
                                              const Orientation& orientation,
                                              double length,
                                              Executor& executor) {
    if (order < 0 || order > kMaxAmbisonicOrder) {
        throw Error("ambisonic order",
                    "must lie in 0 ... " + std::to_string(kMaxAmbisonicOrder) + ", not " +
                        std::to_string(order),
                    "1 has four channels, 3 has sixteen");
    }
    const std::size_t channels = ambisonic_channels(order);
    std::vector<double> gains(arrivals.size() * channels);
    for (std::size_t i = 0; i < arrivals.size(); ++i) {
        const auto row = std::span(gains).subspan(i * channels, channels);
        const Vector towards = origin_seen_from(orientation, arrivals[i]);
        if (towards == Vector{}) {
            row[0] = 1.0;
        } else {
            spherical_harmonics(order, towards, row);
        }
    }
    return assembler.assemble_channels(arrivals, gains, channels, length, executor);
}

}  // namespace earshot::audio
