// SPDX-License-Identifier: MIT
#include "earshot/base/standard_error.h"

#include "earshot/base/assert.h"

#include <cmath>

namespace earshot {

double standard_error_of_mean(std::span<const double> values) {
    EARSHOT_ASSERT(values.size() >= 2);
    const auto count = static_cast<double>(values.size());
    double mean = 0.0;
    for (const double value : values) {
        mean += value / count;
    }
    double squares = 0.0;
    for (const double value : values) {
        squares += (value - mean) * (value - mean);
    }
    return std::sqrt(squares / (count * (count - 1.0)));
}

}  // namespace earshot
