// SPDX-License-Identifier: MIT
#include "earshot/cli/audio_device.h"

#include "earshot/base/error.h"
#include "earshot/base/spelling.h"

#include <atomic>
#include <fcntl.h>
#include <portaudio.h>
#include <unistd.h>
#include <utility>

namespace earshot::cli {
namespace {

void require(PaError result, const std::string& subject) {
    if (result != paNoError) {
        throw Error(subject, Pa_GetErrorText(result), "choose another with --device, or use -o");
    }
}

/// Standard error goes nowhere while one exists: the libraries below PortAudio print a line there
/// for every kind of device that is not present.
class SilencedStandardError {
public:
    SilencedStandardError() : kept_(dup(STDERR_FILENO)), nowhere_(open("/dev/null", O_WRONLY)) {
        dup2(nowhere_, STDERR_FILENO);
    }
    ~SilencedStandardError() {
        dup2(kept_, STDERR_FILENO);
        close(kept_);
        close(nowhere_);
    }
    SilencedStandardError(const SilencedStandardError&) = delete;
    SilencedStandardError& operator=(const SilencedStandardError&) = delete;

private:
    int kept_, nowhere_;
};

PaError initialize() {
    const SilencedStandardError silenced;
    return Pa_Initialize();
}

/// PortAudio as long as it exists.
class Session {
public:
    Session() { require(initialize(), "audio"); }
    ~Session() { Pa_Terminate(); }
    Session(const Session&) = delete;
    Session& operator=(const Session&) = delete;
};

std::vector<std::pair<PaDeviceIndex, std::string>> outputs() {
    std::vector<std::pair<PaDeviceIndex, std::string>> found;
    for (PaDeviceIndex i = 0; i < Pa_GetDeviceCount(); ++i) {
        const PaDeviceInfo* device = Pa_GetDeviceInfo(i);
        if (device != nullptr && device->maxOutputChannels > 0) {
            found.emplace_back(i, device->name);
        }
    }
    return found;
}

PaDeviceIndex find_device(const std::string& name) {
    if (name.empty()) {
        const PaDeviceIndex device = Pa_GetDefaultOutputDevice();
        if (device == paNoDevice) {
            throw Error("audio", "there is no output device", "write a file with -o");
        }
        return device;
    }
    std::vector<std::string> names;
    for (const auto& [index, full_name] : outputs()) {
        if (full_name.find(name) != std::string::npos) {
            return index;
        }
        names.push_back(full_name);
    }
    throw Error(name,
                "there is no such output device",
                did_you_mean(name, names, "earshot play --list-devices lists them"));
}

}  // namespace

struct AudioDevice::State {
    Session session{};
    Render render;
    PaStream* stream = nullptr;
    std::atomic<std::uint64_t> underflows{0};

    static int call_back(const void* /*input*/,
                         void* output,
                         unsigned long frames,
                         const PaStreamCallbackTimeInfo* /*time*/,
                         PaStreamCallbackFlags flags,
                         void* data) {
        auto& state = *static_cast<State*>(data);
        if ((flags & paOutputUnderflow) != 0) {
            state.underflows.fetch_add(1, std::memory_order_relaxed);
        }
        state.render(static_cast<float* const*>(output), frames);
        return paContinue;
    }
};

bool has_audio_devices() noexcept {
    return true;
}

AudioDevice::AudioDevice(const Settings& settings, Render render)
    : state_(std::make_unique<State>()) {
    state_->render = std::move(render);
    PaStreamParameters parameters = {};
    parameters.device = find_device(settings.name);
    const PaDeviceInfo& device = *Pa_GetDeviceInfo(parameters.device);
    parameters.channelCount = static_cast<int>(settings.channels);
    parameters.sampleFormat = paFloat32 | paNonInterleaved;
    parameters.suggestedLatency = device.defaultLowOutputLatency;
    require(Pa_OpenStream(&state_->stream,
                          nullptr,
                          &parameters,
                          settings.sample_rate,
                          settings.block,
                          paNoFlag,
                          State::call_back,
                          state_.get()),
            device.name);
    if (const PaError started = Pa_StartStream(state_->stream); started != paNoError) {
        Pa_CloseStream(state_->stream);
        require(started, device.name);
    }
}

AudioDevice::~AudioDevice() {
    Pa_StopStream(state_->stream);
    Pa_CloseStream(state_->stream);
}

std::uint64_t AudioDevice::underflows() const noexcept {
    return state_->underflows.load(std::memory_order_relaxed);
}

std::vector<std::string> AudioDevice::names() {
    const Session session;
    std::vector<std::string> names;
    for (const auto& output : outputs()) {
        names.push_back(output.second);
    }
    return names;
}

}  // namespace earshot::cli
