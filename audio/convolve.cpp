// SPDX-License-Identifier: MIT
#include "earshot/audio/convolve.h"

#include "earshot/audio/internal/signal_kernel.h"
#include "earshot/audio/multi_convolver.h"
#include "earshot/base/assert.h"

#include <algorithm>
#include <cmath>

namespace earshot::audio {

namespace {

// Long enough for the transform to pay, short enough that a short filter wastes little.
constexpr std::size_t kBlock = 4096;

std::size_t sample_at(double position) {
    return static_cast<std::size_t>(std::max(0.0, std::ceil(position)));
}

}  // namespace

struct PartitionedConvolver::State {
    MultiConvolver convolver;
};

PartitionedConvolver::PartitionedConvolver(std::span<const double> filter, std::size_t block) {
    EARSHOT_ASSERT(!filter.empty() && block >= 2);
    state_ = std::make_unique<State>(State{MultiConvolver({&filter, 1}, 1, block)});
}

PartitionedConvolver::~PartitionedConvolver() = default;
PartitionedConvolver::PartitionedConvolver(PartitionedConvolver&&) noexcept = default;
PartitionedConvolver& PartitionedConvolver::operator=(PartitionedConvolver&&) noexcept = default;

void PartitionedConvolver::process(std::span<const double> in, std::span<double> out) {
    state_->convolver.process(in, out);
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

std::vector<double> convolve_directly(std::span<const double> signal,
                                      std::span<const double> filter) {
    if (signal.empty() || filter.empty()) {
        return {};
    }
    std::vector<double> taps(filter.size() + 2 * kConvolutionMargin, 0.0);
    std::copy(filter.begin(), filter.end(), taps.begin() + kConvolutionMargin);
    std::vector<double> sum(signal.size() + filter.size() - 1, 0.0);
    add_convolution(
        1.0, signal.data(), signal.size(), &taps[kConvolutionMargin], filter.size(), sum.data());
    return sum;
}

namespace {

/// The samples that go into a filter: some, by a share of each that `share(n)` tells.
template <class Share>
std::vector<double> faded(std::span<const double> signal,
                          std::size_t begin,
                          std::size_t end,
                          const Share& share) {
    std::vector<double> samples;
    for (std::size_t n = begin; n < end; ++n) {
        samples.push_back(signal[n] * share(static_cast<double>(n)));
    }
    return samples;
}

struct Part {
    std::size_t begin = 0;
    std::vector<double> samples;
};

/// The sum of the parts that `part_of(k)` makes for the filters, added in their order.
template <class PartOf>
std::vector<double> sum_of_parts(std::size_t signal_size,
                                 std::span<const std::vector<double>> filters,
                                 const PartOf& part_of,
                                 Executor& executor) {
    std::size_t longest = 0;
    for (const auto& filter : filters) {
        longest = std::max(longest, filter.size());
    }
    if (signal_size == 0 || longest == 0) {
        return {};
    }
    std::vector<Part> parts(filters.size());
    executor.for_each(filters.size(), 1, [&](std::size_t first, std::size_t last) {
        for (std::size_t k = first; k < last; ++k) {
            parts[k] = part_of(k);
            parts[k].samples = convolve(parts[k].samples, filters[k]);
        }
    });
    std::vector<double> sum(signal_size + longest - 1, 0.0);
    for (const Part& part : parts) {
        for (std::size_t n = 0; n < part.samples.size(); ++n) {
            sum[part.begin + n] += part.samples[n];
        }
    }
    return sum;
}

}  // namespace

std::vector<double> convolve_moving(std::span<const double> signal,
                                    std::span<const std::vector<double>> filters,
                                    Executor& executor) {
    EARSHOT_ASSERT(!filters.empty());
    const double share = static_cast<double>(signal.size()) / static_cast<double>(filters.size());
    const auto part_of = [&](std::size_t k) {
        const double middle = (static_cast<double>(k) + 0.5) * share;
        const bool is_first = k == 0;
        const bool is_last = k + 1 == filters.size();
        const auto begin = is_first ? std::size_t{0} : sample_at(middle - share);
        const auto end =
            is_last ? signal.size() : std::min(signal.size(), sample_at(middle + share) + 1);
        return Part{begin, faded(signal, begin, end, [&](double n) {
                        const double away = (n - middle) / share;
                        const bool is_alone = (is_first && away < 0.0) || (is_last && away > 0.0);
                        return is_alone ? 1.0 : std::max(0.0, 1.0 - std::abs(away));
                    })};
    };
    return sum_of_parts(signal.size(), filters, part_of, executor);
}

std::vector<double> convolve_moving(std::span<const double> signal,
                                    std::span<const std::vector<double>> filters,
                                    std::span<const double> places,
                                    Executor& executor) {
    EARSHOT_ASSERT(!filters.empty() && places.size() == filters.size());
    const auto part_of = [&](std::size_t k) {
        const double place = places[k];
        const bool is_first = k == 0;
        const bool is_last = k + 1 == filters.size();
        const auto begin =
            is_first ? std::size_t{0} : std::min(signal.size(), sample_at(places[k - 1]));
        const auto end =
            is_last ? signal.size() : std::min(signal.size(), sample_at(places[k + 1]) + 1);
        return Part{
            begin, faded(signal, begin, end, [&](double n) {
                if (n < place) {
                    return is_first ? 1.0 : (n - places[k - 1]) / (place - places[k - 1]);
                }
                return is_last ? 1.0 : std::max(0.0, (places[k + 1] - n) / (places[k + 1] - place));
            })};
    };
    return sum_of_parts(signal.size(), filters, part_of, executor);
}

}  // namespace earshot::audio
