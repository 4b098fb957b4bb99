// SPDX-License-Identifier: MIT
#include <kissfft/kissfft.hh>

#include "fourier_contenders.h"

namespace bench {

std::function<void(std::span<const std::complex<double>>, std::span<std::complex<double>>)>
kiss_transform(std::size_t size) {
    return [plan = kissfft<double>(size, false)](std::span<const std::complex<double>> from,
                                                 std::span<std::complex<double>> to) {
        plan.transform(from.data(), to.data());
    };
}

}  // namespace bench
