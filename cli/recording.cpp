// SPDX-License-Identifier: MIT
#include "earshot/cli/recording.h"

#include "earshot/base/error.h"
#include "earshot/io/sound_file.h"
#include "earshot/io/sound_signal.h"

namespace earshot::cli {

audio::Signal read_signal(const std::string& file) {
    const io::Sound sound = io::read_sound(file);
    if (sound.samples.empty()) {
        throw Error(file, "holds no samples");
    }
    return io::signal_of(sound);
}

void require_mono(const std::string& file, const audio::Signal& recording) {
    if (recording.channels.size() != 1) {
        throw Error(file,
                    "has " + std::to_string(recording.channels.size()) + " channels",
                    "a source plays a mono recording");
    }
}

}  // namespace earshot::cli
