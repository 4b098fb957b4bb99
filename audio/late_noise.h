// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/binaural.h"
#include "earshot/audio/energy_histogram.h"
#include "earshot/audio/filter_cache.h"

#include <cstdint>
#include <vector>

namespace earshot::audio {

/// Noise whose energy in each band and interval is that of a histogram: the sound of reflections
/// that arrive too densely to be resolved. It starts from velvet noise (Karjalainen and Jarvelainen
/// 2007): impulses of random sign whose density is the reflection density of the histogram, one at
/// a random time of each mean interval, and from white noise once that density exceeds half the
/// sample rate. The noise is split into bands by filters that sum to one, the envelope of its
/// energy is applied to each band, and the bands are added, so a flat histogram gives white noise.
/// An arrival of pressure p and an interval of energy p squared have the same energy in a band. The
/// result is a pure function of the arguments, the same bits on any machine, and bin * size seconds
/// long. Bands whose centre is not below half the sample rate are ignored. Preconditions: bin > 0,
/// energies are finite and not negative, sample_rate > 0.
std::vector<double> late_noise(const Bands& bands,
                               const EnergyHistogram& histogram,
                               double sample_rate,
                               std::uint64_t seed);
/// The same with filters that are kept.
std::vector<double> late_noise(const Bands& bands,
                               const EnergyHistogram& histogram,
                               double sample_rate,
                               std::uint64_t seed,
                               const FilterCache& cache);

/// White noise of variance 1 per sample, split by the band filters of late_noise(): a row per band
/// below half the sample rate, which add up to the noise. Weighted by envelopes of bands it gives
/// the late sound of any histogram at little cost, for programs that follow changes.
std::vector<std::vector<double>> band_noise(const Bands& bands,
                                            std::size_t length,
                                            double sample_rate,
                                            std::uint64_t seed,
                                            const FilterCache& cache);

/// The late sound of an ambisonic response (encode_ambisonic): independent noise from the middle
/// direction of each part of the sphere. Precondition: the histogram has directions, as well as
/// those of late_noise().
std::vector<std::vector<double>> ambisonic_late_noise(const Bands& bands,
                                                      const EnergyHistogram& histogram,
                                                      double sample_rate,
                                                      std::uint64_t seed,
                                                      int order,
                                                      const Orientation& orientation = {});
/// The same with filters that are kept.
std::vector<std::vector<double>> ambisonic_late_noise(const Bands& bands,
                                                      const EnergyHistogram& histogram,
                                                      double sample_rate,
                                                      std::uint64_t seed,
                                                      int order,
                                                      const Orientation& orientation,
                                                      const FilterCache& cache);

/// The late sound at both ears, left first, at the sample rate of the HRIRs: the noise of each part
/// of the sphere is convolved with the HRIRs of the part's middle direction. Preconditions: as
/// ambisonic_late_noise().
std::array<std::vector<double>, 2> binaural_late_noise(const Bands& bands,
                                                       const EnergyHistogram& histogram,
                                                       const HrirInterpolator& hrirs,
                                                       std::uint64_t seed,
                                                       const Orientation& orientation = {});
/// The same with filters that are kept.
std::array<std::vector<double>, 2> binaural_late_noise(const Bands& bands,
                                                       const EnergyHistogram& histogram,
                                                       const HrirInterpolator& hrirs,
                                                       std::uint64_t seed,
                                                       const Orientation& orientation,
                                                       const FilterCache& cache);

}  // namespace earshot::audio
