// SPDX-License-Identifier: MIT
#include "earshot/base/error.h"
#include "earshot/cli/audio_device.h"

namespace earshot::cli {
namespace {

[[noreturn]] void throw_missing() {
    throw Error("audio",
                "this program was built without audio devices",
                "write a file with -o, or build where PortAudio is installed (package "
                "portaudio19-dev)");
}

}  // namespace

struct AudioDevice::State {};

bool has_audio_devices() noexcept {
    return false;
}

AudioDevice::AudioDevice(const Settings& /*settings*/, Render /*render*/) {
    throw_missing();
}

AudioDevice::~AudioDevice() = default;

std::uint64_t AudioDevice::underflows() const noexcept {
    return 0;
}

std::vector<std::string> AudioDevice::names() {
    throw_missing();
}

}  // namespace earshot::cli
