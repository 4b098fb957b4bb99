// SPDX-License-Identifier: MIT
#include "earshot/audio/multi_convolver.h"

#include "earshot/audio/internal/fft.h"
#include "earshot/audio/internal/signal_kernel.h"
#include "earshot/base/assert.h"
#include "earshot/base/large_array.h"

#include <algorithm>
#include <complex>
#include <vector>

namespace earshot::audio {

namespace {

using Complex = std::complex<double>;

double* numbers(Complex* values) {
    // std::complex<double> is laid out as two doubles ([complex.numbers]/4).
    return reinterpret_cast<double*>(values);
}

/// What is kept of a filter: the spectra of its parts, and of each channel's windows so far.
struct KeptFilter {
    std::size_t parts = 0;
    std::size_t newest = 0;           // of the windows, which are a ring
    LargeArray<Complex> spectra;      // row per part
    LargeArray<Complex> windows;      // per channel, row per part
    std::vector<double> last_blocks;  // of each channel
};

}  // namespace

struct MultiConvolver::State {
    State(std::span<const std::span<const double>> taps, std::size_t the_channels, std::size_t size)
        : block(size),
          channels(the_channels),
          fft(2 * size),
          sum(the_channels * stride()),
          window(fft.size(), 0.0) {
        for (const std::span<const double> filter : taps) {
            add_filter(filter);
        }
    }

    std::size_t stride() const noexcept { return padded(fft.bins()); }
    void add_filter(std::span<const double> taps);
    void add_signal(KeptFilter& filter, std::size_t channel, std::span<const double> in) noexcept;

    std::size_t block, channels;
    RealFft fft;
    std::vector<KeptFilter> filters;
    LargeArray<Complex> sum;  // row per channel
    std::vector<double> window;
    FftWorkspace workspace;
};

void MultiConvolver::State::add_filter(std::span<const double> taps) {
    EARSHOT_ASSERT(!taps.empty());
    KeptFilter& filter = filters.emplace_back();
    filter.parts = (taps.size() + block - 1) / block;
    filter.spectra.assign(filter.parts * stride(), Complex());
    for (std::size_t part = 0; part < filter.parts; ++part) {
        const auto some = taps.subspan(part * block, std::min(block, taps.size() - part * block));
        std::fill(window.begin(), window.end(), 0.0);
        std::copy(some.begin(), some.end(), window.begin());
        // Also brings the workspace to its size.
        fft.forward(
            window, std::span(filter.spectra).subspan(part * stride(), fft.bins()), workspace);
    }
    filter.windows.assign(channels * filter.parts * stride(), Complex());
    filter.last_blocks.assign(channels * block, 0.0);
}

void MultiConvolver::State::add_signal(KeptFilter& filter,
                                       std::size_t channel,
                                       std::span<const double> in) noexcept {
    Complex* windows = &filter.windows[channel * filter.parts * stride()];
    // A window is the block before and this one.
    const auto last = std::span(filter.last_blocks).subspan(channel * block, block);
    std::copy(last.begin(), last.end(), window.begin());
    std::copy(in.begin(), in.end(), window.begin() + static_cast<std::ptrdiff_t>(block));
    std::copy(in.begin(), in.end(), last.begin());
    fft.forward(window, std::span(windows + filter.newest * stride(), fft.bins()), workspace);
    for (std::size_t part = 0; part < filter.parts; ++part) {
        const std::size_t place = (filter.newest + part) % filter.parts;
        add_product(numbers(&filter.spectra[part * stride()]),
                    numbers(windows + place * stride()),
                    stride(),
                    numbers(&sum[channel * stride()]));
    }
}

MultiConvolver::MultiConvolver(std::span<const std::span<const double>> filters,
                               std::size_t channels,
                               std::size_t block)
    : state_(std::make_unique<State>(filters, channels, block)) {}

MultiConvolver::~MultiConvolver() = default;
MultiConvolver::MultiConvolver(MultiConvolver&&) noexcept = default;
MultiConvolver& MultiConvolver::operator=(MultiConvolver&&) noexcept = default;

std::size_t MultiConvolver::block() const noexcept {
    return state_->block;
}

std::size_t MultiConvolver::channels() const noexcept {
    return state_->channels;
}

std::size_t MultiConvolver::signals() const noexcept {
    return state_->filters.size() * state_->channels;
}

void MultiConvolver::process(std::span<const double> in, std::span<double> out) noexcept {
    State& state = *state_;
    const std::size_t block = state.block;
    EARSHOT_ASSERT(in.size() == signals() * block && out.size() == channels() * block);
    std::fill(state.sum.begin(), state.sum.end(), Complex());
    std::size_t signal = 0;
    for (KeptFilter& filter : state.filters) {
        filter.newest = (filter.newest + filter.parts - 1) % filter.parts;
        for (std::size_t channel = 0; channel < state.channels; ++channel) {
            state.add_signal(filter, channel, in.subspan(signal * block, block));
            ++signal;
        }
    }
    for (std::size_t channel = 0; channel < state.channels; ++channel) {
        state.fft.inverse(std::span(state.sum).subspan(channel * state.stride(), state.fft.bins()),
                          state.window,
                          state.workspace);
        // The first half is wrapped around.
        std::copy(state.window.begin() + static_cast<std::ptrdiff_t>(block),
                  state.window.end(),
                  out.begin() + static_cast<std::ptrdiff_t>(channel * block));
    }
}

}  // namespace earshot::audio
