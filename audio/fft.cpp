// SPDX-License-Identifier: MIT
#include "earshot/audio/internal/fft.h"

#include "earshot/base/assert.h"
#include "earshot/base/math.h"

#include <algorithm>
#include <array>
#include <bit>

namespace earshot::audio {

namespace {

using Complex = std::complex<double>;

constexpr std::size_t kWidest = 8;  // doubles of the widest register

/// Points exp(-2 pi i k / size), from the sines and cosines of the first eighth of a turn, which
/// are computed by the functions that have the same bits everywhere.
class UnitCircle {
public:
    explicit UnitCircle(std::size_t size) : scale_(size % 8 == 0 ? 1 : 2), size_(scale_ * size) {
        EARSHOT_ASSERT(size % 4 == 0);
        for (std::size_t k = 0; k <= size_ / 8; ++k) {
            const double angle =
                2.0 * math::kPi * static_cast<double>(k) / static_cast<double>(size_);
            eighth_.emplace_back(math::cos(angle), math::sin(angle));
        }
    }

    /// Precondition: k < size.
    Complex at(std::size_t k) const {
        const std::size_t eighth = size_ / 8;
        const std::size_t octant = scale_ * k / eighth;
        const std::size_t after = scale_ * k % eighth;
        // From the nearest axis, forward in even octants and backward in odd ones.
        const bool backward = octant % 2 != 0;
        const Complex point = eighth_[backward ? eighth - after : after];
        const double x = point.real();
        const double y = backward ? -point.imag() : point.imag();
        switch ((octant + 1) / 2 % 4) {
            case 0:
                return {x, -y};
            case 1:
                return {-y, -x};
            case 2:
                return {-x, y};
            default:
                return {y, x};
        }
    }

private:
    std::size_t scale_;
    std::size_t size_;
    std::vector<Complex> eighth_;  // cosines and sines
};

bool is_fft_size(std::size_t size) {
    const std::size_t odd = size >> std::countr_zero(size);
    return size >= 4 && size % 4 == 0 && (odd == 1 || odd == 3 || odd == 5);
}

/// Radices of the passes: few, and 4 as long as rows are short.
std::vector<std::size_t> radices_of(std::size_t size) {
    auto twos = static_cast<std::size_t>(std::countr_zero(size));
    const std::size_t odd = size >> twos;
    std::vector<std::size_t> radices;
    const std::size_t eights =
        twos < 5 ? twos % 2 * (twos / 3) : (twos - 2) % 2 + (twos - 4) / 6 * 2;
    twos -= 3 * eights;
    for (; twos >= 2; twos -= 2) {
        radices.push_back(4);
    }
    radices.insert(radices.end(), eights, 8);
    if (twos == 1) {
        radices.push_back(2);
    }
    if (odd > 1) {
        radices.push_back(odd);
    }
    return radices;
}

/// The twiddle factors exp(-2 pi i j p / (r b)) of a pass of radix r and b blocks: per block, those
/// of j = 1 ... r - 1. In a wide first pass, for each j real parts of all blocks, then imaginary
/// parts.
void append_twiddles(const FftPass& pass,
                     bool wide,
                     const UnitCircle& circle,
                     std::size_t circle_size,
                     LargeArray<double>& out) {
    const std::size_t step = circle_size / (pass.radix * pass.blocks);
    const std::size_t begin = out.size();
    const std::size_t others = pass.radix - 1;
    out.resize(begin + 2 * others * pass.blocks);
    for (std::size_t p = 0; p < pass.blocks; ++p) {
        for (std::size_t j = 0; j < others; ++j) {
            const Complex factor = circle.at((j + 1) * p * step);
            const std::size_t re = wide ? 2 * j * pass.blocks + p : 2 * (others * p + j);
            out[begin + re] = factor.real();
            out[begin + re + (wide ? pass.blocks : 1)] = factor.imag();
        }
    }
}

const double* numbers_of(std::span<const Complex> values) {
    // std::complex<double> is layout-compatible with two doubles ([complex.numbers]/4).
    return reinterpret_cast<const double*>(values.data());
}

}  // namespace

FftBuffers FftWorkspace::buffers(std::size_t size) {
    // Rows of a cache line between the arrays keep them from competing for the same sets.
    const std::size_t apart = (size + kWidest - 1) / kWidest * kWidest + 3 * kWidest;
    if (numbers_.size() < 4 * apart) {
        numbers_.resize(4 * apart);
    }
    double* begin = numbers_.data();
    return {.first = {begin, begin + apart}, .second = {begin + 2 * apart, begin + 3 * apart}};
}

RealFft::RealFft(std::size_t size) : size_(size) {
    EARSHOT_ASSERT(is_fft_size(size));
    const UnitCircle circle(size);
    const std::size_t half = size / 2;
    std::size_t stride = 1;
    std::vector<std::size_t> begins;
    for (const std::size_t radix : radices_of(half)) {
        const FftPass pass = {
            .radix = radix, .blocks = half / stride / radix, .stride = stride, .twiddles = nullptr};
        begins.push_back(factors_.size());
        if (pass.blocks > 1) {
            append_twiddles(pass, stride == 1 && has_wide_first_pass(half), circle, size, factors_);
        }
        passes_.push_back(pass);
        stride *= radix;
    }
    const std::size_t turn = half / 2 + 1;
    for (std::size_t k = 0; k < turn; ++k) {
        factors_.push_back(circle.at(k).real());
    }
    for (std::size_t k = 0; k < turn; ++k) {
        factors_.push_back(circle.at(k).imag());
    }
    for (std::size_t i = 0; i < passes_.size(); ++i) {
        passes_[i].twiddles = passes_[i].blocks > 1 ? factors_.data() + begins[i] : nullptr;
    }
}

FftPlan RealFft::plan() const noexcept {
    const std::size_t turn = size_ / 4 + 1;
    const double* end = factors_.data() + factors_.size();
    return {.size = size_ / 2,
            .passes = passes_,
            .half_turn_re = end - 2 * turn,
            .half_turn_im = end - turn};
}

void RealFft::forward(std::span<const double> signal,
                      std::span<Complex> spectrum,
                      FftWorkspace& workspace) const {
    EARSHOT_ASSERT(signal.size() == size_ && spectrum.size() == bins());
    transform_real(plan(),
                   signal.data(),
                   workspace.buffers(size_ / 2),
                   reinterpret_cast<double*>(spectrum.data()));
}

void RealFft::forward(std::span<const double> signal, std::span<Complex> spectrum) const {
    FftWorkspace workspace;
    forward(signal, spectrum, workspace);
}

void RealFft::inverse(std::span<const Complex> spectrum,
                      std::span<double> signal,
                      FftWorkspace& workspace) const {
    EARSHOT_ASSERT(signal.size() == size_ && spectrum.size() == bins());
    transform_to_real(plan(),
                      numbers_of(spectrum),
                      nullptr,
                      1.0 / static_cast<double>(size_),
                      workspace.buffers(size_ / 2),
                      signal.data());
}

void RealFft::inverse(std::span<const Complex> spectrum, std::span<double> signal) const {
    FftWorkspace workspace;
    inverse(spectrum, signal, workspace);
}

void RealFft::filtered_inverse(std::span<const Complex> spectrum,
                               std::span<const double> gains,
                               std::span<double> signal,
                               FftWorkspace& workspace) const {
    EARSHOT_ASSERT(signal.size() == size_ && spectrum.size() == bins() && gains.size() == bins());
    transform_to_real(plan(),
                      numbers_of(spectrum),
                      gains.data(),
                      1.0 / static_cast<double>(size_),
                      workspace.buffers(size_ / 2),
                      signal.data());
}

std::size_t power_of_two_from(std::size_t min_size) noexcept {
    return std::bit_ceil(min_size);
}

std::size_t fft_size_from(std::size_t min_size) noexcept {
    std::size_t best = std::bit_ceil(std::max<std::size_t>(min_size, 4));
    for (const std::size_t odd : {std::size_t{3}, std::size_t{5}}) {
        const std::size_t twos =
            std::bit_ceil(std::max<std::size_t>((min_size + odd - 1) / odd, 4));
        best = std::min(best, odd * twos);
    }
    return best;
}

}  // namespace earshot::audio
