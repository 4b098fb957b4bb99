// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/floating_point.h"
#include "earshot/base/large_array.h"

#include <cstddef>
#include <memory>
#include <span>

namespace earshot::audio {

/// A filter cut into parts of a block, whose spectra are kept in single precision (Gardner 1995;
/// uniform partitions, overlap-save). What plays it reads it alone.
class PartitionedFilter {
public:
    /// No filter: silence.
    PartitionedFilter() = default;
    /// `block`: a power of two of at least 4.
    PartitionedFilter(std::span<const double> taps, std::size_t block);

    std::size_t parts() const noexcept { return parts_; }
    /// Real parts, then imaginary ones, spectrum_stride(block) of each.
    const float* spectrum(std::size_t part) const noexcept {
        return numbers_.data() + part * 2 * stride_;
    }

private:
    std::size_t parts_ = 0;
    std::size_t stride_ = 0;
    LargeArray<float> numbers_;
};

/// Filters between several inputs and several outputs, block by block: output o is the sum over
/// inputs i of input i through filter i * outputs + o. For the threads of sound: process()
/// allocates nothing and takes no lock, and the filters may be others at each call.
class MatrixConvolver {
public:
    struct Settings {
        std::size_t inputs = 1;
        std::size_t outputs = 1;
        std::size_t block = 256;    ///< samples of a call, a power of two of at least 4
        std::size_t max_parts = 1;  ///< of a filter; later ones are not heard
    };

    explicit MatrixConvolver(const Settings& settings);
    ~MatrixConvolver();
    MatrixConvolver(MatrixConvolver&&) noexcept;
    MatrixConvolver& operator=(MatrixConvolver&&) noexcept;

    /// `in`: a block of each input, one after the other; `out`: likewise, which is overwritten.
    /// Precondition: one filter per input and output, each of the convolver's block.
    void process(const PartitionedFilter* filters, const float* in, float* out) noexcept;

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace earshot::audio
