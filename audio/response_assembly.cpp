// SPDX-License-Identifier: MIT
#include "earshot/audio/internal/response_assembly.h"

#include "earshot/audio/internal/signal_kernel.h"
#include "earshot/base/error.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <string>

namespace earshot::audio {

namespace {

// Blocks that are assembled before they are added up, in order: bounds the memory of a step.
constexpr std::size_t kBlocksPerStep = 16;

/// None if the one of the tables has the right size.
std::optional<RealFft> fft_for(const AssemblyTables& tables, std::size_t taps) {
    const std::size_t size = block_transform_size(tables.filter.fft().size(), taps);
    return size == tables.block_fft.size() ? std::nullopt : std::optional<RealFft>(size);
}

void add_block(std::span<const double> sum, std::ptrdiff_t begin, std::span<double> samples) {
    const auto skipped = static_cast<std::size_t>(std::max<std::ptrdiff_t>(-begin, 0));
    const auto first = static_cast<std::size_t>(std::max<std::ptrdiff_t>(begin, 0));
    if (first < samples.size() && skipped < sum.size()) {
        const std::size_t count = std::min(sum.size() - skipped, samples.size() - first);
        add_scaled(1.0, &sum[skipped], count, &samples[first]);
    }
}

}  // namespace

void check_arrivals(std::span<const Arrival> arrivals) {
    for (const Arrival& arrival : arrivals) {
        constexpr double kMax = std::numeric_limits<double>::max();
        bool sound = arrival.delay >= 0.0 && arrival.delay <= kMax;
        for (const double pressure : arrival.pressure) {
            sound = sound & (pressure >= 0.0) & (pressure <= kMax);  // without a branch per band
        }
        if (!sound) {
            throw Error("arrivals",
                        "a delay or a pressure is negative or not finite",
                        "check the scene's coordinates");
        }
    }
}

std::size_t checked_response_size(double samples) {
    if (!(samples < kMaxSamples)) {
        throw Error("response length",
                    "more than 2^31 samples (" + std::to_string(samples) + ")",
                    "use a shorter response or a lower sample rate");
    }
    return std::max(std::size_t{1}, static_cast<std::size_t>(samples));
}

std::size_t block_transform_size(std::size_t filter_size, std::size_t taps) {
    std::size_t size = 2 * filter_size;
    while (size < filter_size + taps + size / 4) {
        size *= 2;
    }
    return size;
}

AssemblyTables::AssemblyTables(const Bands& bands, double rate)
    : sample_rate(rate),
      filter(bands, rate),
      nodes(filter),
      piece_fft(fft_size_from(filter.fft().size() + kDelayTaps)),
      block_fft(block_transform_size(filter.fft().size(), kAllpassTaps)),
      delay_spectrum(piece_fft) {}

bool AssemblyTables::silent(const Arrival& arrival) const {
    const auto used = std::span(arrival.pressure).first(filter.bands_in_use());
    return *std::max_element(used.begin(), used.end()) == 0.0;
}

bool AssemblyTables::flat(const Arrival& arrival) const {
    const auto used = std::span(arrival.pressure).first(filter.bands_in_use());
    return std::all_of(used.begin(), used.end(), [&](double p) { return p == used[0]; });
}

ResponseAssembly::ResponseAssembly(const AssemblyTables& tables,
                                   std::span<const Arrival> arrivals,
                                   const ArrivalImpulses& impulses)
    : tables_(tables),
      arrivals_(arrivals),
      impulses_(impulses),
      own_fft_(fft_for(tables, impulses.max_taps())),
      fft_(own_fft_ ? *own_fft_ : tables.block_fft),
      block_samples_((fft_.size() - tables.filter.fft().size() - impulses.max_taps()) / kLanes *
                     kLanes) {}

std::vector<ArrivalBlock> ResponseAssembly::blocks_of(std::span<const std::size_t> heard) const {
    std::map<std::size_t, ArrivalBlock> blocks;
    const std::ptrdiff_t earliest = impulses_.earliest();
    for (const std::size_t arrival : heard) {
        const auto after = static_cast<std::size_t>(impulses_.place(arrival).begin - earliest);
        const std::size_t index = after / block_samples_;
        ArrivalBlock& block = blocks[index];
        block.begin = earliest + static_cast<std::ptrdiff_t>(index * block_samples_);
        block.arrivals.push_back(arrival);
    }
    std::vector<ArrivalBlock> result;
    for (auto& [index, block] : blocks) {
        result.push_back(std::move(block));
    }
    return result;
}

void ResponseAssembly::add(std::span<const std::size_t> heard,
                           std::span<ImpulseResponse> channels,
                           Executor& executor) const {
    const std::vector<ArrivalBlock> blocks = blocks_of(heard);
    const std::size_t sum_size = channels.size() * fft_.size();
    std::vector<LargeArray<double>> sums(std::min(kBlocksPerStep, blocks.size()));
    for (std::size_t first = 0; first < blocks.size(); first += kBlocksPerStep) {
        const std::size_t count = std::min(kBlocksPerStep, blocks.size() - first);
        executor.for_each(count, 1, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                tables_.workspaces.with([&](BlockWorkspace& work) {
                    sums[i].resize(sum_size);
                    BlockAssembly(tables_, arrivals_, impulses_, fft_, blocks[first + i], work)
                        .assemble(sums[i]);
                });
            }
        });
        executor.for_each(channels.size(), 1, [&](std::size_t begin, std::size_t end) {
            for (std::size_t channel = begin; channel < end; ++channel) {
                for (std::size_t i = 0; i < count; ++i) {
                    const auto sum = std::span(sums[i]).subspan(channel * fft_.size(), fft_.size());
                    add_block(sum, blocks[first + i].begin, channels[channel].samples);
                }
            }
        });
    }
}

}  // namespace earshot::audio
