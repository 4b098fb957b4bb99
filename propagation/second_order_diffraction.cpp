// SPDX-License-Identifier: MIT
#include "earshot/propagation/second_order_diffraction.h"

#include "earshot/propagation/internal/complex_math.h"
#include "earshot/propagation/uniform_diffraction.h"

#include <cmath>

namespace earshot::propagation {

using geometry::WedgePoint;

std::complex<double> DoublyDiffractedPressure::total() const noexcept {
    Complex sum{0.0};
    for (const Kinds* kinds : {&upright, &inverted}) {
        for (const auto& of_first : *kinds) {
            for (const Complex& pressure : of_first) {
                sum += pressure;
            }
        }
    }
    return sum;
}

DoublyDiffractedPressure doubly_diffracted_pressure(const DoubleDiffraction& edges,
                                                    double wave_number) {
    return EdgePairSpectrum(edges, wave_number).pressure(wave_number);
}

std::complex<double> second_order_pressure(const DoubleDiffraction& edges, double wave_number) {
    return doubly_diffracted_pressure(edges, wave_number).total();
}

std::complex<double> utd_second_order_pressure(const DoubleDiffraction& edges,
                                               double wave_number) noexcept {
    const DoublePath path = shortest_path(edges);
    const WedgePoint source = geometry::wedge_coordinates(edges.first, edges.source);
    const WedgePoint listener = geometry::wedge_coordinates(edges.second, edges.listener);
    WedgePoint second =
        geometry::wedge_coordinates(edges.first, edges.second.point_at(path.second_z));
    WedgePoint first =
        geometry::wedge_coordinates(edges.second, edges.first.point_at(path.first_z));
    if (edges.common_face) {
        second.angle = edges.common_face->of_first == 0 ? 0.0 : edges.first.open_angle;
        first.angle = edges.common_face->of_second == 0 ? 0.0 : edges.second.open_angle;
    }
    const double first_sine = source.radius / path.before;
    const double second_sine = listener.radius / path.after;
    // Each wedge sees the distance to the other one, not the length of the whole way.
    const Complex at_first = utd_coefficient(
        edges.first.open_angle,
        source.angle,
        second.angle,
        first_sine,
        path.before * path.between * first_sine * first_sine / (path.before + path.between),
        wave_number);
    const Complex at_second = utd_coefficient(
        edges.second.open_angle,
        first.angle,
        listener.angle,
        second_sine,
        path.between * path.after * second_sine * second_sine / (path.between + path.after),
        wave_number);
    const double half = edges.common_face ? 0.5 : 1.0;
    return half * at_first * at_second * unit(-wave_number * path.length()) /
           std::sqrt(path.before * path.between * path.after * path.length());
}

}  // namespace earshot::propagation
