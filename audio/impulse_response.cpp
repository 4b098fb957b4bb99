// SPDX-License-Identifier: MIT
#include "earshot/audio/impulse_response.h"

#include "earshot/audio/internal/fractional_delay.h"
#include "earshot/audio/internal/response_assembly.h"
#include "earshot/base/assert.h"
#include "earshot/base/error.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace earshot::audio {

namespace {

constexpr double kLowestSampleRate = 1000.0;
constexpr double kHighestSampleRate = 768000.0;

double checked_sample_rate(double sample_rate) {
    if (!(sample_rate >= kLowestSampleRate && sample_rate <= kHighestSampleRate)) {
        throw Error("sample rate",
                    "must lie in 1000 ... 768000 Hz, not " + std::to_string(sample_rate),
                    "48000 is usual");
    }
    return sample_rate;
}

std::size_t response_samples(const AssemblyTables& tables,
                             std::span<const Arrival> arrivals,
                             double length) {
    if (!(length >= 0.0)) {
        throw Error("response length", "cannot be negative", "use 0 for as long as needed");
    }
    if (length > 0.0) {
        return checked_response_size(std::ceil(length * tables.sample_rate));
    }
    double last_delay = -1.0;
    for (const Arrival& arrival : arrivals) {
        if (!tables.silent(arrival)) {
            last_delay = std::max(last_delay, arrival.delay);
        }
    }
    if (last_delay < 0.0) {
        return checked_response_size(std::ceil(kSilenceLength * tables.sample_rate));
    }
    const auto ringing = static_cast<double>(tables.filter.fft().size());
    return checked_response_size(std::floor(last_delay * tables.sample_rate) + ringing);
}

constexpr std::size_t kLead = kDelayHalfLength - 1;

/// Impulses at the arrivals' delays. Those that would begin before sample 0 of the response are the
/// allpass filter's from there on.
class PointImpulses final : public ArrivalImpulses {
public:
    PointImpulses(const AssemblyTables& tables,
                  std::span<const Arrival> arrivals,
                  std::span<const double> gains,
                  std::size_t channels)
        : tables_(tables), arrivals_(arrivals), gains_(gains), channels_(channels) {}

    std::size_t channels() const noexcept override { return channels_; }
    std::size_t shapes() const noexcept override { return 1; }
    std::ptrdiff_t earliest() const noexcept override {
        return -static_cast<std::ptrdiff_t>(kLead);
    }
    std::size_t max_taps() const noexcept override { return kAllpassTaps; }

    ImpulsePlace place(std::size_t arrival) const override {
        if (has_no_room(arrival)) {
            return {.begin = 0, .taps = kAllpassTaps};
        }
        const auto whole = static_cast<std::ptrdiff_t>(std::floor(position(arrival)));
        return {.begin = whole - static_cast<std::ptrdiff_t>(kLead), .taps = kDelayTaps};
    }

    void write(std::size_t arrival, std::span<double> taps) const override {
        if (has_no_room(arrival)) {
            const auto impulse = allpass_impulse(position(arrival));
            std::copy(impulse.begin(), impulse.end(), taps.begin());
        } else {
            tables_.delays.impulse(fraction_of(arrival), taps.first<kDelayTaps>());
        }
    }

    double gain(std::size_t arrival, std::size_t channel) const override {
        return gains_[arrival * channels_ + channel];
    }

    std::optional<double> fraction(std::size_t arrival) const override {
        return has_no_room(arrival) ? std::nullopt : std::optional(fraction_of(arrival));
    }

private:
    double position(std::size_t arrival) const {
        return arrivals_[arrival].delay * tables_.sample_rate;
    }
    double fraction_of(std::size_t arrival) const {
        return position(arrival) - std::floor(position(arrival));
    }
    bool has_no_room(std::size_t arrival) const {
        return position(arrival) < static_cast<double>(kLead) && fraction_of(arrival) > 0.0;
    }

    const AssemblyTables& tables_;
    std::span<const Arrival> arrivals_;
    std::span<const double> gains_;
    std::size_t channels_;
};

}  // namespace

Assembler::Assembler(const Bands& bands, double sample_rate)
    : tables_(std::make_unique<const AssemblyTables>(bands, checked_sample_rate(sample_rate))) {}
Assembler::~Assembler() = default;
Assembler::Assembler(Assembler&&) noexcept = default;
Assembler& Assembler::operator=(Assembler&&) noexcept = default;

ImpulseResponse Assembler::assemble(std::span<const Arrival> arrivals,
                                    double length,
                                    Executor& executor) const {
    const std::vector<double> gains(arrivals.size(), 1.0);
    return std::move(assemble_channels(arrivals, gains, 1, length, executor).front());
}

std::vector<ImpulseResponse> Assembler::assemble_channels(std::span<const Arrival> arrivals,
                                                          std::span<const double> gains,
                                                          std::size_t channels,
                                                          double length,
                                                          Executor& executor) const {
    EARSHOT_ASSERT(gains.size() == arrivals.size() * channels);
    check_arrivals(arrivals);
    if (!std::all_of(gains.begin(), gains.end(), [](double g) { return std::isfinite(g); })) {
        throw Error("arrivals", "a direction is not finite", "check the scene's coordinates");
    }
    const std::size_t size = response_samples(*tables_, arrivals, length);
    const ImpulseResponse silence{tables_->sample_rate, std::vector<double>(size)};
    std::vector<ImpulseResponse> results(channels, silence);

    std::vector<std::size_t> heard;
    for (std::size_t i = 0; i < arrivals.size(); ++i) {
        if (!tables_->silent(arrivals[i]) &&
            arrivals[i].delay * tables_->sample_rate < static_cast<double>(size)) {
            heard.push_back(i);
        }
    }
    const PointImpulses impulses(*tables_, arrivals, gains, channels);
    ResponseAssembly(*tables_, arrivals, impulses).add(heard, results, executor);
    return results;
}

ImpulseResponse assemble(const Bands& bands,
                         std::span<const Arrival> arrivals,
                         const ResponseOptions& options,
                         Executor& executor) {
    return Assembler(bands, options.sample_rate).assemble(arrivals, options.length, executor);
}

}  // namespace earshot::audio
