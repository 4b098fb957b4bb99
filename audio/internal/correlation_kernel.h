// SPDX-License-Identifier: MIT
#pragma once

#include <span>

namespace earshot::audio {

/// Sum of the products of entries. Precondition: a.size() == b.size().
double dot_product(std::span<const double> a, std::span<const double> b);

}  // namespace earshot::audio
