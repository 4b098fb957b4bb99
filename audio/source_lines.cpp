// SPDX-License-Identifier: MIT
#include "earshot/audio/source_lines.h"

#include "earshot/audio/internal/arrival_mixing_kernel.h"
#include "earshot/audio/internal/fft.h"
#include "earshot/audio/internal/short_delay.h"
#include "earshot/audio/partitioned_filter.h"
#include "earshot/base/assert.h"
#include "earshot/base/large_array.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace earshot::audio {

static_assert(kArrivalLatency > kShortDelayLead + 2);

namespace {

// A way may lead through the listener, where the level would be infinite.
constexpr double kMinDistance = 1e-3;  // metres

// Of the signal that one block of an arrival is read from, in blocks: a delay that falls by nearly
// a sample per sample reads two.
constexpr std::size_t kMaxSpan = 2;

}  // namespace

struct SourceLines::State {
    State(const FilterBasis& basis, const Settings& settings)
        : block(settings.block),
          signals(basis.filters()),
          chunks(power_of_two_from(
              (settings.max_delay + (kMaxSpan + 2) * settings.block + 4 * kShortDelayTaps) /
                  kLineChunk +
              2)),
          convolver({.inputs = 1,
                     .outputs = basis.filters() - 1,
                     .block = settings.block,
                     .max_parts = max_parts(basis, settings.block)}),
          numbers(chunks * signals * kLineChunk, 0.0F),
          filtered(std::max<std::size_t>(signals - 1, 1) * settings.block, 0.0F),
          end(static_cast<std::int64_t>(chunks * kLineChunk)) {
        for (std::size_t filter = 1; filter < signals; ++filter) {
            filters.emplace_back(basis.taps(filter), block);
        }
    }

    static std::size_t max_parts(const FilterBasis& basis, std::size_t block) {
        std::size_t parts = 1;
        for (std::size_t filter = 0; filter < basis.filters(); ++filter) {
            parts = std::max(parts, (basis.taps(filter).size() + block - 1) / block);
        }
        return parts;
    }

    ChunkRing ring() const noexcept {
        return {.numbers = numbers.data(), .signals = signals, .mask = chunks - 1};
    }
    /// The first sample that is kept.
    std::int64_t begin() const noexcept {
        return end - static_cast<std::int64_t>(chunks * kLineChunk);
    }

    std::size_t block, signals, chunks;
    std::vector<PartitionedFilter> filters;  // but for that which leaves the signal as it is
    MatrixConvolver convolver;
    LargeArray<float> numbers;
    std::vector<float> filtered;
    std::int64_t end;  // samples so far, and those before the first
};

SourceLines::SourceLines(const FilterBasis& basis, const Settings& settings) {
    EARSHOT_ASSERT(settings.block >= kLineChunk && settings.block % kLineChunk == 0);
    state_ = std::make_unique<State>(basis, settings);
}
SourceLines::~SourceLines() = default;
SourceLines::SourceLines(SourceLines&&) noexcept = default;
SourceLines& SourceLines::operator=(SourceLines&&) noexcept = default;

void SourceLines::push(const float* signal) noexcept {
    State& state = *state_;
    if (state.signals > 1) {
        state.convolver.process(state.filters.data(), signal, state.filtered.data());
    }
    for (std::size_t n = 0; n < state.block; n += kLineChunk) {
        const auto chunk = static_cast<std::size_t>(state.end) / kLineChunk + n / kLineChunk;
        float* numbers = &state.numbers[(chunk & (state.chunks - 1)) * state.signals * kLineChunk];
        std::copy(signal + n, signal + n + kLineChunk, numbers);
        for (std::size_t filter = 1; filter < state.signals; ++filter) {
            const float* filtered = &state.filtered[(filter - 1) * state.block + n];
            std::copy(filtered, filtered + kLineChunk, numbers + filter * kLineChunk);
        }
    }
    state.end += static_cast<std::int64_t>(state.block);
}

namespace {

/// The smallest and the largest of a cubic at 0 ... count.
struct Range {
    double low = 0.0, high = 0.0;
};

Range range_of(const std::array<double, 4>& c, double count) {
    const auto at = [&](double n) { return c[0] + n * (c[1] + n * (c[2] + n * c[3])); };
    Range range{std::min(at(0.0), at(count)), std::max(at(0.0), at(count))};
    const auto include = [&](double n) {
        if (n > 0.0 && n < count) {
            range.low = std::min(range.low, at(n));
            range.high = std::max(range.high, at(n));
        }
    };
    // Where the derivative c1 + 2 c2 n + 3 c3 n^2 is 0.
    const double root = c[2] * c[2] - 3.0 * c[3] * c[1];
    if (root >= 0.0) {
        const double sum = -(c[2] + (c[2] < 0.0 ? -std::sqrt(root) : std::sqrt(root)));
        include(sum / (3.0 * c[3]));
        include(c[1] / sum);
    }
    return range;
}

}  // namespace

struct ArrivalMixer::State {
    std::size_t block = 0;
    double distance_per_sample = 0.0;
    const ShortDelayTable& table = ShortDelayTable::shared();
    std::size_t span = 0;  // samples that are mixed at most
    LargeArray<float> mixed, values;
    std::vector<SignalWeight> weights;
};

ArrivalMixer::ArrivalMixer(std::size_t block, double distance_per_sample)
    : state_(std::make_unique<State>()) {
    constexpr std::size_t kMaxFilters = 256;
    state_->block = block;
    state_->distance_per_sample = distance_per_sample;
    state_->span = kMaxSpan * block + 2 * kShortDelayTaps + 2 * kLineChunk;
    state_->mixed.assign(state_->span + 2 * kLineChunk, 0.0F);
    state_->values.assign(block, 0.0F);
    state_->weights.resize(kMaxFilters);
}
ArrivalMixer::~ArrivalMixer() = default;
ArrivalMixer::ArrivalMixer(ArrivalMixer&&) noexcept = default;
ArrivalMixer& ArrivalMixer::operator=(ArrivalMixer&&) noexcept = default;

bool ArrivalMixer::add(const SourceLines& lines, const MixedArrival& arrival, float* out) noexcept {
    State& state = *state_;
    const SourceLines::State& line = lines.state();
    const std::size_t block = state.block;
    EARSHOT_ASSERT(line.block == block && arrival.weights.size() == line.signals);

    // The part of the lines that is read: positions are `base` + n - delay(n).
    const std::array<double, 4>& delay = arrival.delay;
    const Range relative =
        range_of({-delay[0], 1.0 - delay[1], -delay[2], -delay[3]}, static_cast<double>(block));
    const std::int64_t base = line.end - static_cast<std::int64_t>(block + kArrivalLatency);
    if (!(relative.high <= static_cast<double>(block)) ||
        !(relative.low > -static_cast<double>(line.chunks * kLineChunk)) ||
        !(relative.high - relative.low < static_cast<double>(kMaxSpan * block))) {
        return false;
    }
    constexpr auto kLead = static_cast<std::int64_t>(kShortDelayLead) + 1;
    constexpr auto kChunk = static_cast<std::int64_t>(kLineChunk);
    const std::int64_t first = base + static_cast<std::int64_t>(std::floor(relative.low)) - kLead;
    const std::int64_t last = base + static_cast<std::int64_t>(std::floor(relative.high)) + kLead;
    if (first < line.begin()) {
        return false;
    }
    const std::int64_t first_chunk = first / kChunk;
    const std::int64_t chunks = last / kChunk - first_chunk + 1;

    std::size_t count = 0;
    for (std::size_t filter = 0; filter < line.signals; ++filter) {
        const float weight = arrival.weights[filter];
        const float step = arrival.weight_steps[filter];
        if (weight != 0.0F || step != 0.0F) {
            state.weights[count] = {
                .signal = static_cast<std::uint32_t>(filter), .weight = weight, .step = step};
            ++count;
        }
    }
    const auto begin = static_cast<double>(base - first_chunk * kChunk);
    mix_signals(line.ring(),
                static_cast<std::size_t>(first_chunk),
                static_cast<std::size_t>(chunks),
                state.weights.data(),
                count,
                static_cast<float>(begin - delay[0]),
                state.mixed.data());
    read_delayed(state.mixed.data(),
                 state.table.rows(),
                 begin,
                 {delay[0], delay[1], delay[2], delay[3]},
                 state.distance_per_sample,
                 kMinDistance,
                 block,
                 state.values.data());
    add_to_channels(state.values.data(),
                    block,
                    arrival.gains.data(),
                    arrival.gain_steps.data(),
                    arrival.gains.size(),
                    block,
                    out);
    return true;
}

}  // namespace earshot::audio
