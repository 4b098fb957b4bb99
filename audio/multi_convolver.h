// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/floating_point.h"

#include <cstddef>
#include <memory>
#include <span>

namespace earshot::audio {

/// Several signals, each through a long filter, added up block by block: channel c is the sum over
/// filters m of filter m convolved with signal m * channels + c. Filters are cut into parts of a
/// block whose spectra are kept (Gardner 1995; uniform partitions, overlap-save). Feed blocks in
/// order; one object per stream.
class MultiConvolver {
public:
    /// `block`: samples per call, a power of two of at least 2. Precondition: no filter is empty.
    MultiConvolver(std::span<const std::span<const double>> filters,
                   std::size_t channels,
                   std::size_t block);
    ~MultiConvolver();
    MultiConvolver(MultiConvolver&&) noexcept;
    MultiConvolver& operator=(MultiConvolver&&) noexcept;

    std::size_t block() const noexcept;
    std::size_t channels() const noexcept;
    std::size_t signals() const noexcept;  ///< filters times channels

    /// The next block of all signals, one after the other, and of all channels. Allocates nothing.
    /// Preconditions: in.size() == signals() * block(), out.size() == channels() * block().
    void process(std::span<const double> in, std::span<double> out) noexcept;

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace earshot::audio
