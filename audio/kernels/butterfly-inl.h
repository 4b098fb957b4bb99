// SPDX-License-Identifier: MIT
//
// Rows of complex numbers and discrete Fourier transforms of 2, 3, 4, 5 and 8 of them, in place.
#include "earshot/base/simd/lanes-inl.h"

#if defined(EARSHOT_AUDIO_KERNELS_BUTTERFLY_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef EARSHOT_AUDIO_KERNELS_BUTTERFLY_INL_H
#undef EARSHOT_AUDIO_KERNELS_BUTTERFLY_INL_H
#else
#define EARSHOT_AUDIO_KERNELS_BUTTERFLY_INL_H
#endif

HWY_BEFORE_NAMESPACE();
namespace earshot::audio::HWY_NAMESPACE {

using namespace earshot::HWY_NAMESPACE;

template <typename Row>
struct ComplexRow {
    Row re, im;
};

template <typename Row>
HWY_INLINE ComplexRow<Row> operator+(const ComplexRow<Row>& a, const ComplexRow<Row>& b) {
    return {a.re + b.re, a.im + b.im};
}
template <typename Row>
HWY_INLINE ComplexRow<Row> operator-(const ComplexRow<Row>& a, const ComplexRow<Row>& b) {
    return {a.re - b.re, a.im - b.im};
}
template <typename Row>
HWY_INLINE ComplexRow<Row> operator*(const ComplexRow<Row>& a, const ComplexRow<Row>& b) {
    return {a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
}
template <typename Row>
HWY_INLINE ComplexRow<Row> operator*(Row factor, const ComplexRow<Row>& a) {
    return {factor * a.re, factor * a.im};
}
/// a + i b.
template <typename Row>
HWY_INLINE ComplexRow<Row> plus_i(const ComplexRow<Row>& a, const ComplexRow<Row>& b) {
    return {a.re - b.im, a.im + b.re};
}
/// a - i b.
template <typename Row>
HWY_INLINE ComplexRow<Row> minus_i(const ComplexRow<Row>& a, const ComplexRow<Row>& b) {
    return {a.re + b.im, a.im - b.re};
}

template <typename Row>
HWY_INLINE void butterfly(ComplexRow<Row> (&x)[2]) {
    const ComplexRow<Row> difference = x[0] - x[1];
    x[0] = x[0] + x[1];
    x[1] = difference;
}

template <typename Row>
HWY_INLINE void butterfly(ComplexRow<Row> (&x)[3]) {
    const Row half(0.5);
    const Row sine(0.86602540378443864676);  // of a third of a turn
    const ComplexRow<Row> sum = x[1] + x[2];
    const ComplexRow<Row> middle = x[0] - half * sum;
    const ComplexRow<Row> side = sine * (x[1] - x[2]);
    x[0] = x[0] + sum;
    x[1] = minus_i(middle, side);
    x[2] = plus_i(middle, side);
}

template <typename Row>
HWY_INLINE void butterfly(ComplexRow<Row> (&x)[4]) {
    const ComplexRow<Row> even_sum = x[0] + x[2];
    const ComplexRow<Row> even_difference = x[0] - x[2];
    const ComplexRow<Row> odd_sum = x[1] + x[3];
    const ComplexRow<Row> odd_difference = x[1] - x[3];
    x[0] = even_sum + odd_sum;
    x[1] = minus_i(even_difference, odd_difference);
    x[2] = even_sum - odd_sum;
    x[3] = plus_i(even_difference, odd_difference);
}

template <typename Row>
HWY_INLINE void butterfly(ComplexRow<Row> (&x)[5]) {
    // Cosines and sines of a fifth and of two fifths of a turn.
    const Row cosine_1(0.30901699437494742410);
    const Row cosine_2(-0.80901699437494742410);
    const Row sine_1(0.95105651629515357212);
    const Row sine_2(0.58778525229247312917);
    const ComplexRow<Row> outer_sum = x[1] + x[4];
    const ComplexRow<Row> inner_sum = x[2] + x[3];
    const ComplexRow<Row> outer_difference = x[1] - x[4];
    const ComplexRow<Row> inner_difference = x[2] - x[3];
    const ComplexRow<Row> middle_1 = x[0] + (cosine_1 * outer_sum + cosine_2 * inner_sum);
    const ComplexRow<Row> middle_2 = x[0] + (cosine_2 * outer_sum + cosine_1 * inner_sum);
    const ComplexRow<Row> side_1 = sine_1 * outer_difference + sine_2 * inner_difference;
    const ComplexRow<Row> side_2 = sine_2 * outer_difference - sine_1 * inner_difference;
    x[0] = x[0] + (outer_sum + inner_sum);
    x[1] = minus_i(middle_1, side_1);
    x[2] = minus_i(middle_2, side_2);
    x[3] = plus_i(middle_2, side_2);
    x[4] = plus_i(middle_1, side_1);
}

template <typename Row>
HWY_INLINE void butterfly(ComplexRow<Row> (&x)[8]) {
    ComplexRow<Row> even[4] = {x[0], x[2], x[4], x[6]};
    ComplexRow<Row> odd[4] = {x[1], x[3], x[5], x[7]};
    butterfly(even);
    butterfly(odd);
    // Odd results are turned by eighths of a turn.
    const Row half_root(0.70710678118654752440);
    const ComplexRow<Row> eighth = half_root * minus_i(odd[1], odd[1]);
    const ComplexRow<Row> other = half_root * plus_i(odd[3], odd[3]);
    x[0] = even[0] + odd[0];
    x[4] = even[0] - odd[0];
    x[1] = even[1] + eighth;
    x[5] = even[1] - eighth;
    x[2] = minus_i(even[2], odd[2]);
    x[6] = plus_i(even[2], odd[2]);
    x[3] = even[3] - other;
    x[7] = even[3] + other;
}

}  // namespace earshot::audio::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
