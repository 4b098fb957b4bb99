// SPDX-License-Identifier: MIT
#include "earshot/audio/moving_arrivals.h"

#include "earshot/audio/internal/delay_line_kernel.h"
#include "earshot/audio/internal/fractional_delay.h"
#include "earshot/audio/multi_convolver.h"
#include "earshot/base/assert.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace earshot::audio {

static_assert(kMovingArrivalLookahead == kDelayHalfLength);

namespace {

using Stretch = std::array<double, kMaxArrivalStretch>;

// A way may lead through the listener, where the level would be infinite.
constexpr double kMinDistance = 1e-3;  // metres

/// Delays between two instants: the cubic of Hermite, by Horner's rule.
class DelayCubic {
public:
    DelayCubic(const MovingArrival& from, const MovingArrival& to, double seconds, double steps)
        : first_(from.delay), linear_(from.delay_rate * seconds), step_(1.0 / steps) {
        const double rise = to.delay - from.delay;
        const double end = to.delay_rate * seconds;
        square_ = 3.0 * rise - 2.0 * linear_ - end;
        cube_ = linear_ + end - 2.0 * rise;
    }

    double at(std::size_t n) const noexcept {
        const double u = static_cast<double>(n) * step_;
        return first_ + u * (linear_ + u * (square_ + u * cube_));
    }

private:
    double first_, linear_, square_ = 0.0, cube_ = 0.0;
    double step_;
};

/// The signal at one place near its ends or beyond them.
double read_at_end(std::span<const double> signal, double position) noexcept {
    constexpr auto kLead = static_cast<std::ptrdiff_t>(kDelayHalfLength) - 1;
    const double floor = std::floor(position);
    const auto size = static_cast<std::ptrdiff_t>(signal.size());
    if (!(floor >= -static_cast<double>(kDelayHalfLength)) ||
        !(floor < static_cast<double>(size + kLead))) {
        return 0.0;
    }
    std::array<double, kDelayTaps> window{};
    const std::ptrdiff_t begin = static_cast<std::ptrdiff_t>(floor) - kLead;
    for (std::size_t tap = 0; tap < kDelayTaps; ++tap) {
        const std::ptrdiff_t n = begin + static_cast<std::ptrdiff_t>(tap);
        window[tap] = n >= 0 && n < size ? signal[static_cast<std::size_t>(n)] : 0.0;
    }
    const double in_window = static_cast<double>(kLead) + (position - floor);
    double value = 0.0;
    read_between(window.data(), DelayTable::shared().rows(), &in_window, 1, &value);
    return value;
}

/// Signal values at many positions.
void read(std::span<const double> signal,
          const Stretch& positions,
          std::size_t count,
          Stretch& values) noexcept {
    constexpr double kFirst = static_cast<double>(kDelayHalfLength) - 1.0;
    const double end = static_cast<double>(signal.size()) - static_cast<double>(kDelayHalfLength);
    const bool is_inside =
        std::all_of(positions.begin(),
                    positions.begin() + static_cast<std::ptrdiff_t>(count),
                    [&](double position) { return position >= kFirst && position < end; });
    if (is_inside) {
        read_between(
            signal.data(), DelayTable::shared().rows(), positions.data(), count, values.data());
        return;
    }
    for (std::size_t n = 0; n < count; ++n) {
        values[n] = read_at_end(signal, positions[n]);
    }
}

}  // namespace

void add_moving_arrival(const MovingArrivalScale& scale,
                        std::span<const double> signal,
                        double now,
                        const MovingArrival& from,
                        const MovingArrival& to,
                        std::size_t count,
                        std::size_t stride,
                        double* buses) noexcept {
    EARSHOT_ASSERT(count <= kMaxArrivalStretch && count <= stride);
    EARSHOT_ASSERT(from.gains.size() == to.gains.size());
    if (count == 0) {
        return;
    }
    // The signal at the instants of emission, and the level of the distance.
    const auto steps = static_cast<double>(count);
    const DelayCubic delays(from, to, steps / scale.sample_rate, steps);
    Stretch positions, levels, values;
    for (std::size_t n = 0; n < count; ++n) {
        const double delay = delays.at(n);
        positions[n] = now + static_cast<double>(n) - delay * scale.sample_rate;
        levels[n] = 1.0 / std::max(delay * scale.speed_of_sound, kMinDistance);
    }
    read(signal, positions, count, values);
    for (std::size_t n = 0; n < count; ++n) {
        values[n] *= levels[n];
    }
    for (std::size_t bus = 0; bus < from.gains.size(); ++bus) {
        const double gain = from.gains[bus];
        const double step = (to.gains[bus] - gain) / steps;
        if (gain != 0.0 || step != 0.0) {
            add_ramp(values.data(), count, gain, step, buses + bus * stride);
        }
    }
}

struct MovingArrivalRenderer::State {
    State(const Settings& the_settings, MultiConvolver&& the_convolver)
        : settings(the_settings), convolver(std::move(the_convolver)) {
        const double reach = std::ceil(settings.max_delay * settings.scale.sample_rate);
        past = static_cast<std::size_t>(reach) + 2 * kDelayTaps;
        line.assign(2 * (past + settings.block), 0.0);
        buses.assign(convolver.signals() * settings.block, 0.0);
        DelayTable::shared();  // made now, not while sound plays
    }

    /// The signal so far, of which `past` samples and this block are kept.
    std::span<const double> heard() const noexcept {
        return std::span(line).subspan(end - past - settings.block, past + settings.block);
    }

    Settings settings;
    MultiConvolver convolver;
    std::size_t past = 0;
    std::vector<double> line;  // twice as long as what is kept, which moves to its begin at its end
    std::size_t end = 0;
    std::vector<double> buses;
};

MovingArrivalRenderer::MovingArrivalRenderer(const FilterBank& filters, const Settings& settings) {
    EARSHOT_ASSERT(settings.channels > 0 && settings.block >= 4 && settings.max_delay >= 0.0);
    state_ =
        std::make_unique<State>(settings, filters.convolver(settings.channels, settings.block));
    state_->end = state_->past;
}

MovingArrivalRenderer::~MovingArrivalRenderer() = default;
MovingArrivalRenderer::MovingArrivalRenderer(MovingArrivalRenderer&&) noexcept = default;
MovingArrivalRenderer& MovingArrivalRenderer::operator=(MovingArrivalRenderer&&) noexcept = default;

std::size_t MovingArrivalRenderer::buses() const noexcept {
    return state_->convolver.signals();
}

void MovingArrivalRenderer::begin_block(std::span<const double> signal) noexcept {
    State& state = *state_;
    EARSHOT_ASSERT(signal.size() == state.settings.block);
    if (state.end + signal.size() > state.line.size()) {
        const auto kept = static_cast<std::ptrdiff_t>(state.past);
        const auto end = state.line.begin() + static_cast<std::ptrdiff_t>(state.end);
        std::copy(end - kept, end, state.line.begin());
        state.end = state.past;
    }
    std::copy(
        signal.begin(), signal.end(), state.line.begin() + static_cast<std::ptrdiff_t>(state.end));
    state.end += signal.size();
    std::fill(state.buses.begin(), state.buses.end(), 0.0);
}

void MovingArrivalRenderer::add(const MovingArrival& from,
                                const MovingArrival& to,
                                std::size_t first,
                                std::size_t count) noexcept {
    State& state = *state_;
    EARSHOT_ASSERT(from.gains.size() == buses() && first + count <= state.settings.block);
    const double now =
        static_cast<double>(state.past + first) - static_cast<double>(kMovingArrivalLookahead);
    add_moving_arrival(state.settings.scale,
                       state.heard(),
                       now,
                       from,
                       to,
                       count,
                       state.settings.block,
                       state.buses.data() + first);
}

void MovingArrivalRenderer::end_block(std::span<double> out) noexcept {
    state_->convolver.process(state_->buses, out);
}

}  // namespace earshot::audio
