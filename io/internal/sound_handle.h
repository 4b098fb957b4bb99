// SPDX-License-Identifier: MIT
#pragma once

#include <sndfile.h>

#include <memory>

namespace earshot::io {

struct CloseSound {
    void operator()(SNDFILE* sound) const noexcept { sf_close(sound); }
};
/// An open file of libsndfile.
using SoundHandle = std::unique_ptr<SNDFILE, CloseSound>;

}  // namespace earshot::io
