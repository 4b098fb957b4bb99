// SPDX-License-Identifier: MIT
#include "earshot/audio/internal/response_assembly.h"

#include <algorithm>
#include <cmath>

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

double ResponseAssembly::pressure_sign(std::size_t arrival) const {
    return arrivals_[arrival].is_inverted ? -1.0 : 1.0;
}

std::size_t ResponseAssembly::offset_in(const Block& block, std::size_t arrival) const {
    return static_cast<std::size_t>(impulses_.place(arrival).begin - block.begin);
}

void ResponseAssembly::assemble(const Block& block,
                                BlockWorkspace& work,
                                std::span<double> sums) const {
    sort_arrivals(block, work);
    work.sum.assign(impulses_.channels() * padded(fft_.bins()), Complex());

    // Representatives, and the arrivals that they leave.
    const std::size_t count = work.filtered.size();
    const bool in_closed_form = impulses_.shapes() == 1;
    const std::size_t limit = max_pivots(count, in_closed_form);
    bool any_trains = false;
    work.own.clear();
    if (limit > 0 && work.representatives.find(tables_.nodes.rows(), work.logs, count, limit)) {
        add_represented(block, work);
        any_trains = true;
        const auto outside = work.representatives.outside();
        work.own.assign(outside.begin(), outside.end());
    } else {
        for (std::size_t i = 0; i < count; ++i) {
            work.own.push_back(i);
        }
    }
    for (const std::size_t i : work.own) {
        if (!impulses_.fraction(work.filtered[i])) {
            add_own(i, block, work);
            any_trains = true;
        }
    }
    if (any_trains) {
        for (std::size_t channel = 0; channel < impulses_.channels(); ++channel) {
            fft_.inverse(std::span(work.sum).subspan(channel * padded(fft_.bins()), fft_.bins()),
                         sums.subspan(channel * fft_.size(), fft_.size()),
                         work.fft);
        }
    } else {
        std::fill(sums.begin(), sums.end(), 0.0);
    }

    for (const std::size_t i : work.own) {
        if (const auto fraction = impulses_.fraction(work.filtered[i])) {
            add_piece(i, *fraction, block, work, sums);
        }
    }
    for (const std::size_t arrival : work.flat) {
        add_flat(arrival, block, work, sums);
    }
}

// Flat ones apart; the logarithms of the others' pressures, kLanes arrivals side by side.
void ResponseAssembly::sort_arrivals(const Block& block, BlockWorkspace& work) const {
    work.flat.clear();
    work.filtered.clear();
    work.largest.clear();
    for (const std::size_t arrival : block.arrivals) {
        (tables_.flat(arrivals_[arrival]) ? work.flat : work.filtered).push_back(arrival);
    }
    const std::size_t bands = tables_.filter.bands_in_use();
    const std::size_t group_size = (bands + 1) * kLanes;
    work.logs.assign(padded(work.filtered.size()) * (bands + 1), 1.0);
    for (std::size_t i = 0; i < work.filtered.size(); ++i) {
        const auto used = std::span(arrivals_[work.filtered[i]].pressure).first(bands);
        const double largest = *std::max_element(used.begin(), used.end());
        work.largest.push_back(largest);
        double* column = &work.logs[i / kLanes * group_size + i % kLanes];
        for (std::size_t band = 0; band < bands; ++band) {
            column[band * kLanes] = std::max(used[band] / largest, kPressureFloor);
        }
    }
    logarithms(work.logs.data(), work.logs.size());
}

// 0 if each arrival is cheaper by itself.
std::size_t ResponseAssembly::max_pivots(std::size_t count, bool in_closed_form) const {
    const double n = static_cast<double>(count);
    const double scale = static_cast<double>(tables_.filter.fft().size()) / kModelSize;
    const double own = scale * (in_closed_form ? kPieceCost : kTrainCost);
    const double pivots = n * (own - kSearchCost) / (scale * kTrainCost + n * kSpreadCost);
    return static_cast<std::size_t>(std::max(0.0, std::min(pivots, n - 1.0)));
}

void ResponseAssembly::add_represented(const Block& block, BlockWorkspace& work) const {
    const Representatives& found = work.representatives;
    const std::size_t channels = impulses_.channels();
    const std::size_t train_size = channels * fft_.size();
    const std::size_t step = std::max<std::size_t>(1, kTrainSamples / train_size);
    for (std::size_t first = 0; first < found.pivots().size(); first += step) {
        const std::size_t count = std::min(step, found.pivots().size() - first);
        work.trains.assign(count * train_size, 0.0);
        auto outside = found.outside().begin();
        for (std::size_t i = 0; i < work.filtered.size(); ++i) {
            if (outside != found.outside().end() && *outside == i) {
                ++outside;
                continue;
            }
            spread_arrival(work.filtered[i],
                           work.largest[i],
                           found.weights(i).subspan(first, count),
                           block,
                           work);
        }
        for (std::size_t m = 0; m < count; ++m) {
            add_filtered_trains(found.pivots()[first + m],
                                std::span(work.trains).subspan(m * train_size, train_size),
                                work);
        }
    }
}

/// Adds an arrival's impulse to the trains of several filters, weights[m] times to those of filter
/// m.
void ResponseAssembly::spread_arrival(std::size_t arrival,
                                      double factor,
                                      std::span<const double> weights,
                                      const Block& block,
                                      BlockWorkspace& work) const {
    const std::size_t channels = impulses_.channels();
    const std::size_t taps = impulses_.place(arrival).taps;
    const std::size_t offset = offset_in(block, arrival);
    const double signed_factor = factor * pressure_sign(arrival);
    work.taps.resize(impulses_.shapes() * taps);
    impulses_.write(arrival, work.taps);
    work.weights.resize(weights.size() * channels);
    for (std::size_t m = 0; m < weights.size(); ++m) {
        for (std::size_t channel = 0; channel < channels; ++channel) {
            work.weights[m * channels + channel] =
                weights[m] * signed_factor * impulses_.gain(arrival, channel);
        }
    }
    if (impulses_.shapes() == 1) {
        spread(work.taps.data(),
               taps,
               work.weights.data(),
               work.weights.size(),
               fft_.size(),
               &work.trains[offset]);
        return;
    }
    for (std::size_t m = 0; m < work.weights.size(); ++m) {
        add_scaled(work.weights[m],
                   &work.taps[m % channels * taps],
                   taps,
                   &work.trains[m * fft_.size() + offset]);
    }
}

/// An arrival through its own filter.
void ResponseAssembly::add_own(std::size_t filtered,
                               const Block& block,
                               BlockWorkspace& work) const {
    const double weight = 1.0;
    work.trains.assign(impulses_.channels() * fft_.size(), 0.0);
    spread_arrival(
        work.filtered[filtered], work.largest[filtered], std::span(&weight, 1), block, work);
    add_filtered_trains(filtered, work.trains, work);
}

/// The taps of an arrival's filter re its largest pressure, and zeros.
void ResponseAssembly::make_filter(std::size_t filtered,
                                   std::span<double> samples,
                                   BlockWorkspace& work) const {
    const RealFft& fft = tables_.filter.fft();
    const FilterRows rows = tables_.filter.rows();
    const double* column =
        &work.logs[filtered / kLanes * (rows.bands + 1) * kLanes + filtered % kLanes];
    work.log_pressure.resize(rows.bands + 1);
    for (std::size_t band = 0; band <= rows.bands; ++band) {
        work.log_pressure[band] = column[band * kLanes];
    }
    work.log_magnitude.resize(rows.stride + kLanes);
    work.spectrum.resize(rows.stride);
    filter_spectrum(
        rows, work.log_pressure.data(), work.log_magnitude.data(), numbers(work.spectrum));
    fft.inverse(std::span(work.spectrum).first(fft.bins()), samples.first(fft.size()), work.fft);
    std::fill(samples.begin() + static_cast<std::ptrdiff_t>(fft.size()), samples.end(), 0.0);
}

/// Adds the trains of all channels, through one filter, to the spectra of the block.
void ResponseAssembly::add_filtered_trains(std::size_t filtered,
                                           std::span<const double> trains,
                                           BlockWorkspace& work) const {
    work.piece.resize(fft_.size());
    make_filter(filtered, work.piece, work);
    work.filter.assign(padded(fft_.bins()), Complex());
    work.train.assign(padded(fft_.bins()), Complex());
    fft_.forward(work.piece, std::span(work.filter).first(fft_.bins()), work.fft);
    for (std::size_t channel = 0; channel < impulses_.channels(); ++channel) {
        fft_.forward(trains.subspan(channel * fft_.size(), fft_.size()),
                     std::span(work.train).first(fft_.bins()),
                     work.fft);
        add_product(numbers(work.filter),
                    numbers(work.train),
                    padded(fft_.bins()),
                    numbers(work.sum) + 2 * channel * padded(fft_.bins()));
    }
}

/// An arrival by itself, whose impulse has a transform in closed form.
void ResponseAssembly::add_piece(std::size_t filtered,
                                 double fraction,
                                 const Block& block,
                                 BlockWorkspace& work,
                                 std::span<double> sums) const {
    const RealFft& fft = tables_.piece_fft;
    work.piece.resize(fft.size());
    make_filter(filtered, work.piece, work);
    work.filter.assign(padded(fft.bins()), Complex());
    fft.forward(work.piece, std::span(work.filter).first(fft.bins()), work.fft);
    tables_.delay_spectrum.apply(fraction, work.filter);
    fft.inverse(std::span(work.filter).first(fft.bins()), work.piece, work.fft);

    const std::size_t arrival = work.filtered[filtered];
    const double factor = work.largest[filtered] * pressure_sign(arrival);
    const std::size_t size = tables_.filter.fft().size() + kDelayTaps - 1;
    for (std::size_t channel = 0; channel < impulses_.channels(); ++channel) {
        add_scaled(factor * impulses_.gain(arrival, channel),
                   work.piece.data(),
                   size,
                   &sums[channel * fft_.size() + offset_in(block, arrival)]);
    }
}

void ResponseAssembly::add_flat(std::size_t arrival,
                                const Block& block,
                                BlockWorkspace& work,
                                std::span<double> sums) const {
    const std::size_t taps = impulses_.place(arrival).taps;
    const double factor = arrivals_[arrival].pressure[0] * pressure_sign(arrival);
    work.taps.resize(impulses_.shapes() * taps);
    impulses_.write(arrival, work.taps);
    for (std::size_t channel = 0; channel < impulses_.channels(); ++channel) {
        const std::size_t shape = impulses_.shapes() == 1 ? 0 : channel;
        add_scaled(factor * impulses_.gain(arrival, channel),
                   &work.taps[shape * taps],
                   taps,
                   &sums[channel * fft_.size() + offset_in(block, arrival)]);
    }
}

}  // namespace earshot::audio
