// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/floating_point.h"

#include <span>

namespace earshot {

/// Standard error of the mean of independent values, from their spread. Sums run in the order of
/// the values. Precondition: two values or more.
double standard_error_of_mean(std::span<const double> values);

}  // namespace earshot
