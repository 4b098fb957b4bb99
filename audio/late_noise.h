// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/binaural.h"
#include "earshot/audio/energy_histogram.h"

#include <cstdint>
#include <vector>

namespace earshot::audio {

/// Noise whose energy in each band and interval is that of a histogram: the sound of reflections
/// that arrive too densely to be told apart. Unit impulses of random sign follow each other as
/// densely as the histogram's reflections, one at a random instant of each mean interval (velvet
/// noise: Karjalainen and Jarvelainen 2007), white noise where that is denser than half the
/// samples. They are split by filters that sum to one, each band is given the envelope of its
/// energy, and the bands are added, so a flat histogram gives white noise. An arrival of pressure p
/// and an interval of energy p squared have the same energy in a band. A pure function of the seed,
/// the same bits on any machine. bin * size seconds long; bands whose centre is not below half the
/// sample rate are ignored. Preconditions: bin > 0, energies are finite and not negative,
/// sample_rate > 0.
std::vector<double> late_noise(const Bands& bands,
                               const EnergyHistogram& histogram,
                               double sample_rate,
                               std::uint64_t seed);

/// The late sound of an ambisonic response (encode_ambisonic): noise of its own from the middle of
/// each part of the sphere. Precondition: the histogram has directions, as well as those of
/// late_noise().
std::vector<std::vector<double>> ambisonic_late_noise(const Bands& bands,
                                                      const EnergyHistogram& histogram,
                                                      double sample_rate,
                                                      std::uint64_t seed,
                                                      int order,
                                                      const Orientation& orientation = {});

/// The same at both ears, left first, through the head responses nearest to the parts' middles.
/// Preconditions: as ambisonic_late_noise(); the head responses have this sample rate, and there is
/// one.
std::array<std::vector<double>, 2> binaural_late_noise(const Bands& bands,
                                                       const EnergyHistogram& histogram,
                                                       const HrirSet& head,
                                                       std::uint64_t seed,
                                                       const Orientation& orientation = {});

}  // namespace earshot::audio
