// SPDX-License-Identifier: MIT
#include "earshot/audio/measured_response.h"

#include "earshot/audio/internal/onset.h"
#include "earshot/base/assert.h"
#include "earshot/base/math.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>

namespace earshot::audio {

namespace {

constexpr double kFullScale = 1.0 - 0x1p-15;  // the largest number of 16 bit
constexpr std::size_t kMinRun = 3;            // equal extremes in a row that are clipped
constexpr double kMinKinkSteps = 4.0;    // quantisation steps: a slow crest is quantised flat, too
constexpr double kPreArrivalTime = 0.1;  // seconds; a reflection louder than all before it is not
                                         // 34 m longer in a room
constexpr double kPreArrivalEnergy = 0.1;  // of the response's
constexpr double kRise = 10.0;             // energy ratio at which the response proper begins
constexpr double kBlockTime = 0.005;       // seconds
constexpr double kGuardTime = 0.01;        // seconds kept before the onset: the rise of low bands
constexpr double kGivenGuardTime = 0.001;  // an onset may be given in milliseconds
constexpr double kMinToldPadding = 0.001;  // seconds
constexpr double kMinToldOffset = 1e-4;    // of the largest sample
constexpr double kOffsetShare = 0.1;       // of the end's energy: less is lost in its noise
constexpr double kEndShare = 0.1;          // of the response, taken for its end

/// The text of a number in C's format.
std::string formatted(const char* format, double value) {
    std::array<char, 64> text{};
    std::snprintf(text.data(), text.size(), format, value);
    return text.data();
}

double energy_of(std::span<const double> samples) {
    double sum = 0.0;
    for (const double sample : samples) {
        sum += sample * sample;
    }
    return sum;
}

double mean_of(std::span<const double> samples) {
    double sum = 0.0;
    for (const double sample : samples) {
        sum += sample;
    }
    return sum / static_cast<double>(samples.size());
}

/// The smallest step between neighbouring samples; infinite if there is none.
double smallest_step(std::span<const double> samples) {
    double smallest = std::numeric_limits<double>::infinity();
    for (std::size_t n = 1; n < samples.size(); ++n) {
        const double step = std::abs(samples[n] - samples[n - 1]);
        if (step > 0.0) {
            smallest = std::min(smallest, step);
        }
    }
    return smallest;
}

/// Whether a value stands several times in a row with a kink before or behind: a clipped crest is
/// entered or left at a slope, a slow one that is quantised is not.
bool has_flat_run(std::span<const double> samples, double value, double min_kink) {
    const auto kink = [&](std::size_t neighbour) {
        return neighbour < samples.size() && std::abs(value - samples[neighbour]) > min_kink;
    };
    for (std::size_t begin = 0; value != 0.0 && begin < samples.size();) {
        std::size_t end = begin;
        while (end < samples.size() && samples[end] == value) {
            ++end;
        }
        if (end - begin >= kMinRun && (kink(begin - 1) || kink(end))) {
            return true;
        }
        begin = end + 1;
    }
    return false;
}

/// Samples [begin, end).
struct Range {
    std::size_t begin = 0, end = 0;
};

/// Without the constant samples at both ends.
Range without_padding(std::span<const double> samples) {
    Range range{0, samples.size()};
    while (range.end > 1 && samples[range.end - 1] == samples[range.end - 2]) {
        --range.end;
    }
    while (range.begin + 1 < range.end && samples[range.begin] == samples[range.begin + 1]) {
        ++range.begin;
    }
    return range;
}

std::vector<double> block_energies(std::span<const double> samples, std::size_t size) {
    std::vector<double> blocks;
    for (std::size_t begin = 0; begin < samples.size(); begin += size) {
        blocks.push_back(energy_of(samples.subspan(begin, std::min(size, samples.size() - begin))));
    }
    return blocks;
}

MetricNote note(std::string text) {
    return {.metric = "all", .band_hz = {}, .text = std::move(text)};
}

std::vector<MetricNote> notes_on(const ImpulseResponse& recording,
                                 const Range& range,
                                 const MeasuredResponse& measured,
                                 const std::optional<PreArrival>& pre_arrival) {
    std::vector<MetricNote> notes;
    const double rate = recording.sample_rate;
    const auto tell_padding = [&](std::size_t samples, const char* where) {
        const double time = static_cast<double>(samples) / rate;
        if (time >= kMinToldPadding) {
            notes.push_back(
                note(formatted("%.3f s of constant samples ", time) + where + " are left out"));
        }
    };
    tell_padding(range.begin, "at the beginning");
    tell_padding(recording.samples.size() - range.end, "at the end");
    const auto magnitude = [](double a, double b) { return std::abs(a) < std::abs(b); };
    const auto& part = measured.response.samples;
    const double largest = std::abs(*std::max_element(part.begin(), part.end(), magnitude));
    if (std::abs(measured.offset) > kMinToldOffset * largest) {
        notes.push_back(note(formatted("an offset of %.3g is taken out", measured.offset)));
    }
    if (pre_arrival) {
        const double ahead = static_cast<double>(measured.onset - pre_arrival->onset) / rate;
        notes.push_back(note(formatted("sound %.3f s before the response, ", ahead) +
                             formatted("%.0f dB below it, ", -pre_arrival->level_db) +
                             "is taken for harmonic distortion of a swept sine and left out"));
    }
    if (measured.clipping.samples > 0) {
        notes.push_back(
            note(std::to_string(measured.clipping.samples) +
                 formatted(" samples are clipped at %.2f dB re full scale, ",
                           measured.clipping.level_db) +
                 formatted("with %.1f %% of the energy", 100.0 * measured.clipping.energy_share)));
    }
    if (measured.clipping.one_at_full_scale) {
        notes.push_back(
            note("a sample stands at full scale: it is clipped, unless the file was normalised"));
    }
    return notes;
}

}  // namespace

Clipping find_clipping(std::span<const double> samples) {
    Clipping clipping;
    if (samples.empty()) {
        return clipping;
    }
    const auto [smallest, largest] = std::minmax_element(samples.begin(), samples.end());
    // Samples of a floating-point file may exceed full scale: then it is no limit.
    const bool has_full_scale = std::max(-*smallest, *largest) <= 1.0;
    const auto at_full_scale = [&](double sample) {
        return has_full_scale && std::abs(sample) >= kFullScale;
    };
    const auto full = std::count_if(samples.begin(), samples.end(), at_full_scale);
    clipping.one_at_full_scale = full == 1;
    const double min_kink = kMinKinkSteps * smallest_step(samples);
    const bool smallest_is_limit = has_flat_run(samples, *smallest, min_kink);
    const bool largest_is_limit = has_flat_run(samples, *largest, min_kink);
    double clipped_energy = 0.0;
    std::size_t last = 0;
    for (std::size_t n = 0; n < samples.size(); ++n) {
        const double sample = samples[n];
        if ((smallest_is_limit && sample == *smallest) ||
            (largest_is_limit && sample == *largest) || (full > 1 && at_full_scale(sample))) {
            ++clipping.samples;
            clipped_energy += sample * sample;
            last = n + 1;
        }
    }
    if (clipping.samples > 0) {
        clipping.one_at_full_scale = false;
        const double energy = energy_of(samples);
        clipping.level_db = 20.0 * math::log10(std::max(std::abs(*smallest), std::abs(*largest)));
        clipping.energy_share = clipped_energy / energy;
        clipping.energy_after_db = 10.0 * math::log10(energy_of(samples.subspan(last)) / energy);
    }
    return clipping;
}

std::optional<MeasuredOnset> find_measured_onset(std::span<const double> samples,
                                                 double sample_rate) {
    const auto first = find_onset(samples);
    if (!first) {
        return std::nullopt;
    }
    const auto size = static_cast<std::size_t>(std::max(1.0, std::round(kBlockTime * sample_rate)));
    const std::vector<double> blocks = block_energies(samples, size);
    const auto loudest = std::max_element(blocks.begin(), blocks.end());
    // The response proper begins where the energy rises to that of its loudest block.
    auto rise = loudest;
    while (rise != blocks.begin() && *(rise - 1) > *loudest / kRise) {
        --rise;
    }
    const std::size_t begin =
        rise == blocks.begin() ? 0 : static_cast<std::size_t>(rise - blocks.begin() - 1) * size;
    const double ahead = (static_cast<double>(begin) - static_cast<double>(*first)) / sample_rate;
    if (ahead < kPreArrivalTime) {
        return MeasuredOnset{*first, {}};
    }
    const double before = energy_of(samples.first(begin));
    const double after = energy_of(samples.subspan(begin));
    if (!(before < kPreArrivalEnergy * after)) {
        return MeasuredOnset{*first, {}};
    }
    // What is left of the distortion when the response begins is no onset.
    const std::size_t lead = std::min(begin, 4 * size);
    const auto magnitude = [](double a, double b) { return std::abs(a) < std::abs(b); };
    const double left =
        std::abs(*std::max_element(samples.begin() + static_cast<std::ptrdiff_t>(begin - lead),
                                   samples.begin() + static_cast<std::ptrdiff_t>(begin),
                                   magnitude));
    const double largest = std::abs(*std::max_element(
        samples.begin() + static_cast<std::ptrdiff_t>(begin), samples.end(), magnitude));
    const double threshold = std::max(0.1 * largest, std::min(2.0 * left, 0.5 * largest));
    std::size_t onset = begin;
    while (std::abs(samples[onset]) < threshold) {
        ++onset;
    }
    return MeasuredOnset{onset, PreArrival{*first, 10.0 * math::log10(before / after)}};
}

std::optional<MeasuredResponse> measured_response(const ImpulseResponse& recording,
                                                  std::optional<std::size_t> onset) {
    const std::span<const double> samples = recording.samples;
    const Range range = without_padding(samples);
    if (range.begin + 1 >= range.end || (onset && *onset >= range.end)) {
        return std::nullopt;
    }
    MeasuredResponse measured;
    measured.clipping = find_clipping(samples.subspan(range.begin, range.end - range.begin));

    std::vector<double> part(samples.begin() + static_cast<std::ptrdiff_t>(range.begin),
                             samples.begin() + static_cast<std::ptrdiff_t>(range.end));
    const auto end_size =
        static_cast<std::size_t>(std::ceil(kEndShare * static_cast<double>(part.size())));
    const auto the_end = std::span(part).last(end_size);
    const double mean = mean_of(the_end);
    if (mean * mean * static_cast<double>(end_size) > kOffsetShare * energy_of(the_end)) {
        measured.offset = mean;
        for (double& sample : part) {
            sample -= mean;
        }
    }

    std::optional<PreArrival> pre_arrival;
    if (onset) {
        measured.onset = *onset;
    } else {
        const auto found = find_measured_onset(part, recording.sample_rate);
        if (!found) {
            return std::nullopt;
        }
        measured.onset = range.begin + found->onset;
        if (found->pre_arrival) {
            pre_arrival =
                PreArrival{range.begin + found->pre_arrival->onset, found->pre_arrival->level_db};
        }
    }

    const auto guard = static_cast<std::size_t>(
        std::ceil((onset ? kGivenGuardTime : kGuardTime) * recording.sample_rate));
    measured.begin = std::max(range.begin, measured.onset - std::min(measured.onset, guard));
    // An onset that is given may lie in the padding.
    measured.onset = std::max(measured.onset, measured.begin);
    part.erase(part.begin(),
               part.begin() + static_cast<std::ptrdiff_t>(measured.begin - range.begin));
    measured.response = {recording.sample_rate, std::move(part)};
    measured.notes = notes_on(recording, range, measured, pre_arrival);
    return measured;
}

ImpulseResponse same_part(const MeasuredResponse& part, const ImpulseResponse& channel) {
    EARSHOT_ASSERT(part.begin + part.response.samples.size() <= channel.samples.size());
    const auto begin = channel.samples.begin() + static_cast<std::ptrdiff_t>(part.begin);
    return {channel.sample_rate,
            {begin, begin + static_cast<std::ptrdiff_t>(part.response.samples.size())}};
}

}  // namespace earshot::audio
