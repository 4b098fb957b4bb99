// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/assert.h"
#include "earshot/base/error_free.h"

#include <array>
#include <cstddef>
#include <span>

namespace earshot::geometry {

/// The exact sum of at most `Capacity` doubles, as an expansion: numbers that do not overlap in
/// their bits, in ascending magnitude, without zeros (Shewchuk 1997, section 2.2).
template <std::size_t Capacity>
class ExactSum {
public:
    /// Grow-Expansion with zero elimination (Shewchuk 1997, theorem 10).
    void add(double value) noexcept {
        std::size_t kept = 0;
        double carry = value;
        for (std::size_t i = 0; i < size_; ++i) {
            const DoublePair sum = two_sum(carry, components_[i]);
            if (sum.lo != 0.0) {
                components_[kept++] = sum.lo;
            }
            carry = sum.hi;
        }
        if (carry != 0.0) {
            EARSHOT_ASSERT(kept < Capacity);
            components_[kept++] = carry;
        }
        size_ = kept;
    }

    /// Adds a * b; counts as two numbers.
    void add_product(double a, double b) noexcept {
        const DoublePair product = two_product(a, b);
        add(product.lo);
        add(product.hi);
    }

    std::span<const double> components() const noexcept { return {components_.data(), size_}; }

    /// The sum rounded, with its sign: within 2 units of 2^-53 of it, because the components do not
    /// overlap.
    double estimate() const noexcept {
        double sum = 0.0;
        for (std::size_t i = 0; i < size_; ++i) {
            sum += components_[i];
        }
        return sum;
    }

    /// The largest component outweighs the others together.
    int sign() const noexcept {
        if (size_ == 0) {
            return 0;
        }
        return components_[size_ - 1] > 0.0 ? 1 : -1;
    }

private:
    std::array<double, Capacity> components_;  // uninitialised beyond size_: too large to clear
    std::size_t size_ = 0;
};

}  // namespace earshot::geometry
