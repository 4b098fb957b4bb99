// SPDX-License-Identifier: MIT
#include "earshot/audio/internal/fft_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "earshot/audio/fft_kernel.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which includes this file again for every instruction set.
#include "earshot/audio/kernels/butterfly-inl.h"

#include <utility>

HWY_BEFORE_NAMESPACE();
namespace earshot::audio::HWY_NAMESPACE {

// Stockham's transform (Van Loan 1992, section 1.7): the passes write their results in the order
// that the next one reads, so numbers never need sorting. Pass by pass, x[q + s (p + b j)], j < r,
// becomes y[q + s (r p + j)], p < b, q < s, of radix r, stride s and b blocks. Every number is the
// result of the same operations at any width; lanes only tell which are computed together.

/// As many numbers as a register holds, four at most.
using UpToFour = Lanes<double, (Doubles::kCount < 4 ? Doubles::kCount : 4)>;
using One = Lanes<double, 1>;

/// An array of pairs to read.
struct PairSource {
    const double* pairs;
    template <typename Row>
    HWY_INLINE ComplexRow<Row> load(std::size_t i) const {
        const auto pair = load_pairs<Row>(pairs + 2 * i);
        return {pair.first, pair.second};
    }
};

/// An array of pairs to write, imaginary parts first.
struct SwappedPairSink {
    double* pairs;
    template <typename Row>
    HWY_INLINE void store(std::size_t i, const ComplexRow<Row>& z) const {
        store_pairs(z.im, z.re, pairs + 2 * i);
    }
};

struct Split {
    double* re;
    double* im;
    template <typename Row>
    HWY_INLINE ComplexRow<Row> load(std::size_t i) const {
        return {Row::load_unaligned(re + i), Row::load_unaligned(im + i)};
    }
    template <typename Row>
    HWY_INLINE void store(std::size_t i, const ComplexRow<Row>& z) const {
        z.re.store_unaligned(re + i);
        z.im.store_unaligned(im + i);
    }
};

/// A pass of butterflies side by side whose twiddle factors are the same. Rows divide the stride.
template <std::size_t kRadix, typename Row, typename Source, typename Sink>
void run_strided(const FftPass& pass, Source in, Sink out) {
    const std::size_t stride = pass.stride;
    const std::size_t apart = stride * pass.blocks;
    const double* factor = pass.twiddles;
    for (std::size_t p = 0; p < pass.blocks; ++p) {
        ComplexRow<Row> twiddle[kRadix];
        for (std::size_t j = 1; j < kRadix && factor != nullptr; ++j) {
            twiddle[j] = {Row(factor[2 * j - 2]), Row(factor[2 * j - 1])};
        }
        for (std::size_t q = 0; q < stride; q += Row::kCount) {
            ComplexRow<Row> x[kRadix];
            for (std::size_t j = 0; j < kRadix; ++j) {
                x[j] = in.template load<Row>(q + stride * p + apart * j);
            }
            butterfly(x);
            out.store(q + stride * kRadix * p, x[0]);
            for (std::size_t j = 1; j < kRadix; ++j) {
                out.store(q + stride * (kRadix * p + j),
                          factor != nullptr ? x[j] * twiddle[j] : x[j]);
            }
        }
        factor += factor != nullptr ? 2 * (kRadix - 1) : 0;
    }
}

/// The first pass, of radix 4: a row of butterflies, each with its own twiddle factors.
template <typename Source>
void run_first(const FftPass& pass, Source in, Split out) {
    const std::size_t blocks = pass.blocks;
    const auto twiddle = [&](std::size_t j, std::size_t p) {
        const double* row = pass.twiddles + 2 * blocks * (j - 1) + p;
        return ComplexRow<Doubles>{Doubles::load_unaligned(row),
                                   Doubles::load_unaligned(row + blocks)};
    };
    for (std::size_t p = 0; p < blocks; p += Doubles::kCount) {
        ComplexRow<Doubles> x[4];
        for (std::size_t j = 0; j < 4; ++j) {
            x[j] = in.template load<Doubles>(p + blocks * j);
        }
        butterfly(x);
        for (std::size_t j = 1; j < 4; ++j) {
            x[j] = x[j] * twiddle(j, p);
        }
        store_fours(x[0].re, x[1].re, x[2].re, x[3].re, out.re + 4 * p);
        store_fours(x[0].im, x[1].im, x[2].im, x[3].im, out.im + 4 * p);
    }
}

template <std::size_t kRadix, typename Source, typename Sink>
void run_radix(const FftPass& pass, Source in, Sink out) {
    if (pass.stride % 8 == 0) {
        run_strided<kRadix, Doubles>(pass, in, out);
    } else if (pass.stride % 4 == 0) {
        run_strided<kRadix, UpToFour>(pass, in, out);
    } else {
        run_strided<kRadix, One>(pass, in, out);
    }
}

template <typename Source, typename Sink>
void run(const FftPass& pass, Source in, Sink out) {
    switch (pass.radix) {
        case 2:
            return run_strided<2, One>(pass, in, out);
        case 3:
            return run_radix<3>(pass, in, out);
        case 4:
            return run_radix<4>(pass, in, out);
        case 5:
            return run_radix<5>(pass, in, out);
        default:
            return run_radix<8>(pass, in, out);
    }
}

/// Runs all passes from `first` on but the last `left`. Afterwards at.first holds the numbers.
void run_between(const FftPlan& plan, std::size_t first, std::size_t left, FftBuffers& at) {
    for (std::size_t i = first; i + left < plan.passes.size(); ++i) {
        run(plan.passes[i], Split{at.first.re, at.first.im}, Split{at.second.re, at.second.im});
        std::swap(at.first, at.second);
    }
}

Split split(const SplitComplex& array) {
    return {array.re, array.im};
}

/// Calls step(Row, k) for rows from k on that end before `end`.
template <typename Row, typename Step>
HWY_INLINE std::size_t for_each_row(std::size_t k, std::size_t end, const Step& step) {
    for (; k + Row::kCount <= end; k += Row::kCount) {
        step(Row(), k);
    }
    return k;
}

template <typename Row>
HWY_INLINE ComplexRow<Row> reversed(const ComplexRow<Row>& z) {
    return {reverse(z.re), reverse(z.im)};
}

/// The spectrum X of the real signal from the complex transform Z. The even samples' transform is E
/// = (Z[k] + conj Z[n-k]) / 2, the odd ones' O = (Z[k] - conj Z[n-k]) / 2i, and X = E + w O.
void separate(const FftPlan& plan, Split z, double* spectrum) {
    const std::size_t size = plan.size;
    const double re = z.re[0];
    const double im = z.im[0];
    spectrum[0] = re + im;
    spectrum[1] = 0.0;
    spectrum[2 * size] = re - im;
    spectrum[2 * size + 1] = 0.0;
    const auto step = [&](auto row, std::size_t k) {
        using Row = decltype(row);
        const std::size_t mirrored = size - k - (Row::kCount - 1);
        const ComplexRow<Row> a = z.load<Row>(k);
        const ComplexRow<Row> b = reversed(z.load<Row>(mirrored));  // its conjugate is meant
        const Row half(0.5);
        const ComplexRow<Row> even = {half * (a.re + b.re), half * (a.im - b.im)};
        const ComplexRow<Row> odd = {half * (a.im + b.im), half * (b.re - a.re)};
        const ComplexRow<Row> w = {Row::load_unaligned(plan.half_turn_re + k),
                                   Row::load_unaligned(plan.half_turn_im + k)};
        const ComplexRow<Row> turned = w * odd;
        store_pairs(even.re + turned.re, even.im + turned.im, spectrum + 2 * k);
        store_pairs(
            reverse(even.re - turned.re), reverse(turned.im - even.im), spectrum + 2 * mirrored);
    };
    const std::size_t end = size / 2 + 1;
    for_each_row<One>(for_each_row<Doubles>(1, end, step), end, step);
}

/// The complex spectrum Z of even and odd samples, real and imaginary parts exchanged, of a real
/// signal's spectrum: separate() undone, without the factor 1 / 2 that is in `scale`.
template <bool kGains>
void combine(
    const FftPlan& plan, const double* spectrum, const double* gains, double scale, Split z) {
    const std::size_t size = plan.size;
    const double first = spectrum[0] * (kGains ? gains[0] : 1.0);
    const double last = spectrum[2 * size] * (kGains ? gains[size] : 1.0);
    z.im[0] = scale * (first + last);
    z.re[0] = scale * (first - last);
    const auto step = [&](auto row, std::size_t k) {
        using Row = decltype(row);
        const std::size_t mirrored = size - k - (Row::kCount - 1);
        const PairSource source{spectrum};
        ComplexRow<Row> a = source.load<Row>(k);
        ComplexRow<Row> b = source.load<Row>(mirrored);
        if constexpr (kGains) {
            const Row gain = Row::load_unaligned(gains + k);
            const Row mirrored_gain = Row::load_unaligned(gains + mirrored);
            a = {a.re * gain, a.im * gain};
            b = {b.re * mirrored_gain, b.im * mirrored_gain};
        }
        b = reversed(b);  // its conjugate is meant
        const ComplexRow<Row> sum = {a.re + b.re, a.im - b.im};
        const ComplexRow<Row> difference = {a.re - b.re, a.im + b.im};
        const ComplexRow<Row> w = {Row::load_unaligned(plan.half_turn_re + k),
                                   Row::load_unaligned(plan.half_turn_im + k)};
        // conj(w) times the difference.
        const ComplexRow<Row> turned = {w.re * difference.re + w.im * difference.im,
                                        w.re * difference.im - w.im * difference.re};
        const Row factor(scale);
        z.store(k, ComplexRow<Row>{factor * (sum.im + turned.re), factor * (sum.re - turned.im)});
        z.store(mirrored,
                reversed(
                    ComplexRow<Row>{factor * (turned.re - sum.im), factor * (sum.re + turned.im)}));
    };
    const std::size_t end = size / 2 + 1;
    for_each_row<One>(for_each_row<Doubles>(1, end, step), end, step);
}

void forward(const FftPlan& plan,
             const double* signal,
             const FftBuffers& buffers,
             double* spectrum) {
    FftBuffers at = buffers;
    const PairSource in{signal};
    if (has_wide_first_pass(plan.size)) {
        run_first(plan.passes[0], in, split(at.first));
    } else {
        run(plan.passes[0], in, split(at.first));
    }
    run_between(plan, 1, 0, at);
    separate(plan, split(at.first), spectrum);
}

void inverse(const FftPlan& plan,
             const double* spectrum,
             const double* gains,
             double scale,
             const FftBuffers& buffers,
             double* signal) {
    FftBuffers at = buffers;
    if (gains != nullptr) {
        combine<true>(plan, spectrum, gains, scale, split(at.first));
    } else {
        combine<false>(plan, spectrum, gains, scale, split(at.first));
    }
    std::size_t done = 0;
    if (has_wide_first_pass(plan.size)) {
        run_first(plan.passes[0], split(at.first), split(at.second));
        std::swap(at.first, at.second);
        done = 1;
    }
    run_between(plan, done, 1, at);
    run(plan.passes.back(), split(at.first), SwappedPairSink{signal});
}

}  // namespace earshot::audio::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace earshot::audio {

HWY_EXPORT(forward);
HWY_EXPORT(inverse);

void transform_real(const FftPlan& plan,
                    const double* signal,
                    const FftBuffers& buffers,
                    double* spectrum) {
    HWY_DYNAMIC_DISPATCH(forward)(plan, signal, buffers, spectrum);
}

void transform_to_real(const FftPlan& plan,
                       const double* spectrum,
                       const double* gains,
                       double scale,
                       const FftBuffers& buffers,
                       double* signal) {
    HWY_DYNAMIC_DISPATCH(inverse)(plan, spectrum, gains, scale, buffers, signal);
}

}  // namespace earshot::audio
#endif
