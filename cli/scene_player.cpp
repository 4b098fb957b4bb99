// SPDX-License-Identifier: MIT
#include "earshot/cli/scene_player.h"

#include "earshot/cli/audio_device.h"
#include "earshot/propagation/pose.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>
#include <utility>

namespace earshot::cli {
namespace {

using propagation::Emitter;

/// The scene with its emitters where their ways begin.
propagation::Scene at_start(const Programme& programme) {
    propagation::Scene scene = programme.scene;
    for (std::vector<Emitter>* emitters : {&scene.sources, &scene.listeners}) {
        for (Emitter& emitter : *emitters) {
            if (const auto way = programme.ways.find(emitter.name); way != programme.ways.end()) {
                emitter.position = way->second.at(programme.start).position;
                emitter.node = -1;
            }
        }
    }
    return scene;
}

propagation::EngineOptions beginning_at(double time, propagation::EngineOptions options) {
    options.start_time = time;
    return options;
}

/// Recordings of whole blocks.
Programme padded(Programme programme, std::size_t block) {
    for (std::vector<float>& recording : programme.recordings) {
        recording.resize((recording.size() + block - 1) / block * block, 0.0F);
    }
    return programme;
}

}  // namespace

ScenePlayer::ScenePlayer(Programme programme,
                         const propagation::EngineOptions& options,
                         Executor& executor)
    : programme_(padded(std::move(programme), options.block)),
      engine_(at_start(programme_), beginning_at(programme_.start, options), executor),
      inputs_(engine_.sources(), nullptr) {}

// What is published now is heard motion_delay later.
void ScenePlayer::publish(std::size_t frame) {
    const double time = programme_.start + engine_.options().motion_delay +
                        static_cast<double>(frame) / engine_.sample_rate();
    const auto place = [&](const std::vector<Emitter>& emitters, auto place_at) {
        for (std::size_t i = 0; i < emitters.size(); ++i) {
            if (const auto way = programme_.ways.find(emitters[i].name);
                way != programme_.ways.end()) {
                propagation::Pose pose = programme_.scene.pose_at(emitters[i], time);
                pose.position = way->second.at(time).position;
                place_at(i, pose);
            }
        }
    };
    place(programme_.scene.sources,
          [this](std::size_t i, const propagation::Pose& pose) { engine_.place_source(i, pose); });
    place(programme_.scene.listeners, [this](std::size_t i, const propagation::Pose& pose) {
        engine_.place_listener(i, pose);
    });
    engine_.set_scene_time(time);
    engine_.publish();
}

void ScenePlayer::render_block(float* const* outputs, std::size_t frames) noexcept {
    for (std::size_t i = 0; i < inputs_.size(); ++i) {
        const std::vector<float>& recording = programme_.recordings[i];
        inputs_[i] = position_ + frames <= recording.size() ? &recording[position_] : nullptr;
    }
    engine_.render(inputs_.data(), outputs, frames);
    position_ += frames;
}

audio::Signal ScenePlayer::render(Progress& progress) {
    const std::size_t block = engine_.options().block;
    const std::size_t total = programme_.frames + engine_.latency();
    const auto blocks_per_update = std::max<std::size_t>(
        1,
        static_cast<std::size_t>(std::lround(engine_.options().update_interval *
                                             engine_.sample_rate() / static_cast<double>(block))));
    audio::Signal signal{.sample_rate = std::lround(engine_.sample_rate())};
    signal.channels.resize(engine_.channels());
    std::vector<float> rendered(engine_.channels() * block);
    std::vector<float*> outputs;
    for (std::size_t channel = 0; channel < engine_.channels(); ++channel) {
        outputs.push_back(&rendered[channel * block]);
        signal.channels[channel].reserve(total + block);
    }
    for (std::size_t i = 0; i * block < total; ++i) {
        if (i % blocks_per_update == 0) {
            publish(i * block);
            engine_.update();
            progress.report("sound", i * block, total);
        }
        render_block(outputs.data(), block);
        for (std::size_t channel = 0; channel < engine_.channels(); ++channel) {
            signal.channels[channel].insert(
                signal.channels[channel].end(), outputs[channel], outputs[channel] + block);
        }
    }
    for (std::vector<double>& channel : signal.channels) {
        channel.erase(channel.begin(),
                      channel.begin() + static_cast<std::ptrdiff_t>(engine_.latency()));
        channel.resize(programme_.frames);
    }
    return signal;
}

std::uint64_t ScenePlayer::play(const std::string& device, Progress& progress) {
    constexpr std::chrono::milliseconds kPublishInterval(10);
    publish(0);
    engine_.start();
    std::uint64_t underflows = 0;
    {
        const AudioDevice output(
            {.name = device,
             .sample_rate = engine_.sample_rate(),
             .channels = engine_.channels(),
             .block = engine_.options().block},
            [this](float* const* channels, std::size_t frames) { render_block(channels, frames); });
        for (std::uint64_t frame = 0; frame < programme_.frames;
             frame = engine_.frames_rendered()) {
            publish(frame);
            progress.report("sound", frame, programme_.frames);
            std::this_thread::sleep_for(kPublishInterval);
        }
        underflows = output.underflows();
    }
    engine_.stop();
    return underflows;
}

}  // namespace earshot::cli
