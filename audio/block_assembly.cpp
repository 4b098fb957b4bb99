// SPDX-License-Identifier: MIT
#include "earshot/audio/internal/block_assembly.h"

#include "earshot/audio/internal/signal_kernel.h"

#include <algorithm>
#include <numeric>

// One block of a response. Arrivals whose filters resemble each other share a few of them: each
// representative filter has a train of all impulses, weighted, and the block is the sum of the
// filtered trains. Where that does not pay, each arrival is filtered by itself.

namespace earshot::audio {

namespace {

using Complex = std::complex<double>;

// The fixed model that decides between the two ways, in microseconds at 4,096 taps. It is that of
// one channel, so that a channel's bits do not depend on the others.
constexpr double kModelSize = 4096.0;
constexpr double kPieceCost = 31.0;    // an arrival by itself in closed form
constexpr double kTrainCost = 35.0;    // a representative, or an arrival's own filter and train
constexpr double kSearchCost = 0.3;    // per arrival
constexpr double kSpreadCost = 0.035;  // per arrival and representative

// Trains that are filled at a time, so that they stay in the cache.
constexpr std::size_t kTrainSamples = std::size_t{1} << 18;

double* numbers(LargeArray<Complex>& values) {
    // std::complex<double> is laid out as two doubles ([complex.numbers]/4).
    return reinterpret_cast<double*>(values.data());
}

}  // namespace

double BlockAssembly::pressure_sign(std::size_t arrival) const {
    return arrivals_[arrival].is_inverted ? -1.0 : 1.0;
}

std::size_t BlockAssembly::offset_of(std::size_t arrival) const {
    return static_cast<std::size_t>(impulses_.place(arrival).begin - block_.begin);
}

BlockAssembly::BlockAssembly(const AssemblyTables& tables,
                             std::span<const Arrival> arrivals,
                             const ArrivalImpulses& impulses,
                             const RealFft& fft,
                             const ArrivalBlock& block,
                             BlockWorkspace& work)
    : tables_(tables),
      arrivals_(arrivals),
      impulses_(impulses),
      fft_(fft),
      block_(block),
      work_(work),
      channels_(impulses.channels()) {}

void BlockAssembly::assemble(std::span<double> sums) {
    sort_arrivals();
    work_.sum.assign(channels_ * stride(), Complex());

    // Representatives, and the arrivals that they leave.
    const std::size_t count = work_.filtered.size();
    const std::size_t limit = max_pivots();
    work_.own.clear();
    if (limit > 0 && work_.representatives.find(tables_.nodes.rows(), work_.logs, count, limit)) {
        add_represented();
        const auto outside = work_.representatives.outside();
        work_.own.assign(outside.begin(), outside.end());
    } else {
        work_.own.resize(count);
        std::iota(work_.own.begin(), work_.own.end(), std::size_t{0});
    }
    for (const std::size_t i : work_.own) {
        if (!impulses_.fraction(work_.filtered[i])) {
            add_own(i);
        }
    }
    make_sums(sums);

    for (const std::size_t i : work_.own) {
        if (const auto fraction = impulses_.fraction(work_.filtered[i])) {
            add_piece(i, *fraction, sums);
        }
    }
    for (const std::size_t arrival : work_.flat) {
        add_flat(arrival, sums);
    }
}

// Of the filtered trains.
void BlockAssembly::make_sums(std::span<double> sums) {
    if (!any_trains_) {
        std::fill(sums.begin(), sums.end(), 0.0);
        return;
    }
    for (std::size_t channel = 0; channel < channels_; ++channel) {
        fft_.inverse(std::span(work_.sum).subspan(channel * stride(), fft_.bins()),
                     sums.subspan(channel * fft_.size(), fft_.size()),
                     work_.fft);
    }
}

// Flat ones apart; the logarithms of the others' pressures, kLanes arrivals side by side.
void BlockAssembly::sort_arrivals() {
    work_.flat.clear();
    work_.filtered.clear();
    work_.pressures.clear();
    for (const std::size_t arrival : block_.arrivals) {
        if (tables_.flat(arrivals_[arrival])) {
            work_.flat.push_back(arrival);
        } else {
            work_.filtered.push_back(arrival);
            work_.pressures.push_back(&arrivals_[arrival].pressure);
        }
    }
    log_pressures(work_.pressures, tables_.filter.bands_in_use(), work_.largest, work_.logs);
}

// 0 if each arrival is cheaper by itself.
std::size_t BlockAssembly::max_pivots() const {
    const double n = static_cast<double>(work_.filtered.size());
    if (n == 0.0) {
        return 0;
    }
    const double scale = static_cast<double>(tables_.filter.fft().size()) / kModelSize;
    const double own = scale * (impulses_.shapes() == 1 ? kPieceCost : kTrainCost);
    const double pivots = n * (own - kSearchCost) / (scale * kTrainCost + n * kSpreadCost);
    return static_cast<std::size_t>(std::max(0.0, std::min(pivots, n - 1.0)));
}

void BlockAssembly::add_represented() {
    const Representatives& found = work_.representatives;
    const std::size_t train_size = channels_ * fft_.size();
    const std::size_t step = std::max<std::size_t>(1, kTrainSamples / train_size);
    for (std::size_t first = 0; first < found.pivots().size(); first += step) {
        const std::size_t count = std::min(step, found.pivots().size() - first);
        work_.trains.assign(count * train_size, 0.0);
        auto outside = found.outside().begin();
        for (std::size_t i = 0; i < work_.filtered.size(); ++i) {
            if (outside != found.outside().end() && *outside == i) {
                ++outside;
                continue;
            }
            spread_arrival(
                work_.filtered[i], work_.largest[i], found.weights(i).subspan(first, count));
        }
        for (std::size_t m = 0; m < count; ++m) {
            add_filtered_trains(found.pivots()[first + m],
                                std::span(work_.trains).subspan(m * train_size, train_size));
        }
    }
}

/// Adds an arrival's impulse to the trains of several filters: to those of filter m weights[m]
/// times.
void BlockAssembly::spread_arrival(std::size_t arrival,
                                   double factor,
                                   std::span<const double> weights) {
    const std::size_t taps = impulses_.place(arrival).taps;
    const std::size_t offset = offset_of(arrival);
    const double signed_factor = factor * pressure_sign(arrival);
    work_.taps.resize(impulses_.shapes() * taps);
    impulses_.write(arrival, work_.taps);
    work_.weights.resize(weights.size() * channels_);
    for (std::size_t m = 0; m < weights.size(); ++m) {
        for (std::size_t channel = 0; channel < channels_; ++channel) {
            work_.weights[m * channels_ + channel] =
                weights[m] * signed_factor * impulses_.gain(arrival, channel);
        }
    }
    if (impulses_.shapes() == 1) {
        spread(work_.taps.data(),
               taps,
               work_.weights.data(),
               work_.weights.size(),
               fft_.size(),
               &work_.trains[offset]);
        return;
    }
    for (std::size_t m = 0; m < work_.weights.size(); ++m) {
        add_scaled(work_.weights[m],
                   &work_.taps[m % channels_ * taps],
                   taps,
                   &work_.trains[m * fft_.size() + offset]);
    }
}

/// An arrival through its own filter.
void BlockAssembly::add_own(std::size_t filtered) {
    const double weight = 1.0;
    work_.trains.assign(channels_ * fft_.size(), 0.0);
    spread_arrival(work_.filtered[filtered], work_.largest[filtered], std::span(&weight, 1));
    add_filtered_trains(filtered, work_.trains);
}

/// The taps of an arrival's filter re its largest pressure, and zeros.
void BlockAssembly::make_filter(std::size_t filtered, std::span<double> samples) {
    const RealFft& fft = tables_.filter.fft();
    const FilterRows rows = tables_.filter.rows();
    const double* column =
        &work_.logs[filtered / kLanes * (rows.bands + 1) * kLanes + filtered % kLanes];
    work_.log_pressure.resize(rows.bands + 1);
    for (std::size_t band = 0; band <= rows.bands; ++band) {
        work_.log_pressure[band] = column[band * kLanes];
    }
    work_.log_magnitude.resize(rows.stride + kLanes);
    work_.spectrum.resize(rows.stride);
    filter_spectrum(
        rows, work_.log_pressure.data(), work_.log_magnitude.data(), numbers(work_.spectrum));
    fft.inverse(std::span(work_.spectrum).first(fft.bins()), samples.first(fft.size()), work_.fft);
    std::fill(samples.begin() + static_cast<std::ptrdiff_t>(fft.size()), samples.end(), 0.0);
}

/// Adds the trains of all channels, through one filter, to the spectra of the block.
void BlockAssembly::add_filtered_trains(std::size_t filtered, std::span<const double> trains) {
    any_trains_ = true;
    work_.piece.resize(fft_.size());
    make_filter(filtered, work_.piece);
    work_.filter.assign(stride(), Complex());
    work_.train.assign(stride(), Complex());
    fft_.forward(work_.piece, std::span(work_.filter).first(fft_.bins()), work_.fft);
    for (std::size_t channel = 0; channel < channels_; ++channel) {
        fft_.forward(trains.subspan(channel * fft_.size(), fft_.size()),
                     std::span(work_.train).first(fft_.bins()),
                     work_.fft);
        add_product(numbers(work_.filter),
                    numbers(work_.train),
                    stride(),
                    numbers(work_.sum) + 2 * channel * stride());
    }
}

/// An arrival by itself, whose impulse has a transform in closed form.
void BlockAssembly::add_piece(std::size_t filtered, double fraction, std::span<double> sums) {
    const RealFft& fft = tables_.piece_fft;
    work_.piece.resize(fft.size());
    make_filter(filtered, work_.piece);
    work_.filter.assign(padded(fft.bins()), Complex());
    fft.forward(work_.piece, std::span(work_.filter).first(fft.bins()), work_.fft);
    tables_.delay_spectrum.apply(fraction, work_.filter);
    fft.inverse(std::span(work_.filter).first(fft.bins()), work_.piece, work_.fft);

    const std::size_t arrival = work_.filtered[filtered];
    const double factor = work_.largest[filtered] * pressure_sign(arrival);
    const std::size_t size = tables_.filter.fft().size() + kDelayTaps - 1;
    for (std::size_t channel = 0; channel < channels_; ++channel) {
        add_scaled(factor * impulses_.gain(arrival, channel),
                   work_.piece.data(),
                   size,
                   &sums[channel * fft_.size() + offset_of(arrival)]);
    }
}

void BlockAssembly::add_flat(std::size_t arrival, std::span<double> sums) {
    const std::size_t taps = impulses_.place(arrival).taps;
    const double factor = arrivals_[arrival].pressure[0] * pressure_sign(arrival);
    work_.taps.resize(impulses_.shapes() * taps);
    impulses_.write(arrival, work_.taps);
    for (std::size_t channel = 0; channel < channels_; ++channel) {
        const std::size_t shape = impulses_.shapes() == 1 ? 0 : channel;
        add_scaled(factor * impulses_.gain(arrival, channel),
                   &work_.taps[shape * taps],
                   taps,
                   &sums[channel * fft_.size() + offset_of(arrival)]);
    }
}

}  // namespace earshot::audio
