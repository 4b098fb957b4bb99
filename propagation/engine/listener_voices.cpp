// SPDX-License-Identifier: MIT
#include "earshot/propagation/engine/internal/listener_voices.h"

#include <algorithm>
#include <array>

namespace earshot::propagation {

namespace {

/// The cubic of Hermite over a segment: coefficients of u from 0 to 1.
std::array<double, 4> cubic(const double delay[2], const double rate[2], double length) {
    const double begin = rate[0] * length;
    const double end = rate[1] * length;
    const double rise = delay[1] - delay[0];
    return {delay[0], begin, 3.0 * rise - 2.0 * begin - end, begin + end - 2.0 * rise};
}

/// The same cubic by samples from the place `u` on.
std::array<double, 4> moved(const std::array<double, 4>& c, double u, double step) {
    return {c[0] + u * (c[1] + u * (c[2] + u * c[3])),
            step * (c[1] + u * (2.0 * c[2] + u * 3.0 * c[3])),
            step * step * (c[2] + 3.0 * u * c[3]),
            step * step * step * c[3]};
}

}  // namespace

ListenerVoices::ListenerVoices(std::size_t max_voices, std::size_t filters, std::size_t channels)
    : filters_(filters),
      channels_(channels),
      voices_(max_voices),
      active_(max_voices),
      weights_now_(filters),
      weight_steps_(filters),
      gains_now_(channels),
      gain_steps_(channels) {
    for (std::size_t end = 0; end < 2; ++end) {
        weights_[end].assign(max_voices * filters, 0.0F);
        gains_[end].assign(max_voices * channels, 0.0F);
    }
}

// What the voices are at `frame` becomes where they start from; those that have faded out end.
void ListenerVoices::advance_to(std::int64_t frame) noexcept {
    const double length = segment_.length();
    const double u =
        length > 0.0 ? std::clamp(static_cast<double>(frame - segment_.begin) / length, 0.0, 1.0)
                     : 1.0;
    const auto along = static_cast<float>(u);
    std::size_t kept = 0;
    for (std::size_t i = 0; i < active_count_; ++i) {
        const std::uint32_t slot = active_[i];
        Voice& voice = voices_[slot];
        if (u >= 1.0 && !voice.is_wanted) {
            voice.is_active = false;
            continue;
        }
        active_[kept] = slot;
        ++kept;
        if (u >= 1.0) {
            voice.delay[0] = voice.delay[1];
            voice.rate[0] = voice.rate[1];
        } else {
            const auto now = moved(cubic(voice.delay, voice.rate, length), u, 1.0 / length);
            voice.delay[0] = now[0];
            voice.rate[0] = now[1];
        }
        const auto move = [&](std::vector<float>(&numbers)[2], std::size_t size) {
            float* from = row(numbers[0], slot, size);
            const float* to = row(numbers[1], slot, size);
            for (std::size_t k = 0; k < size; ++k) {
                from[k] = u >= 1.0 ? to[k] : from[k] + along * (to[k] - from[k]);
            }
        };
        move(weights_, filters_);
        move(gains_, channels_);
    }
    active_count_ = kept;
}

void ListenerVoices::take(const SnapshotArrival& arrival,
                          const float* weights,
                          const float* gains,
                          double late) noexcept {
    Voice& voice = voices_[arrival.slot];
    const double delay = arrival.delay + arrival.delay_rate * late;
    const double length = segment_.length();
    const auto fill = [&](std::vector<float>& numbers, std::size_t size, const float* values) {
        std::copy_n(values, size, row(numbers, arrival.slot, size));
    };
    if (!voice.is_active) {
        // From silence, on the way that it would have come.
        voice = {.id = arrival.id, .source = arrival.source, .is_active = true};
        voice.delay[0] = std::max(delay - arrival.delay_rate * length, 0.0);
        voice.rate[0] = arrival.delay_rate;
        std::fill_n(row(weights_[0], arrival.slot, filters_), filters_, 0.0F);
        fill(gains_[0], channels_, gains);
        active_[active_count_] = arrival.slot;
        ++active_count_;
    } else if (voice.id != arrival.id) {
        return;  // the slot's last path has not faded out yet; the next snapshot tries again
    }
    voice.is_wanted = true;
    voice.delay[1] = std::max(delay, 0.0);
    voice.rate[1] = arrival.delay_rate;
    fill(weights_[1], filters_, weights);
    fill(gains_[1], channels_, gains);
}

void ListenerVoices::begin(const ListenerSnapshot& snapshot,
                           const Segment& segment,
                           double late) noexcept {
    advance_to(segment.begin);
    segment_ = segment;
    for (std::size_t i = 0; i < active_count_; ++i) {
        Voice& voice = voices_[active_[i]];
        voice.is_wanted = false;
        voice.delay[1] = std::max(voice.delay[0] + voice.rate[0] * segment.length(), 0.0);
        voice.rate[1] = voice.rate[0];
        std::fill_n(row(weights_[1], active_[i], filters_), filters_, 0.0F);
        std::copy_n(row(gains_[0], active_[i], channels_),
                    channels_,
                    row(gains_[1], active_[i], channels_));
    }
    for (std::size_t i = 0; i < snapshot.arrivals.size(); ++i) {
        take(snapshot.arrivals[i],
             &snapshot.weights[i * filters_],
             &snapshot.gains[i * channels_],
             late);
    }
}

void ListenerVoices::hold(const Segment& segment, bool come_to_rest) noexcept {
    advance_to(segment.begin);
    segment_ = segment;
    for (std::size_t i = 0; i < active_count_; ++i) {
        Voice& voice = voices_[active_[i]];
        // At constant deceleration half of the way is covered.
        const double way = voice.rate[0] * segment.length() * (come_to_rest ? 0.5 : 1.0);
        voice.delay[1] = std::max(voice.delay[0] + way, 0.0);
        voice.rate[1] = come_to_rest ? 0.0 : voice.rate[0];
    }
}

void ListenerVoices::add(std::int64_t frame,
                         std::span<const audio::SourceLines> lines,
                         audio::ArrivalMixer& mixer,
                         float* channels) noexcept {
    const double step = 1.0 / segment_.length();
    const double u = static_cast<double>(frame - segment_.begin) * step;
    const auto along = static_cast<float>(u);
    const auto per_sample = static_cast<float>(step);
    for (std::size_t i = 0; i < active_count_; ++i) {
        const std::uint32_t slot = active_[i];
        const Voice& voice = voices_[slot];
        const auto now = [&](std::vector<float>(&numbers)[2],
                             std::size_t size,
                             std::vector<float>& values,
                             std::vector<float>& steps) {
            const float* from = row(numbers[0], slot, size);
            const float* to = row(numbers[1], slot, size);
            for (std::size_t k = 0; k < size; ++k) {
                const float rise = to[k] - from[k];
                values[k] = from[k] + along * rise;
                steps[k] = per_sample * rise;
            }
        };
        now(weights_, filters_, weights_now_, weight_steps_);
        now(gains_, channels_, gains_now_, gain_steps_);
        mixer.add(lines[voice.source],
                  {.delay = moved(cubic(voice.delay, voice.rate, segment_.length()), u, step),
                   .weights = weights_now_,
                   .weight_steps = weight_steps_,
                   .gains = gains_now_,
                   .gain_steps = gain_steps_},
                  channels);
    }
}

}  // namespace earshot::propagation
