// SPDX-License-Identifier: MIT
#include "fourier_contenders.h"

#include "earshot/audio/internal/fft.h"
#include "earshot/base/random.h"

#include "harness.h"
#include <algorithm>

namespace bench {
namespace {

using Complex = std::complex<double>;

template <typename Work>
double microseconds(int repeats, std::size_t size, const Work& work) {
    const auto times = std::max<std::size_t>(1, 1000000 / size);
    return 1e6 / static_cast<double>(times) * min_times_of(repeats, [&] {
                                                  for (std::size_t i = 0; i < times; ++i) {
                                                      work();
                                                  }
                                              }).processor;
}

}  // namespace

void compare_fourier_transforms(int repeats) {
    std::printf(
        "\n%-10s %10s %10s %10s %12s\n", "us, size", "plan", "forward", "inverse", "KISS of half");
    for (const std::size_t size : {1024U, 4096U, 8192U, 65536U, 81920U, 98304U, 131072U}) {
        std::vector<double> signal(size);
        for (std::size_t n = 0; n < size; ++n) {
            signal[n] = earshot::random_between(1, 0, n, -1.0, 1.0);
        }
        const double plan =
            1e6 * min_times_of(repeats, [&] { earshot::audio::RealFft fft(size); }).processor;
        const earshot::audio::RealFft fft(size);
        earshot::audio::FftWorkspace workspace;
        std::vector<Complex> spectrum(fft.bins());
        const double forward =
            microseconds(repeats, size, [&] { fft.forward(signal, spectrum, workspace); });
        const double inverse =
            microseconds(repeats, size, [&] { fft.inverse(spectrum, signal, workspace); });
        std::printf("%-10zu %10.1f %10.1f %10.1f", size, plan, forward, inverse);
        if (const auto kiss = kiss_transform(size / 2)) {
            const std::span<const Complex> half(spectrum.data(), size / 2);
            std::vector<Complex> result(size / 2);
            std::printf(" %12.1f", microseconds(repeats, size, [&] { kiss(half, result); }));
        }
        std::printf("\n");
    }
}

}  // namespace bench
