// SPDX-License-Identifier: MIT
#include "earshot/audio/filter_cache.h"

#include "earshot/audio/internal/filter_cache_state.h"

namespace earshot::audio {

FilterCache::FilterCache() : state_(std::make_unique<State>()) {}
FilterCache::~FilterCache() = default;
FilterCache::FilterCache(FilterCache&&) noexcept = default;
FilterCache& FilterCache::operator=(FilterCache&&) noexcept = default;

}  // namespace earshot::audio
