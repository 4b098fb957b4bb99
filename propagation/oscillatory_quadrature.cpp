// SPDX-License-Identifier: MIT
#include "earshot/propagation/internal/oscillatory_quadrature.h"

#include "earshot/propagation/internal/quadrature.h"

namespace earshot::propagation {

namespace {

constexpr PanelNodes mirrored(double QuadratureNode::*member, double sign) {
    PanelNodes values{};
    for (std::size_t i = 0; i < kLegendre8.size(); ++i) {
        values[kLegendre8.size() + i] = kLegendre8[i].*member;
        values[kLegendre8.size() - 1 - i] = sign * kLegendre8[i].*member;
    }
    return values;
}

constexpr PanelNodes kPositions = mirrored(&QuadratureNode::position, -1.0);
constexpr PanelNodes kWeights = mirrored(&QuadratureNode::weight, 1.0);

/// (2 n + 1) P_n at the nodes times their weights, by n and node.
constexpr std::array<PanelNodes, kPanelNodes> make_transform() {
    std::array<PanelNodes, kPanelNodes> transform{};
    for (std::size_t i = 0; i < kPanelNodes; ++i) {
        const double x = kPositions[i];
        double before = 0.0, current = 1.0;
        for (std::size_t n = 0; n < kPanelNodes; ++n) {
            const auto degree = static_cast<double>(n);
            transform[n][i] = (2.0 * degree + 1.0) * current * kWeights[i];
            const double next =
                ((2.0 * degree + 1.0) * x * current - degree * before) / (degree + 1.0);
            before = current;
            current = next;
        }
    }
    return transform;
}

constexpr std::array<PanelNodes, kPanelNodes> kTransform = make_transform();

}  // namespace

const PanelNodes& panel_positions() noexcept {
    return kPositions;
}

const PanelNodes& panel_weights() noexcept {
    return kWeights;
}

// f is the sum of c_n P_n, c_n = (2 n + 1) / 2 sum of weight f P_n over the nodes, and
// int P_n(x) e^{-j phase x} dx = 2 (-j)^n j_n(phase).
std::array<Complex, kPanelNodes> oscillatory_weights(double phase) noexcept {
    std::array<Complex, kPanelNodes> weights{};
    // Below it the rule of Gauss alone is as exact, and the recurrence would lose digits.
    constexpr double kMinPhase = 1.0;
    if (phase < kMinPhase) {
        for (std::size_t i = 0; i < kPanelNodes; ++i) {
            weights[i] = kWeights[i] * unit(-phase * kPositions[i]);
        }
        return weights;
    }
    const double inverse = 1.0 / phase;
    const double sine = math::sin(phase);
    double before = math::cos(phase) * inverse;  // j_{-1}
    double bessel = sine * inverse;
    Complex turn{1.0};
    for (std::size_t n = 0; n < kPanelNodes; ++n) {
        for (std::size_t i = 0; i < kPanelNodes; ++i) {
            weights[i] += kTransform[n][i] * bessel * turn;
        }
        const double next = (2.0 * static_cast<double>(n) + 1.0) * inverse * bessel - before;
        before = bessel;
        bessel = next;
        turn = Complex(turn.imag(), -turn.real());
    }
    return weights;
}

}  // namespace earshot::propagation
