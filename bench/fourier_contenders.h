// SPDX-License-Identifier: MIT
#pragma once

#include <complex>
#include <functional>
#include <span>

namespace bench {

/// A complex transform of `size` numbers by KISS FFT, its plan made before; empty where KISS FFT
/// was not found at configure time.
std::function<void(std::span<const std::complex<double>>, std::span<std::complex<double>>)>
kiss_transform(std::size_t size);

/// Prints microseconds of real transforms, and of KISS FFT's complex ones of half the size.
void compare_fourier_transforms(int repeats);

}  // namespace bench
