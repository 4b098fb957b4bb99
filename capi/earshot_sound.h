// SPDX-License-Identifier: MIT
//
// Sounds: files, auralization, sums.
// Part of earshot.h, which says what holds for all.
#ifndef EARSHOT_SOUND_H
#define EARSHOT_SOUND_H

#include "earshot_base.h"

/// A sound from samples, (frame_count, channel_count), full scale is 1.
ES_API es_status es_sound_create(const double* samples,
                                 size_t frame_count,
                                 size_t channel_count,
                                 double sample_rate,
                                 es_sound* sound);
/// Reads WAV, FLAC, OGG or AIFF.
ES_API es_status es_sound_read(const char* file, es_sound* sound);
/// Writes 32-bit float .wav, 24-bit .flac or Vorbis .ogg, whole or not at all. `clipped`, which may
/// be null: how many samples were beyond full scale and lost. Reads `sound`.
ES_API es_status es_sound_write(es_sound sound, const char* file, size_t* clipped);
/// Its samples, (frame_count, channel_count), as a view. Reads `sound`.
ES_API es_status es_sound_samples(es_sound sound,
                                  const double** samples,
                                  size_t* frame_count,
                                  size_t* channel_count,
                                  double* sample_rate);
/// Convolves a dry recording with the responses of one receiver, in order of time: they are applied
/// to equal parts of the recording in turn and cross-faded, as `earshot auralize` does. The
/// recording is resampled to the rate of the responses. Reads `dry` and `responses`.
ES_API es_status es_auralize(
    es_sound dry, const es_sound* responses, size_t response_count, int32_t threads, es_sound* wet);
/// Several sounds of as many channels added, each times the factor of its `gain_db` (null: 0 dB),
/// at `sample_rate` (0: that of the first). Reads `sounds`.
ES_API es_status es_sound_mix(const es_sound* sounds,
                              const double* gains_db,
                              size_t count,
                              double sample_rate,
                              es_sound* mix);

#endif
