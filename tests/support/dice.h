// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/random.h"

#include <cstdint>

namespace earshot::support {

/// Random numbers in the order they are asked for: the whole sequence follows from the seed.
class Dice {
public:
    explicit Dice(std::uint64_t seed) : seed_(seed) {}

    /// Uniform in [low, high].
    double between(double low, double high) {
        return random_between(seed_, 0, throws_++, low, high);
    }
    /// Uniform in 0 ... count - 1. Precondition: count > 0.
    int below(int count) {
        return static_cast<int>(random(seed_, 0, throws_++) * static_cast<double>(count));
    }
    /// True with the given probability.
    bool chance(double probability) { return random(seed_, 0, throws_++) < probability; }

private:
    std::uint64_t seed_;
    std::uint64_t throws_ = 0;
};

}  // namespace earshot::support
