// SPDX-License-Identifier: MIT
#include "earshot/io/report_audio.h"

#include "earshot/io/internal/base64.h"
#include "earshot/io/internal/bytes.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

namespace earshot::io {
namespace {

using audio::Signal;

constexpr std::int64_t kSampleRate = 16000;  // speech and most of music
constexpr std::size_t kMaxChannels = 2;      // that browsers play as they are
constexpr double kPeak = 0.7;

void scale_to_peak(Signal& signal) {
    double largest = 0.0;
    for (const auto& channel : signal.channels) {
        for (const double sample : channel) {
            largest = std::max(largest, std::abs(sample));
        }
    }
    const double gain = largest > 0.0 ? kPeak / largest : 0.0;
    for (auto& channel : signal.channels) {
        for (double& sample : channel) {
            sample *= gain;
        }
    }
}

/// 16-bit PCM in a RIFF file (Microsoft and IBM 1991).
std::string encode_pcm(const Signal& signal) {
    const std::size_t channels = signal.channels.size();
    const std::size_t frames = signal.channels.front().size();
    const auto rate = static_cast<std::uint64_t>(signal.sample_rate);
    constexpr std::size_t kBytes = 2;
    ByteWriter file;
    file.raw("RIFF");
    file.fixed(36 + frames * channels * kBytes, 4);
    file.raw("WAVEfmt ");
    file.fixed(16, 4);  // bytes of the format
    file.fixed(1, 2);   // PCM
    file.fixed(channels, 2);
    file.fixed(rate, 4);
    file.fixed(rate * channels * kBytes, 4);
    file.fixed(channels * kBytes, 2);
    file.fixed(8 * kBytes, 2);
    file.raw("data");
    file.fixed(frames * channels * kBytes, 4);
    constexpr double kFullScale = 32767.0;
    for (std::size_t n = 0; n < frames; ++n) {
        for (const auto& channel : signal.channels) {
            const long sample = std::lround(kFullScale * std::clamp(channel[n], -1.0, 1.0));
            file.fixed(static_cast<std::uint64_t>(sample) & 0xffffU, kBytes);
        }
    }
    return file.bytes();
}

std::string data_uri(Signal signal, Executor& executor) {
    if (signal.channels.size() > kMaxChannels) {
        signal.channels.resize(1);
    }
    audio::resample_to(kSampleRate, signal, executor);
    scale_to_peak(signal);
    return "data:audio/wav;base64," + base64(encode_pcm(signal));
}

}  // namespace

ReportAudio make_report_audio(Signal dry, const Signal& response, Executor& executor) {
    const auto max_samples =
        static_cast<std::size_t>(kMaxReportSoundLength * static_cast<double>(dry.sample_rate));
    for (auto& channel : dry.channels) {
        channel.resize(std::min(channel.size(), max_samples));
    }
    Signal wet = audio::auralize(dry, std::span(&response, 1), executor);
    return {.dry = data_uri(std::move(dry), executor), .wet = data_uri(std::move(wet), executor)};
}

}  // namespace earshot::io
