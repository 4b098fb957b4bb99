// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/propagation/internal/complex_math.h"

#include <array>
#include <cstddef>

namespace earshot::propagation {

/// Nodes of a panel: those of Gauss and Legendre, ascending in [-1, 1].
inline constexpr std::size_t kPanelNodes = 8;
using PanelNodes = std::array<double, kPanelNodes>;
const PanelNodes& panel_positions() noexcept;
const PanelNodes& panel_weights() noexcept;

/// Weights w such that the sum of w f over the nodes is int_{-1}^{1} f(x) e^{-j phase x} dx: exact
/// for any phase if f is a polynomial of degree 7 (Filon 1928, with Legendre's polynomials: their
/// transforms are spherical Bessel functions).
std::array<Complex, kPanelNodes> oscillatory_weights(double phase) noexcept;

}  // namespace earshot::propagation
