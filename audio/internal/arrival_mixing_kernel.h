// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>

namespace earshot::audio {

/// Samples of one signal that lie side by side in a chunk of SourceLines.
inline constexpr std::size_t kLineChunk = 16;

/// Several signals of one length: chunk k holds kLineChunk samples of each in turn. Chunks are a
/// ring.
struct ChunkRing {
    const float* numbers = nullptr;
    std::size_t signals = 0;
    std::size_t mask = 0;  ///< number of chunks, a power of two, less 1
};

/// The weight of a signal, linear over samples.
struct SignalWeight {
    std::uint32_t signal = 0;
    float weight = 0.0F;  ///< at sample `origin`
    float step = 0.0F;    ///< per sample
};

/// out[n] = sum of (weight + (n - origin) step) * signal[n] for `chunks` chunks from `first` on.
void mix_signals(const ChunkRing& ring,
                 std::size_t first,
                 std::size_t chunks,
                 const SignalWeight* weights,
                 std::size_t count,
                 float origin,
                 float* out);

/// A delay in samples, a cubic of the sample's number.
struct DelayPolynomial {
    double constant = 0.0, linear = 0.0, square = 0.0, cube = 0.0;
};

/// values[n] = (the signal at `begin` + n - delay(n)) / max(delay(n) * distance_per_sample,
/// min_distance), for a multiple of 8 samples. `rows`: ShortDelayTable::rows(). Preconditions: all
/// positions are at least kShortDelayLead and leave as many samples behind them; delays are
/// positive.
void read_delayed(const float* signal,
                  const float* rows,
                  double begin,
                  const DelayPolynomial& delay,
                  double distance_per_sample,
                  double min_distance,
                  std::size_t count,
                  float* values);

/// channel[n] += (gain + n * step) * values[n] of every channel, `stride` apart, for a multiple of
/// 8 samples.
void add_to_channels(const float* values,
                     std::size_t count,
                     const float* gains,
                     const float* steps,
                     std::size_t channels,
                     std::size_t stride,
                     float* out);

/// sum += a * b, added up over `parts` rows of each, one after the other. A row is `count` (a
/// multiple of 8) real parts, then as many imaginary ones.
void add_complex_products(
    const float* a, const float* b, std::size_t parts, std::size_t count, float* sum);

}  // namespace earshot::audio
