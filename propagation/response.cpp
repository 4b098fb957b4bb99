// SPDX-License-Identifier: MIT
#include "earshot/propagation/response.h"

#include "earshot/audio/binaural.h"
#include "earshot/audio/energy_metrics.h"
#include "earshot/audio/response_metrics.h"
#include "earshot/audio/spatial.h"
#include "earshot/base/error.h"
#include "earshot/base/random.h"
#include "earshot/propagation/internal/response_parts.h"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

namespace earshot::propagation {
namespace {

using audio::ImpulseResponse;
using Signals = std::vector<std::vector<double>>;

/// Adds late sound to early channels; a fixed length stays as it is.
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

/// The values of a response stay where those that are expected are too uncertain: they are what was
/// written. It is told that another seed would give others.
void note_uncertain(const audio::Bands& bands, PairMetrics& metrics) {
    const auto note = [&](std::string metric, std::optional<double> band_hz) {
        metrics.response.notes.push_back(
            {.metric = std::move(metric),
             .band_hz = band_hz,
             .text = "of one realisation, whose expected value is too uncertain"});
    };
    // An error without a value: it was withheld.
    const audio::RoomMetrics& expected = metrics.expected;
    for (const audio::BandMetricKind& kind : audio::kBandMetricKinds) {
        for (std::size_t band = 0; band < bands.count(); ++band) {
            if (expected.standard_error.bands[band].*kind.value &&
                !(expected.bands[band].*kind.value)) {
                note(std::string(kind.key), bands.nominal_hz()[band]);
            }
        }
    }
    if (expected.standard_error.speech_transmission_index && !expected.speech_transmission_index) {
        note("sti", {});
    }
}

}  // namespace

/// One pair under way.
class ResponseRenderer::Rendering {
public:
    Rendering(const ResponseRenderer& renderer,
              const PairResult& pair,
              const Pose& listener,
              Executor& executor)
        : bands_(renderer.bands_),
          format_(renderer.format_),
          assembler_(renderer.assembler_),
          hrirs_(renderer.hrirs_),
          cache_(renderer.cache_),
          pair_(pair),
          arrivals_(arrivals_of(pair)),
          orientation_(orientation_of(listener)),
          seed_(random_bits(renderer.format_.seed, pair.key, 0)),
          executor_(executor) {}

    Response render() const {
        Response response;
        PairMetrics& metrics = response.metrics;
        metrics.source = pair_.source;
        metrics.listener = pair_.listener;
        metrics.time = pair_.time;
        std::vector<ImpulseResponse>& channels = response.channels;
        switch (format_.channels) {
            case Channels::mono:
                channels.push_back(mono());
                break;
            case Channels::ambisonic:
                channels = ambisonic();
                break;
            case Channels::binaural:
                channels = binaural();
                break;
        }
        if (format_.report_metrics) {
            measure(channels, metrics);
        }
        return response;
    }

private:
    void measure(const std::vector<ImpulseResponse>& channels, PairMetrics& metrics) const {
        metrics.expected =
            energy_metrics(bands_,
                           energy_arrivals_of(pair_),
                           pair_.late,
                           {.replicates = &pair_.late_replicates, .speech = format_.speech});
        // ISO 3382-1 measures the room without the head: at two ears, the pressure at its centre.
        const bool binaural = format_.channels == Channels::binaural;
        metrics.response =
            response_metrics(bands_,
                             binaural ? mono() : channels.front(),
                             {.full_decay = pair_.late.full_decay, .speech = format_.speech},
                             cache_);
        note_uncertain(bands_, metrics);
        if (format_.channels == Channels::ambisonic && format_.ambisonic_order > 0) {
            metrics.lateral = lateral_metrics(bands_, channels[0], channels[1], {}, cache_);
        }
        if (binaural) {
            metrics.binaural = binaural_metrics(bands_, channels[0], channels[1], cache_);
        }
        if (pair_.visible_volume > 0.0) {
            metrics.schroeder_hz =
                schroeder_frequency_hz(bands_, metrics.expected, pair_.visible_volume);
        }
    }

private:
    bool has_late() const { return !pair_.late.energy.empty(); }
    bool fixed_length() const { return format_.length > 0.0; }
    Signals late(Channels channels) const {
        return late_channels({.bands = bands_,
                              .format = format_,
                              .channels = channels,
                              .hrirs = hrirs_,
                              .cache = cache_,
                              .seed = seed_},
                             pair_.late,
                             orientation_);
    }

    ImpulseResponse mono() const {
        std::vector<ImpulseResponse> channels{
            assembler_.assemble(arrivals_, format_.length, executor_)};
        if (has_late()) {
            add_late(late(Channels::mono), fixed_length(), channels);
        }
        return std::move(channels.front());
    }

    std::vector<ImpulseResponse> ambisonic() const {
        const int order = format_.ambisonic_order;
        auto channels =
            encode_ambisonic(assembler_, arrivals_, order, orientation_, format_.length, executor_);
        if (has_late()) {
            add_late(late(Channels::ambisonic), fixed_length(), channels);
        }
        return channels;
    }

    std::vector<ImpulseResponse> binaural() const {
        auto ears = render_binaural(
            assembler_, arrivals_, *hrirs_, orientation_, format_.length, executor_);
        std::vector<ImpulseResponse> channels{std::move(ears[0]), std::move(ears[1])};
        if (has_late()) {
            add_late(late(Channels::binaural), fixed_length(), channels);
        }
        return channels;
    }

    const audio::Bands& bands_;
    const ResponseFormat& format_;
    const audio::Assembler& assembler_;
    const std::optional<audio::HrirInterpolator>& hrirs_;
    const audio::FilterCache& cache_;
    const PairResult& pair_;
    std::vector<audio::Arrival> arrivals_;
    audio::Orientation orientation_;
    std::uint64_t seed_;
    Executor& executor_;
};

ResponseRenderer::ResponseRenderer(const audio::Bands& bands, ResponseFormat format)
    : bands_(bands),
      format_(checked_format(std::move(format))),
      assembler_(bands_, format_.sample_rate),
      hrirs_(prepared_hrirs(format_)) {}

Response ResponseRenderer::render(const PairResult& pair,
                                  const Pose& listener,
                                  Executor& executor) const {
    return Rendering(*this, pair, listener, executor).render();
}

Response render_response(const audio::Bands& bands,
                         const PairResult& pair,
                         const Pose& listener,
                         const ResponseFormat& format,
                         Executor& executor) {
    return ResponseRenderer(bands, format).render(pair, listener, executor);
}

}  // namespace earshot::propagation
