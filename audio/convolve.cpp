// SPDX-License-Identifier: MIT
#include "earshot/audio/convolve.h"

#include "earshot/audio/internal/fft.h"
#include "earshot/base/assert.h"

#include <algorithm>
#include <cmath>
#include <complex>

namespace earshot::audio {

namespace {

using Complex = std::complex<double>;

// Long enough for the transform to pay, short enough that a short filter wastes little.
constexpr std::size_t kBlock = 4096;

std::size_t sample_at(double position) {
    return static_cast<std::size_t>(std::max(0.0, std::ceil(position)));
}

}  // namespace

struct PartitionedConvolver::State {
    State(std::span<const double> filter, std::size_t the_block)
        : block(the_block), fft(2 * the_block), window(fft.size(), 0.0), result(fft.size()) {
        for (std::size_t begin = 0; begin < filter.size(); begin += block) {
            std::vector<double> part(fft.size(), 0.0);
            const std::size_t end = std::min(begin + block, filter.size());
            std::copy(filter.begin() + static_cast<std::ptrdiff_t>(begin),
                      filter.begin() + static_cast<std::ptrdiff_t>(end),
                      part.begin());
            fft.forward(part, parts.emplace_back(fft.bins()));
        }
        past.assign(parts.size(), std::vector<Complex>(fft.bins()));
        sum.resize(fft.bins());
    }

    std::size_t block;
    RealFft fft;
    std::vector<std::vector<Complex>> parts;  // spectra of the filter's parts
    std::vector<std::vector<Complex>> past;   // spectra of the windows so far, a ring
    std::size_t newest = 0;
    std::vector<double> window;  // the block before and this one
    std::vector<double> result;
    std::vector<Complex> sum;
};

PartitionedConvolver::PartitionedConvolver(std::span<const double> filter, std::size_t block) {
    EARSHOT_ASSERT(!filter.empty() && block >= 2);
    state_ = std::make_unique<State>(filter, block);
}

PartitionedConvolver::~PartitionedConvolver() = default;
PartitionedConvolver::PartitionedConvolver(PartitionedConvolver&&) noexcept = default;
PartitionedConvolver& PartitionedConvolver::operator=(PartitionedConvolver&&) noexcept = default;

void PartitionedConvolver::process(std::span<const double> in, std::span<double> out) {
    State& state = *state_;
    EARSHOT_ASSERT(in.size() == state.block && out.size() == state.block);
    const auto half = static_cast<std::ptrdiff_t>(state.block);
    std::copy(state.window.begin() + half, state.window.end(), state.window.begin());
    std::copy(in.begin(), in.end(), state.window.begin() + half);
    const std::size_t count = state.parts.size();
    state.newest = (state.newest + count - 1) % count;
    state.fft.forward(state.window, state.past[state.newest]);
    std::fill(state.sum.begin(), state.sum.end(), Complex());
    for (std::size_t k = 0; k < count; ++k) {
        const auto& part = state.parts[k];
        const auto& window = state.past[(state.newest + k) % count];
        for (std::size_t bin = 0; bin < part.size(); ++bin) {
            // Written out, because the operator looks for infinities.
            const double re =
                part[bin].real() * window[bin].real() - part[bin].imag() * window[bin].imag();
            const double im =
                part[bin].real() * window[bin].imag() + part[bin].imag() * window[bin].real();
            state.sum[bin] += Complex(re, im);
        }
    }
    state.fft.inverse(state.sum, state.result);
    // The first half is wrapped around.
    std::copy(state.result.begin() + half, state.result.end(), out.begin());
}

std::vector<double> convolve(std::span<const double> signal, std::span<const double> filter) {
    if (signal.empty() || filter.empty()) {
        return {};
    }
    const std::size_t size = signal.size() + filter.size() - 1;
    PartitionedConvolver convolver(filter, kBlock);
    std::vector<double> out((size + kBlock - 1) / kBlock * kBlock);
    std::vector<double> in(kBlock);
    for (std::size_t begin = 0; begin < out.size(); begin += kBlock) {
        std::fill(in.begin(), in.end(), 0.0);
        if (begin < signal.size()) {
            const auto some = signal.subspan(begin, std::min(kBlock, signal.size() - begin));
            std::copy(some.begin(), some.end(), in.begin());
        }
        convolver.process(in, std::span(out).subspan(begin, kBlock));
    }
    out.resize(size);
    return out;
}

std::vector<double> convolve_moving(std::span<const double> signal,
                                    std::span<const std::vector<double>> filters,
                                    Executor& executor) {
    EARSHOT_ASSERT(!filters.empty());
    std::size_t longest = 0;
    for (const auto& filter : filters) {
        longest = std::max(longest, filter.size());
    }
    if (signal.empty() || longest == 0) {
        return {};
    }
    const double share = static_cast<double>(signal.size()) / static_cast<double>(filters.size());
    struct Part {
        std::size_t begin = 0;
        std::vector<double> samples;
    };
    std::vector<Part> parts(filters.size());
    executor.for_each(filters.size(), 1, [&](std::size_t first, std::size_t last) {
        for (std::size_t k = first; k < last; ++k) {
            const double middle = (static_cast<double>(k) + 0.5) * share;
            const bool is_first = k == 0;
            const bool is_last = k + 1 == filters.size();
            const auto begin = is_first ? std::size_t{0} : sample_at(middle - share);
            const auto end =
                is_last ? signal.size() : std::min(signal.size(), sample_at(middle + share) + 1);
            std::vector<double> faded;
            for (std::size_t n = begin; n < end; ++n) {
                const double away = (static_cast<double>(n) - middle) / share;
                const bool is_alone = (is_first && away < 0.0) || (is_last && away > 0.0);
                faded.push_back(signal[n] * (is_alone ? 1.0 : std::max(0.0, 1.0 - std::abs(away))));
            }
            parts[k] = {begin, convolve(faded, filters[k])};
        }
    });
    std::vector<double> sum(signal.size() + longest - 1, 0.0);
    for (const Part& part : parts) {
        for (std::size_t n = 0; n < part.samples.size(); ++n) {
            sum[part.begin + n] += part.samples[n];
        }
    }
    return sum;
}

}  // namespace earshot::audio
