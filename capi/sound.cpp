// SPDX-License-Identifier: MIT
#include "earshot/audio/auralization.h"
#include "earshot/base/math.h"
#include "earshot/base/parallel.h"
#include "earshot/capi/internal/checks.h"
#include "earshot/capi/internal/sound_object.h"
#include "earshot/capi/internal/work.h"
#include "earshot/io/sound_file.h"
#include "earshot/io/sound_signal.h"
#include "earshot/io/whole_file.h"

#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace earshot::capi {
namespace {

using audio::Signal;

// Hertz: those of `earshot auralize`, and what the formats of sound files hold.
constexpr double kMinRate = 1000.0, kMaxRate = 655350.0;
constexpr double kMaxSample = 1e12;
constexpr std::size_t kMaxChannels = 1024;
constexpr std::size_t kMaxInputs = 1U << 16U;

Signal signal_of(const io::Sound& sound, const char* argument) {
    if (sound.sample_rate != std::floor(sound.sample_rate)) {
        fail_argument(argument, "has a sample rate that is no whole number", "resample it");
    }
    if (sound.samples.empty()) {
        fail_argument(argument, "holds no samples", "give a sound that does");
    }
    return io::signal_of(sound);
}

std::shared_ptr<SoundObject> object_of(const Signal& signal) {
    return std::make_shared<SoundObject>(io::sound_of(signal));
}

/// The signals of an array of handles.
std::vector<Signal> signals_of(const es_sound* sounds, std::size_t count, const char* argument) {
    const auto handles = require_array(sounds, count, argument);
    if (count == 0 || count > kMaxInputs) {
        fail_argument(argument,
                      "are " + std::to_string(count) + " sounds",
                      "give 1 ... " + std::to_string(kMaxInputs));
    }
    std::vector<Signal> signals;
    for (const es_sound handle : handles) {
        const Reading<SoundObject> object(handle, argument);
        signals.push_back(signal_of(object->sound, argument));
        if (signals.back().channels.size() != signals.front().channels.size()) {
            fail_argument(argument, "differ in their numbers of channels", "give equal numbers");
        }
    }
    return signals;
}

/// What a receiver hears of a recording: as `earshot auralize` has it.
Signal auralized(Signal dry, const std::vector<Signal>& responses, Executor& executor) {
    if (!audio::channels_fit(dry, responses.front())) {
        fail_argument("responses",
                      "have " + std::to_string(responses.front().channels.size()) +
                          " channels, the recording " + std::to_string(dry.channels.size()),
                      "one of them must have a single channel, or both the same number");
    }
    for (const Signal& response : responses) {
        if (response.sample_rate != responses.front().sample_rate) {
            fail_argument(
                "responses", "differ in their sample rates", "give responses of one receiver");
        }
    }
    return audio::auralize(std::move(dry), responses, executor);
}

}  // namespace

audio::Signal mono_recording(const SoundObject& dry) {
    if (dry.sound.channels != 1 || dry.sound.samples.empty()) {
        fail_argument("dry",
                      "has " + std::to_string(dry.sound.channels) + " channels and " +
                          std::to_string(dry.sound.samples.size()) + " samples",
                      "a source plays a recording of one channel");
    }
    return signal_of(dry.sound, "dry");
}

}  // namespace earshot::capi

using namespace earshot;
using namespace earshot::capi;

es_status es_sound_create(const double* samples,
                          size_t frame_count,
                          size_t channel_count,
                          double sample_rate,
                          es_sound* sound) {
    return call(__func__, [&] {
        require_count(channel_count, 1, kMaxChannels, "channel_count");
        require_in(sample_rate, kMinRate, kMaxRate, "sample_rate");
        static_cast<void>(require_array(samples, frame_count, "samples"));
        const auto given = require_array(samples, frame_count * channel_count, "samples");
        for (std::size_t i = 0; i < given.size(); ++i) {
            if (!(std::abs(given[i]) <= kMaxSample)) {
                fail_argument("samples[" + std::to_string(i) + "]",
                              "is beyond 1e12 or not a number",
                              "give samples whose full scale is 1");
            }
        }
        require(sound, "sound");
        *sound = publish(
            std::make_shared<SoundObject>(io::Sound{.sample_rate = sample_rate,
                                                    .channels = static_cast<int>(channel_count),
                                                    .samples = {given.begin(), given.end()}}));
    });
}

es_status es_sound_read(const char* file, es_sound* sound) {
    return call(__func__, [&] {
        const std::string path(require_text(file, "file"));
        require(sound, "sound");
        *sound = publish(std::make_shared<SoundObject>(io::read_sound(path)));
    });
}

es_status es_sound_write(es_sound sound, const char* file, size_t* clipped) {
    return call(__func__, [&] {
        const Reading<SoundObject> object(sound, "sound");
        const std::string path(require_text(file, "file"));
        const io::SoundFormat format = io::sound_format_of(path);
        io::write_whole_file(path, io::encode_sound(object->sound, format));
        if (clipped != nullptr) {
            *clipped =
                format == io::SoundFormat::wav ? 0 : io::count_beyond_full_scale(object->sound);
        }
    });
}

es_status es_sound_samples(es_sound sound,
                           const double** samples,
                           size_t* frame_count,
                           size_t* channel_count,
                           double* sample_rate) {
    return call(__func__, [&] {
        const Reading<SoundObject> object(sound, "sound");
        const auto channels = static_cast<std::size_t>(object->sound.channels);
        require(samples, "samples");
        require(frame_count, "frame_count");
        require(channel_count, "channel_count");
        if (sample_rate != nullptr) {
            *sample_rate = object->sound.sample_rate;
        }
        *samples = object->sound.samples.data();
        *frame_count = object->sound.samples.size() / channels;
        *channel_count = channels;
    });
}

es_status es_auralize(es_sound dry,
                      const es_sound* responses,
                      size_t response_count,
                      int32_t threads,
                      es_sound* wet) {
    return call(__func__, [&] {
        const Reading<SoundObject> object(dry, "dry");
        require(wet, "wet");
        require_threads(threads, "threads");
        const std::vector<Signal> filters = signals_of(responses, response_count, "responses");
        Executor executor(threads);
        *wet = publish(object_of(auralized(signal_of(object->sound, "dry"), filters, executor)));
    });
}

es_status es_sound_mix(const es_sound* sounds,
                       const double* gains_db,
                       size_t count,
                       double sample_rate,
                       es_sound* mix) {
    return call(__func__, [&] {
        constexpr double kMaxGainDb = 200.0;
        require(mix, "mix");
        std::vector<Signal> parts = signals_of(sounds, count, "sounds");
        for (std::size_t i = 0; gains_db != nullptr && i < count; ++i) {
            require_in(gains_db[i], -kMaxGainDb, kMaxGainDb, "gains_db");
        }
        if (sample_rate != 0.0) {
            require_in(sample_rate, kMinRate, kMaxRate, "sample_rate");
        }
        if (sample_rate != std::floor(sample_rate)) {
            fail_argument("sample_rate", "is no whole number", "give a whole number of hertz");
        }
        Signal sum{.sample_rate =
                       sample_rate == 0.0 ? parts.front().sample_rate : std::llround(sample_rate)};
        sum.channels.resize(parts.front().channels.size());
        for (std::size_t i = 0; i < count; ++i) {
            audio::resample_to(sum.sample_rate, parts[i]);
            audio::add_scaled(
                parts[i], gains_db == nullptr ? 1.0 : math::pow10(gains_db[i] / 20.0), sum);
        }
        *mix = publish(object_of(sum));
    });
}
