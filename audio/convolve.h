// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

namespace earshot::audio {

/// Convolution with a long filter, block by block: the filter is cut into parts of equal length
/// whose spectra are kept, so that memory and delay do not grow with the signal (Gardner 1995;
/// uniform partitions, overlap-save). Feed blocks in order; one object per stream.
class PartitionedConvolver {
public:
    /// `block`: samples per call, a power of two of at least 2. Precondition: the filter is not
    /// empty.
    PartitionedConvolver(std::span<const double> filter, std::size_t block);
    ~PartitionedConvolver();
    PartitionedConvolver(PartitionedConvolver&&) noexcept;
    PartitionedConvolver& operator=(PartitionedConvolver&&) noexcept;

    /// The next block of the convolution. Precondition: both are a block long.
    void process(std::span<const double> in, std::span<double> out);

private:
    struct State;
    std::unique_ptr<State> state_;
};

/// The whole convolution: signal.size() + filter.size() - 1 samples; none if either is empty. The
/// same bits on any machine.
std::vector<double> convolve(std::span<const double> signal, std::span<const double> filter);

/// The same as a sum of products, for short filters.
std::vector<double> convolve_directly(std::span<const double> signal,
                                      std::span<const double> filter);

/// Convolution with a filter that changes while the signal plays: the filters follow each other in
/// equal shares of the signal, and what goes into two neighbours is cross-faded linearly from the
/// middle of one's share to the middle of the next's, so that nothing clicks. With one filter it is
/// convolve(). As long as the longest filter makes it. Precondition: there is a filter.
std::vector<double> convolve_moving(std::span<const double> signal,
                                    std::span<const std::vector<double>> filters,
                                    Executor& executor = Executor::serial());

/// The same with filters at places of their own: `places`, ascending, one per filter, are samples
/// of the signal, which may lie outside of it. The first filter holds before its place, the last
/// after its own.
std::vector<double> convolve_moving(std::span<const double> signal,
                                    std::span<const std::vector<double>> filters,
                                    std::span<const double> places,
                                    Executor& executor = Executor::serial());

}  // namespace earshot::audio
