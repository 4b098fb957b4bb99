// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/floating_point.h"

#include <memory>

namespace earshot::audio {

/// Band filters, Fourier transforms and working memory that late noise and metrics of responses
/// share. They are made when a response first needs them and depend on bands, sample rate and
/// length alone, so a result is the same with any cache. Filters of the lengths used last are kept,
/// about 128 MiB of them. Const members may be called, and a cache may be lent to functions, from
/// many threads at once.
class FilterCache {
public:
    FilterCache();
    ~FilterCache();
    FilterCache(FilterCache&&) noexcept;
    FilterCache& operator=(FilterCache&&) noexcept;

    struct State;
    /// For the functions of this folder.
    State& state() const noexcept { return *state_; }

private:
    std::unique_ptr<State> state_;
};

}  // namespace earshot::audio
