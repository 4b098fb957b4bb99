// SPDX-License-Identifier: MIT
#include "earshot/audio/internal/block_transform.h"

#include <algorithm>

namespace earshot::audio {

BlockTransform::BlockTransform(std::size_t block)
    : fft_(2 * block), window_(2 * block, 0.0), bins_(fft_.bins()) {
    fft_.forward(window_, bins_, workspace_);  // brings the workspace to its size
}

void BlockTransform::split(float* spectrum) const noexcept {
    const std::size_t imaginary = stride();
    for (std::size_t k = 0; k < bins_.size(); ++k) {
        spectrum[k] = static_cast<float>(bins_[k].real());
        spectrum[imaginary + k] = static_cast<float>(bins_[k].imag());
    }
    for (std::size_t k = bins_.size(); k < imaginary; ++k) {
        spectrum[k] = 0.0F;
        spectrum[imaginary + k] = 0.0F;
    }
}

void BlockTransform::forward_of_filter(const double* taps,
                                       std::size_t count,
                                       float* spectrum) noexcept {
    std::copy(taps, taps + count, window_.begin());
    std::fill(window_.begin() + static_cast<std::ptrdiff_t>(count), window_.end(), 0.0);
    fft_.forward(window_, bins_, workspace_);
    split(spectrum);
}

void BlockTransform::forward(const float* before, const float* now, float* spectrum) noexcept {
    std::copy(before, before + block(), window_.begin());
    std::copy(now, now + block(), window_.begin() + static_cast<std::ptrdiff_t>(block()));
    fft_.forward(window_, bins_, workspace_);
    split(spectrum);
}

void BlockTransform::inverse(const float* spectrum, float* signal) noexcept {
    const std::size_t imaginary = stride();
    for (std::size_t k = 0; k < bins_.size(); ++k) {
        bins_[k] = {static_cast<double>(spectrum[k]), static_cast<double>(spectrum[imaginary + k])};
    }
    fft_.inverse(bins_, window_, workspace_);
    for (std::size_t n = 0; n < block(); ++n) {
        signal[n] = static_cast<float>(window_[block() + n]);  // the first half is wrapped around
    }
}

}  // namespace earshot::audio
