// SPDX-License-Identifier: MIT
#include "earshot/cli/listening.h"

#include "earshot/audio/late_noise.h"
#include "earshot/audio/spatial.h"

#include <algorithm>
#include <span>
#include <utility>

namespace earshot::cli {
namespace {

using audio::ImpulseResponse;
using Signals = std::vector<std::vector<double>>;

audio::Orientation orientation_of(const propagation::Pose& pose) {
    const auto components = [](const geometry::Vec3& v) {
        return std::array<double, 3>{v.x, v.y, v.z};
    };
    return {
        .front = components(pose.front), .left = components(pose.left), .up = components(pose.up)};
}

/// Late sound joins the early; a length that was asked for stays.
void add_late(const Signals& late, bool fixed_length, std::vector<ImpulseResponse>& channels) {
    std::size_t size = channels.front().samples.size();
    for (const std::vector<double>& signal : late) {
        size = fixed_length ? size : std::max(size, signal.size());
    }
    for (std::size_t channel = 0; channel < channels.size(); ++channel) {
        std::vector<double>& samples = channels[channel].samples;
        samples.resize(size, 0.0);
        for (std::size_t n = 0; n < std::min(size, late[channel].size()); ++n) {
            samples[n] += late[channel][n];
        }
    }
}

/// One call's arguments, for the functions below.
struct Call {
    const propagation::PairResult& pair;
    std::vector<audio::Arrival> arrivals;
    const audio::Orientation orientation;
    const audio::Bands& bands;
    const audio::Assembler& assembler;
    double length;
    std::uint64_t seed;
    Executor& executor;

    bool has_late() const { return !pair.late.energy.empty(); }

    ImpulseResponse mono() const {
        std::vector<ImpulseResponse> channels{assembler.assemble(arrivals, length, executor)};
        if (has_late()) {
            add_late({late_noise(bands, pair.late, channels.front().sample_rate, seed)},
                     length > 0.0,
                     channels);
        }
        return std::move(channels.front());
    }

    std::vector<ImpulseResponse> ambisonic(int order) const {
        auto channels = encode_ambisonic(assembler, arrivals, order, orientation, length, executor);
        if (has_late()) {
            add_late(ambisonic_late_noise(
                         bands, pair.late, channels.front().sample_rate, seed, order, orientation),
                     length > 0.0,
                     channels);
        }
        return channels;
    }

    std::vector<ImpulseResponse> binaural(const audio::HeadResponses& head) const {
        auto ears = render_binaural(assembler, arrivals, head, orientation, length, executor);
        std::vector<ImpulseResponse> channels{std::move(ears[0]), std::move(ears[1])};
        if (has_late()) {
            auto late = binaural_late_noise(bands, pair.late, head, seed, orientation);
            add_late({std::move(late[0]), std::move(late[1])}, length > 0.0, channels);
        }
        return channels;
    }
};

}  // namespace

HeardPair hear(const propagation::PairResult& pair,
               const propagation::Pose& listener,
               const Listening& listening,
               const audio::Bands& bands,
               const audio::Assembler& assembler,
               double length,
               std::uint64_t seed,
               Executor& executor) {
    const Call call{pair,
                    propagation::arrivals_of(pair),
                    orientation_of(listener),
                    bands,
                    assembler,
                    length,
                    seed,
                    executor};
    HeardPair heard;
    io::PairMetrics& metrics = heard.metrics;
    metrics.source = pair.source;
    metrics.listener = pair.listener;
    metrics.time = pair.time;
    const audio::MetricsOptions options = {.is_whole = pair.late.is_whole};
    switch (listening.format) {
        case Listening::Format::mono:
            heard.channels.push_back(call.mono());
            metrics.metrics = audio::room_metrics(bands, heard.channels.front(), options);
            break;
        case Listening::Format::ambisonic:
            heard.channels = call.ambisonic(listening.ambisonic_order);
            metrics.metrics = audio::room_metrics(bands, heard.channels.front(), options);
            if (listening.ambisonic_order > 0) {
                metrics.lateral =
                    audio::lateral_metrics(bands, heard.channels[0], heard.channels[1]);
            }
            break;
        case Listening::Format::binaural:
            heard.channels = call.binaural(listening.head);
            metrics.metrics = audio::room_metrics(bands, call.mono(), options);
            metrics.binaural = audio::binaural_metrics(bands, heard.channels[0], heard.channels[1]);
            break;
    }
    metrics.energy = audio::energy_metrics(bands, call.arrivals, pair.late);
    if (pair.volume_in_sight > 0.0) {
        metrics.schroeder_hz =
            audio::schroeder_frequency_hz(bands, metrics.energy, pair.volume_in_sight);
    }
    return heard;
}

}  // namespace earshot::cli
