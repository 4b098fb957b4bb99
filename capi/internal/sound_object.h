// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/capi/internal/object_table.h"
#include "earshot/io/wav.h"

#include <utility>

namespace earshot::capi {

/// Never changes.
struct SoundObject : ObjectOf<ES_KIND_SOUND> {
    explicit SoundObject(io::Sound the_sound) : sound(std::move(the_sound)) {}
    io::Sound sound;
};

}  // namespace earshot::capi
