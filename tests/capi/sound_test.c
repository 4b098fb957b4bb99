// SPDX-License-Identifier: MIT
// Sounds: files, auralization, mixing.
#include "check.h"
#include <math.h>

static void check_samples(es_sound sound, const double* expected, size_t frames, size_t channels) {
    const double* samples = NULL;
    size_t frame_count = 0, channel_count = 0;
    CHECK_OK(es_sound_samples(sound, &samples, &frame_count, &channel_count, NULL));
    CHECK(frame_count == frames && channel_count == channels);
    for (size_t i = 0; i < frames * channels; ++i) {
        CHECK_NEAR(samples[i], expected[i], 1e-12);
    }
}

static void test_files(void) {
    const double stereo[] = {0.5, -0.5, 0.25, 1.5, 0.0, -0.125};
    es_sound sound = 0, read = 0;
    size_t clipped = 99, frames = 0, channels = 0;
    double rate = 0.0;
    const double* samples = NULL;
    CHECK_OK(es_sound_create(stereo, 3, 2, 44100.0, &sound));
    CHECK_OK(es_sound_write(sound, "stereo.wav", &clipped));
    CHECK(clipped == 0);
    CHECK_OK(es_sound_read("stereo.wav", &read));
    check_samples(read, stereo, 3, 2);
    CHECK_OK(es_sound_samples(read, &samples, &frames, &channels, &rate));
    CHECK_NEAR(rate, 44100.0, 0.0);
    CHECK_OK(es_release(read));
    CHECK_OK(es_sound_write(sound, "stereo.flac", &clipped));
    CHECK(clipped == 1);
    CHECK_OK(es_sound_write(sound, "stereo.ogg", NULL));
    CHECK_FAILS(ES_ERROR_FAILED, "stereo.mp3", es_sound_write(sound, "stereo.mp3", NULL));
    CHECK_FAILS(ES_ERROR_NULL, "file", es_sound_write(sound, NULL, NULL));
    CHECK_FAILS(ES_ERROR_FAILED, "none.wav", es_sound_read("none.wav", &read));
    CHECK_FAILS(ES_ERROR_NULL, "file", es_sound_read(NULL, &read));
    CHECK_FAILS(ES_ERROR_NULL, "sound", es_sound_read("stereo.wav", NULL));
    CHECK_FAILS(ES_ERROR_NULL, "samples", es_sound_samples(sound, NULL, &frames, &channels, &rate));
    CHECK_FAILS(
        ES_ERROR_NULL, "frame_count", es_sound_samples(sound, &samples, NULL, &channels, &rate));
    CHECK_FAILS(
        ES_ERROR_NULL, "channel_count", es_sound_samples(sound, &samples, &frames, NULL, &rate));
    CHECK_OK(es_release(sound));

    const double wrong[] = {0.0, NAN};
    CHECK_FAILS(ES_ERROR_ARGUMENT, "samples[1]", es_sound_create(wrong, 2, 1, 48000.0, &sound));
    CHECK_FAILS(ES_ERROR_NULL, "samples", es_sound_create(NULL, 2, 1, 48000.0, &sound));
    CHECK_FAILS(
        ES_ERROR_ARGUMENT, "samples", es_sound_create(stereo, SIZE_MAX / 2, 2, 48000.0, &sound));
    CHECK_FAILS(ES_ERROR_ARGUMENT, "channel_count", es_sound_create(stereo, 3, 0, 48000.0, &sound));
    CHECK_FAILS(
        ES_ERROR_ARGUMENT, "channel_count", es_sound_create(stereo, 3, SIZE_MAX, 48000.0, &sound));
    CHECK_FAILS(ES_ERROR_ARGUMENT, "sample_rate", es_sound_create(stereo, 3, 2, NAN, &sound));
    CHECK_FAILS(ES_ERROR_ARGUMENT, "sample_rate", es_sound_create(stereo, 3, 2, 0.0, &sound));
    CHECK_FAILS(ES_ERROR_NULL, "sound", es_sound_create(stereo, 3, 2, 48000.0, NULL));
}

static void test_auralization(void) {
    // 1, 2 through 1, 0, -1 and 0.5, 0, 0.
    const double dry_samples[] = {1.0, 2.0}, response_samples[] = {1.0, 0.5, 0.0, 0.0, -1.0, 0.0};
    const double expected[] = {1.0, 0.5, 2.0, 1.0, -1.0, 0.0, -2.0, 0.0};
    es_sound dry = 0, response = 0, wet = 0, mix = 0, empty = 0;
    CHECK_OK(es_sound_create(dry_samples, 2, 1, 48000.0, &dry));
    CHECK_OK(es_sound_create(response_samples, 3, 2, 48000.0, &response));
    CHECK_OK(es_auralize(dry, &response, 1, 1, &wet));
    check_samples(wet, expected, 4, 2);

    // Half of it, and it once more.
    const es_sound parts[] = {wet, wet};
    const double gains[] = {20.0 * -0.3010299956639812, 0.0};
    double sum[8];
    for (int i = 0; i < 8; ++i) {
        sum[i] = 1.5 * expected[i];
    }
    CHECK_OK(es_sound_mix(parts, gains, 2, 0.0, &mix));
    check_samples(mix, sum, 4, 2);
    CHECK_OK(es_release(mix));
    CHECK_OK(es_sound_mix(parts, NULL, 1, 96000.0, &mix));
    const double* samples = NULL;
    size_t frames = 0, channels = 0;
    double rate = 0.0;
    CHECK_OK(es_sound_samples(mix, &samples, &frames, &channels, &rate));
    CHECK(frames == 8 && channels == 2);
    CHECK_NEAR(rate, 96000.0, 0.0);
    CHECK_OK(es_release(mix));

    CHECK_FAILS(ES_ERROR_ARGUMENT, "responses", es_auralize(dry, &response, 0, 1, &wet));
    CHECK_FAILS(ES_ERROR_NULL, "responses", es_auralize(dry, NULL, 1, 1, &wet));
    CHECK_FAILS(ES_ERROR_ARGUMENT, "responses", es_auralize(dry, &response, SIZE_MAX, 1, &wet));
    CHECK_FAILS(ES_ERROR_HANDLE, "responses", es_auralize(dry, &empty, 1, 1, &wet));
    CHECK_FAILS(ES_ERROR_HANDLE, "dry", es_auralize(0, &response, 1, 1, &wet));
    CHECK_FAILS(ES_ERROR_ARGUMENT, "threads", es_auralize(dry, &response, 1, -1, &wet));
    CHECK_FAILS(ES_ERROR_NULL, "wet", es_auralize(dry, &response, 1, 1, NULL));
    CHECK_OK(es_sound_create(NULL, 0, 1, 48000.0, &empty));
    CHECK_FAILS(ES_ERROR_ARGUMENT, "no samples", es_auralize(empty, &response, 1, 1, &wet));
    const es_sound unequal[] = {dry, response};
    CHECK_FAILS(ES_ERROR_ARGUMENT, "channels", es_auralize(dry, unequal, 2, 1, &wet));
    CHECK_FAILS(ES_ERROR_ARGUMENT, "channels", es_sound_mix(unequal, NULL, 2, 0.0, &mix));
    const double loud[] = {201.0};
    CHECK_FAILS(ES_ERROR_ARGUMENT, "gains_db", es_sound_mix(&dry, loud, 1, 0.0, &mix));
    CHECK_FAILS(ES_ERROR_ARGUMENT, "sample_rate", es_sound_mix(&dry, NULL, 1, 48000.5, &mix));
    CHECK_FAILS(ES_ERROR_ARGUMENT, "sample_rate", es_sound_mix(&dry, NULL, 1, NAN, &mix));
    CHECK_FAILS(ES_ERROR_ARGUMENT, "sounds", es_sound_mix(&dry, NULL, 0, 0.0, &mix));
    CHECK_FAILS(ES_ERROR_NULL, "mix", es_sound_mix(&dry, NULL, 1, 0.0, NULL));
    CHECK_OK(es_release(empty));
    CHECK_OK(es_release(wet));
    CHECK_OK(es_release(response));
    CHECK_OK(es_release(dry));
}

// A source that comes nearer at 34.32 m/s, a tenth of the speed of sound, whose tone
// of 900 Hz is heard at 1000 Hz.
static void test_motion(void) {
    enum { RATE = 8000, FRAMES = 4000 };
    const double size[] = {60.0, 10.0, 10.0}, listener[] = {1.0, 5.0, 5.0};
    const double path[] = {0.0, 55.0, 5.0, 5.0, 1.0, 20.68, 5.0, 5.0};
    double tone[FRAMES];
    for (int n = 0; n < FRAMES; ++n) {
        tone[n] = sin(2.0 * 3.141592653589793 * 900.0 * n / RATE);
    }
    es_scene scene = 0;
    es_sound dry = 0, wet = 0, stereo = 0;
    CHECK_OK(es_scene_create_shoebox(size, &scene));
    CHECK_OK(es_scene_add(scene, ES_SOURCES, path + 1, NULL, 1, NULL));
    CHECK_OK(es_scene_add(scene, ES_LISTENERS, listener, NULL, 1, NULL));
    CHECK_OK(es_sound_create(tone, FRAMES, 1, RATE, &dry));
    CHECK_OK(es_sound_create(tone, FRAMES / 2, 2, RATE, &stereo));
    es_simulation_options simulation;
    CHECK_OK(es_simulation_options_init(&simulation, sizeof simulation));
    simulation.order = 0;
    simulation.rays = 0;
    simulation.air_absorption = 0;
    es_motion_options motion;
    CHECK_OK(es_motion_options_init(&motion, sizeof motion));
    motion.source_path = path;
    motion.source_path_count = 2;
    CHECK_OK(es_auralize_moving(scene, dry, &simulation, &motion, &wet));
    const double* samples = NULL;
    size_t frames = 0, channels = 0, crossings = 0;
    CHECK_OK(es_sound_samples(wet, &samples, &frames, &channels, NULL));
    CHECK(channels == 1 && frames >= FRAMES);
    for (size_t n = 2000; n < 4000; ++n) {
        crossings += samples[n] < 0.0 && samples[n + 1] >= 0.0 ? 1 : 0;
    }
    CHECK(crossings >= 249 && crossings <= 251);
    CHECK_OK(es_release(wet));

    CHECK_FAILS(ES_ERROR_NULL, "wet", es_auralize_moving(scene, dry, NULL, NULL, NULL));
    CHECK_FAILS(ES_ERROR_HANDLE, "scene", es_auralize_moving(0, dry, NULL, NULL, &wet));
    CHECK_FAILS(
        ES_ERROR_ARGUMENT, "dry", es_auralize_moving(scene, stereo, &simulation, &motion, &wet));
    motion.source = 1;
    CHECK_FAILS(ES_ERROR_INDEX,
                "motion->source",
                es_auralize_moving(scene, dry, &simulation, &motion, &wet));
    motion.source = 0;
    motion.step = 0.0;
    CHECK_FAILS(ES_ERROR_ARGUMENT,
                "motion->step",
                es_auralize_moving(scene, dry, &simulation, &motion, &wet));
    motion.step = 0.05;
    const double backwards[] = {1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 2.0};
    motion.listener_path = backwards;
    motion.listener_path_count = 2;
    CHECK_FAILS(ES_ERROR_ARGUMENT,
                "listener_path",
                es_auralize_moving(scene, dry, &simulation, &motion, &wet));
    motion.listener_path = NULL;
    CHECK_FAILS(
        ES_ERROR_NULL, "listener_path", es_auralize_moving(scene, dry, &simulation, &motion, &wet));
    CHECK_OK(es_release(stereo));
    CHECK_OK(es_release(dry));
    CHECK_OK(es_release(scene));
}

void test_sounds(void) {
    test_files();
    test_auralization();
    test_motion();
}
