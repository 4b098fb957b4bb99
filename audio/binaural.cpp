// SPDX-License-Identifier: MIT
#include "earshot/audio/binaural.h"

#include "earshot/audio/internal/fractional_delay.h"
#include "earshot/audio/internal/response_assembly.h"
#include "earshot/audio/internal/signal_kernel.h"
#include "earshot/base/assert.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace earshot::audio {

namespace {

// Arrivals whose impulses at the ears are kept at a time: some 50 MiB.
constexpr std::size_t kArrivalsPerStep = 4096;

// The longest impulse is taken for a multiple of this, so that blocks seldom depend on which
// arrivals there are.
constexpr std::size_t kTapsUnit = 256;

/// The impulse of one arrival at both ears.
struct EarImpulse {
    ImpulsePlace place{};
    std::vector<double> taps{};  // left, right
};

class EarImpulses final : public ArrivalImpulses {
public:
    explicit EarImpulses(std::span<const EarImpulse> impulses) : impulses_(impulses) {
        for (const EarImpulse& impulse : impulses_) {
            earliest_ = std::min(earliest_, impulse.place.begin);
            max_taps_ = std::max(max_taps_, impulse.place.taps);
        }
        max_taps_ = (max_taps_ + kTapsUnit - 1) / kTapsUnit * kTapsUnit;
    }

    std::size_t channels() const noexcept override { return 2; }
    std::size_t shapes() const noexcept override { return 2; }
    std::ptrdiff_t earliest() const noexcept override { return earliest_; }
    std::size_t max_taps() const noexcept override { return max_taps_; }
    ImpulsePlace place(std::size_t arrival) const override { return impulses_[arrival].place; }
    void write(std::size_t arrival, std::span<double> taps) const override {
        std::copy(impulses_[arrival].taps.begin(), impulses_[arrival].taps.end(), taps.begin());
    }
    double gain(std::size_t, std::size_t) const override { return 1.0; }
    std::optional<double> fraction(std::size_t) const override { return std::nullopt; }

private:
    std::span<const EarImpulse> impulses_;
    std::ptrdiff_t earliest_ = 0;
    std::size_t max_taps_ = 0;
};

/// Nothing if no response is heard from there. An impulse begins before its time.
EarImpulse impulse_of(const AssemblyTables& tables,
                      const Arrival& arrival,
                      const HrirInterpolator& hrirs,
                      const Orientation& orientation) {
    std::array<double, 3> towards = origin_seen_from(orientation, arrival);
    if (towards == std::array<double, 3>{}) {
        towards = {1.0, 0.0, 0.0};
    }
    const InterpolatedHrir hrir = hrirs.at(towards);
    const std::size_t size = hrir.ears[0].size();
    if (size == 0) {
        return {};
    }
    const double position = arrival.delay * tables.sample_rate;
    std::array<double, kDelayTaps + 2 * kConvolutionMargin> delay{};
    tables.delays.impulse(position - std::floor(position),
                          std::span(delay).subspan<kConvolutionMargin, kDelayTaps>());
    const auto lead = static_cast<std::ptrdiff_t>(kDelayHalfLength - 1);
    EarImpulse impulse;
    impulse.place = {.begin = static_cast<std::ptrdiff_t>(position) - lead + hrir.begin,
                     .taps = size + kDelayTaps - 1};
    impulse.taps.assign(2 * impulse.place.taps, 0.0);
    for (std::size_t ear = 0; ear < 2; ++ear) {
        add_convolution(1.0,
                        hrir.ears[ear].data(),
                        size,
                        &delay[kConvolutionMargin],
                        kDelayTaps,
                        &impulse.taps[ear * impulse.place.taps]);
    }
    return impulse;
}

/// Adds the arrivals of a step, making the ears as long as they need unless their length is fixed.
void add_step(const Assembler& assembler,
              std::span<const Arrival> arrivals,
              const HrirInterpolator& hrirs,
              const Orientation& orientation,
              bool fixed_length,
              std::span<ImpulseResponse> ears,
              Executor& executor) {
    const AssemblyTables& tables = assembler.tables();
    std::vector<EarImpulse> impulses(arrivals.size());
    executor.for_each(arrivals.size(), 4, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const double position = arrivals[i].delay * tables.sample_rate;
            if (!tables.silent(arrivals[i]) && position < kMaxSamples) {
                impulses[i] = impulse_of(tables, arrivals[i], hrirs, orientation);
            }
        }
    });
    std::vector<std::size_t> heard;
    std::size_t size = ears[0].samples.size();
    for (std::size_t i = 0; i < arrivals.size(); ++i) {
        if (!impulses[i].taps.empty()) {
            // To the end of the filter's ringing.
            const std::ptrdiff_t end = impulses[i].place.begin +
                                       static_cast<std::ptrdiff_t>(impulses[i].place.taps) +
                                       static_cast<std::ptrdiff_t>(tables.filter.fft().size()) -
                                       static_cast<std::ptrdiff_t>(kDelayHalfLength);
            heard.push_back(i);
            size = std::max(size, static_cast<std::size_t>(std::max<std::ptrdiff_t>(end, 0)));
        }
    }
    if (!fixed_length) {
        ears[0].samples.resize(size, 0.0);
        ears[1].samples.resize(size, 0.0);
    }
    const EarImpulses of_ears(impulses);
    ResponseAssembly(tables, arrivals, of_ears).add(heard, ears, executor);
}

}  // namespace

std::array<ImpulseResponse, 2> render_binaural(const Assembler& assembler,
                                               std::span<const Arrival> arrivals,
                                               const HrirInterpolator& hrirs,
                                               const Orientation& orientation,
                                               double length,
                                               Executor& executor) {
    const ImpulseResponse silence = assembler.assemble({}, length);
    EARSHOT_ASSERT(silence.sample_rate == hrirs.sample_rate());
    check_arrivals(arrivals);
    for (const Arrival& arrival : arrivals) {
        if (!(length > 0.0) && !assembler.tables().silent(arrival)) {
            checked_response_size(arrival.delay * silence.sample_rate);
        }
    }
    std::array<ImpulseResponse, 2> ears{silence, silence};
    for (std::size_t first = 0; first < arrivals.size(); first += kArrivalsPerStep) {
        const std::size_t count = std::min(kArrivalsPerStep, arrivals.size() - first);
        add_step(assembler,
                 arrivals.subspan(first, count),
                 hrirs,
                 orientation,
                 length > 0.0,
                 ears,
                 executor);
    }
    return ears;
}

}  // namespace earshot::audio
