// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/auralization.h"
#include "earshot/capi/internal/object_table.h"
#include "earshot/io/wav.h"

#include <utility>

namespace earshot::capi {

/// Never changes.
struct SoundObject : ObjectOf<ES_KIND_SOUND> {
    explicit SoundObject(io::Sound the_sound) : sound(std::move(the_sound)) {}
    io::Sound sound;
};

/// A recording that a source plays. Throws Failure, which names the argument "dry", if it is not
/// one channel with samples at a whole rate.
audio::Signal mono_recording(const SoundObject& dry);

}  // namespace earshot::capi
