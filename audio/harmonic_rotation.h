// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/spatial.h"
#include "earshot/base/floating_point.h"

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace earshot::audio {

/// Rows of a rotation: what front, left and up of the turned frame are in the frame before.
using RotationRows = std::array<std::array<double, 3>, 3>;

/// Turns the channels of an ambisonic sound field (ACN, SN3D) for a listener who turns. The
/// harmonics of one degree turn among themselves: their matrix is found from its values in as many
/// directions as the degree has harmonics. Const members allocate nothing.
class HarmonicRotation {
public:
    explicit HarmonicRotation(int order);

    int order() const noexcept { return order_; }
    std::size_t channels() const noexcept { return ambisonic_channels(order_); }
    /// Numbers of a matrix: one block per degree.
    std::size_t coefficients() const noexcept;

    /// The matrix that takes the harmonics of any direction in the frame before to those of the
    /// same direction in the turned one.
    void matrix(const RotationRows& rows, std::span<float> coefficients) const noexcept;

    /// Turns a block of channels, rows of `block` samples (a multiple of 8), by a matrix that
    /// changes linearly from `from` to `to`.
    void apply(std::span<const float> from,
               std::span<const float> to,
               std::size_t block,
               const float* in,
               float* out) const noexcept;

private:
    struct Degree {
        std::vector<std::array<double, 3>> directions;
        std::vector<double> inverse;  // of the harmonics in these directions, row-major
    };
    int order_;
    std::vector<Degree> degrees_;
};

}  // namespace earshot::audio
