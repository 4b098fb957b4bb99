// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <optional>
#include <span>

namespace earshot::audio {

/// First sample less than 20 dB below the largest (ISO 3382-1:2009, A.3.4); nothing if all are 0.
std::optional<std::size_t> find_onset(std::span<const double> samples);

}  // namespace earshot::audio
