// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/energy_histogram.h"

#include <cstdint>
#include <vector>

namespace earshot::audio {

/// Noise whose energy in each band and interval is that of a histogram: what many reflections sound
/// like that arrive too densely to be told apart. White noise is split by filters that sum to one,
/// each band takes the course of its energy, and the bands are added, so a flat histogram gives
/// white noise. An arrival of pressure p and an interval of energy p squared have the same energy
/// in a band. A pure function of the seed, the same bits on any machine. bin * size seconds long;
/// bands whose centre is not below half the sample rate are ignored. Preconditions: bin > 0,
/// energies are finite and not negative, sample_rate > 0.
std::vector<double> late_noise(const Bands& bands,
                               const EnergyHistogram& histogram,
                               double sample_rate,
                               std::uint64_t seed);

}  // namespace earshot::audio
