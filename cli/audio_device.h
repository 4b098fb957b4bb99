// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace earshot::cli {

/// Whether this program was built with access to audio devices (PortAudio).
bool has_audio_devices() noexcept;

/// The output of an audio device, which calls back for its samples on a thread of its own.
class AudioDevice {
public:
    struct Settings {
        std::string name{};  ///< part of the device's name; empty: the default device
        double sample_rate = 48000.0;
        std::size_t channels = 2;
        std::size_t block = 256;  ///< samples of each channel per call
    };

    /// Fills `frames` samples of each channel. Must neither wait nor allocate nor throw.
    using Render = std::function<void(float* const* channels, std::size_t frames)>;

    /// Opens the device and begins to call. Throws Error if there is none of that name, or if it
    /// does not take so many channels at that rate.
    AudioDevice(const Settings& settings, Render render);
    /// Ends the calls.
    ~AudioDevice();
    AudioDevice(const AudioDevice&) = delete;
    AudioDevice& operator=(const AudioDevice&) = delete;

    /// How often samples came too late.
    std::uint64_t underflows() const noexcept;

    /// Names of the devices that have an output.
    static std::vector<std::string> names();

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace earshot::cli
