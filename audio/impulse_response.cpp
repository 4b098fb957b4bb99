// SPDX-License-Identifier: MIT
#include "earshot/audio/impulse_response.h"

#include "earshot/audio/internal/arrival_filter.h"
#include "earshot/audio/internal/fractional_delay.h"
#include "earshot/base/assert.h"
#include "earshot/base/error.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace earshot::audio {

namespace {

using Complex = std::complex<double>;

constexpr double kLowestSampleRate = 1000.0;
constexpr double kHighestSampleRate = 768000.0;
constexpr double kMaxSamples = 2147483648.0;  // 2^31

// Arrivals that are filtered before they are added up, in order: bounds the memory of a step (64
// filters of 4,096 samples are 2 MiB) and gives every thread work.
constexpr std::size_t kArrivalsPerStep = 64;

double checked_sample_rate(double sample_rate) {
    if (!(sample_rate >= kLowestSampleRate && sample_rate <= kHighestSampleRate)) {
        throw Error("sample rate",
                    "must lie in 1000 ... 768000 Hz, not " + std::to_string(sample_rate),
                    "48000 is usual");
    }
    return sample_rate;
}

// As a whole number, from a number of samples that may be anything but NaN.
std::size_t checked_size(double samples) {
    if (!(samples < kMaxSamples)) {
        throw Error("response length",
                    "more than 2^31 samples (" + std::to_string(samples) + ")",
                    "use a shorter response or a lower sample rate");
    }
    return std::max(std::size_t{1}, static_cast<std::size_t>(samples));
}

void check_arrivals(std::span<const Arrival> arrivals) {
    for (const Arrival& arrival : arrivals) {
        bool sound = std::isfinite(arrival.delay) && arrival.delay >= 0.0;
        for (const double pressure : arrival.pressure) {
            sound = sound && std::isfinite(pressure) && pressure >= 0.0;
        }
        if (!sound) {
            throw Error("arrivals",
                        "a delay or a pressure is negative or not finite",
                        "check the scene's coordinates");
        }
    }
}

}  // namespace

struct Assembler::Impl {
    Impl(const Bands& bands, double rate) : sample_rate(rate), filter(bands, rate) {}

    bool silent(const Arrival& arrival) const;
    bool flat(const Arrival& arrival) const;
    std::size_t response_samples(std::span<const Arrival> arrivals, double length) const;
    void place_impulse(double position, std::span<double> piece) const;
    void render(const Arrival& arrival, std::span<double> piece) const;
    void add(const Arrival& arrival,
             double gain,
             std::span<const double> piece,
             std::span<double> sum) const;

    double sample_rate;
    ArrivalFilter filter;
};

bool Assembler::Impl::silent(const Arrival& arrival) const {
    const auto used = std::span(arrival.pressure).first(filter.bands_in_use());
    return *std::max_element(used.begin(), used.end()) == 0.0;
}

bool Assembler::Impl::flat(const Arrival& arrival) const {
    const auto used = std::span(arrival.pressure).first(filter.bands_in_use());
    return std::all_of(used.begin(), used.end(), [&](double p) { return p == used[0]; });
}

std::size_t Assembler::Impl::response_samples(std::span<const Arrival> arrivals,
                                              double length) const {
    if (!(length >= 0.0)) {
        throw Error("response length", "cannot be negative", "use 0 for as long as needed");
    }
    if (length > 0.0) {
        return checked_size(std::ceil(length * sample_rate));
    }
    double last_delay = -1.0;
    for (const Arrival& arrival : arrivals) {
        if (!silent(arrival)) {
            last_delay = std::max(last_delay, arrival.delay);
        }
    }
    if (last_delay < 0.0) {
        return checked_size(std::ceil(kSilenceLength * sample_rate));
    }
    const auto ringing = static_cast<double>(filter.fft().size());
    return checked_size(std::floor(last_delay * sample_rate) + ringing);
}

// An impulse at the arrival's delay: piece[kDelayHalfLength - 1] is the whole sample at or before
// it. One that would begin before sample 0 of the response is an allpass filter's from there on.
void Assembler::Impl::place_impulse(double position, std::span<double> piece) const {
    constexpr auto kLead = static_cast<double>(kDelayHalfLength - 1);
    const double whole = std::floor(position);
    std::fill(piece.begin(), piece.end(), 0.0);
    if (whole < kLead && position > whole) {
        const auto impulse = allpass_impulse(position);
        const auto begin = static_cast<std::ptrdiff_t>(kLead - whole);
        std::copy(impulse.begin(), impulse.end(), piece.begin() + begin);
    } else {
        const auto impulse = fractional_impulse(position - whole);
        std::copy(impulse.begin(), impulse.end(), piece.begin());
    }
}

// The arrival's filter, delayed by the fraction of its first sample. What the filter still has past
// the end of `piece` (docs/algorithms/audio.md gives figures) wraps round to its beginning.
void Assembler::Impl::render(const Arrival& arrival, std::span<double> piece) const {
    place_impulse(arrival.delay * sample_rate, piece);
    if (flat(arrival)) {
        for (double& sample : piece.first(kDelayHalfLength + kAllpassTaps)) {
            sample *= arrival.pressure[0];
        }
        return;
    }
    std::vector<Complex> spectrum(filter.fft().bins());
    std::vector<Complex> response(filter.fft().bins());
    filter.fft().forward(piece, spectrum);
    filter.response(arrival.pressure, response);
    for (std::size_t k = 0; k < spectrum.size(); ++k) {
        const Complex a = spectrum[k];
        const Complex b = response[k];
        spectrum[k] = {a.real() * b.real() - a.imag() * b.imag(),
                       a.real() * b.imag() + a.imag() * b.real()};
    }
    filter.fft().inverse(spectrum, piece);
}

void Assembler::Impl::add(const Arrival& arrival,
                          double gain,
                          std::span<const double> piece,
                          std::span<double> sum) const {
    const double position = std::floor(arrival.delay * sample_rate);
    if (position >= static_cast<double>(sum.size())) {
        return;
    }
    // Sample 0 of the response is sample `skipped` of the piece, or the piece begins after it.
    const auto centre = static_cast<std::size_t>(position);
    const std::size_t lead = kDelayHalfLength - 1;
    const std::size_t begin = centre > lead ? centre - lead : 0;
    const std::size_t skipped = centre > lead ? 0 : lead - centre;
    const std::size_t count = std::min(piece.size() - skipped, sum.size() - begin);
    for (std::size_t n = 0; n < count; ++n) {
        sum[begin + n] += gain * piece[skipped + n];
    }
}

Assembler::Assembler(const Bands& bands, double sample_rate)
    : impl_(std::make_unique<const Impl>(bands, checked_sample_rate(sample_rate))) {}
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
    const std::size_t size = impl_->response_samples(arrivals, length);
    const ImpulseResponse silence{impl_->sample_rate, std::vector<double>(size)};
    std::vector<ImpulseResponse> results(channels, silence);

    std::vector<std::size_t> heard;
    for (std::size_t i = 0; i < arrivals.size(); ++i) {
        if (!impl_->silent(arrivals[i]) &&
            arrivals[i].delay * impl_->sample_rate < static_cast<double>(size)) {
            heard.push_back(i);
        }
    }
    const std::size_t piece_size = impl_->filter.fft().size();
    std::vector<double> pieces(std::min(kArrivalsPerStep, heard.size()) * piece_size);
    const auto piece = [&](std::size_t i) {
        return std::span(pieces).subspan(i * piece_size, piece_size);
    };
    for (std::size_t first = 0; first < heard.size(); first += kArrivalsPerStep) {
        const std::size_t count = std::min(kArrivalsPerStep, heard.size() - first);
        executor.for_each(count, 4, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                impl_->render(arrivals[heard[first + i]], piece(i));
            }
        });
        executor.for_each(channels, 1, [&](std::size_t begin, std::size_t end) {
            for (std::size_t channel = begin; channel < end; ++channel) {
                for (std::size_t i = 0; i < count; ++i) {
                    const std::size_t arrival = heard[first + i];
                    const double gain = gains[arrival * channels + channel];
                    impl_->add(arrivals[arrival],
                               arrivals[arrival].is_inverted ? -gain : gain,
                               piece(i),
                               results[channel].samples);
                }
            }
        });
    }
    return results;
}

ImpulseResponse assemble(const Bands& bands,
                         std::span<const Arrival> arrivals,
                         const ResponseOptions& options,
                         Executor& executor) {
    return Assembler(bands, options.sample_rate).assemble(arrivals, options.length, executor);
}

}  // namespace earshot::audio
