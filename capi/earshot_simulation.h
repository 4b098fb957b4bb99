// SPDX-License-Identifier: MIT
//
// Simulation and its results.
// Part of earshot.h, which says what holds for all.
#ifndef EARSHOT_SIMULATION_H
#define EARSHOT_SIMULATION_H

#include "earshot_base.h"

typedef enum es_mode {
    ES_MODE_COMPLETE = 0,  ///< finds every path
    ES_MODE_SAMPLED = 1    ///< faster, may miss paths at edges
} es_mode;

typedef enum es_format {
    ES_FORMAT_MONO = 0,
    ES_FORMAT_BINAURAL = 1,  ///< left, right
    ES_FORMAT_AMBISONIC = 2  ///< (order + 1)^2 channels, ACN, SN3D
} es_format;

/// The options of `earshot ir`, with its defaults (in brackets); the same options give the same
/// numbers.
typedef struct es_simulation_options {
    size_t struct_size;
    double time;              ///< instant of the scene's animation, seconds (0); of es_simulate()
    int32_t order;            ///< max reflections and transmissions of an exact path, 0 ... 64 (4)
    int32_t mode;             ///< es_mode (complete)
    int32_t resolution;       ///< sub-frusta along a cube face, 0 ... 1024; 0: the default (0)
    int32_t transmission;     ///< 1: sound also goes through materials that transmit (0)
    double max_length;        ///< of a path, metres; 0: no limit (0)
    double min_level_db;      ///< of a path, re the source at 1 m; -inf: no limit (-inf)
    uint64_t rays;            ///< of late sound, at most, up to 1e9; 0: none (1000000)
    double rays_error;        ///< standard error of T30 at which rays suffice, a share of it,
                              ///< 0.001 ... 1; 0: all rays are traced (0.02)
    uint64_t seed;            ///< of rays and noise, 0 ... 2^63 - 1 (1)
    double temperature_c;     ///< of the air, degrees Celsius (20)
    double humidity_percent;  ///< relative (50)
    double pressure_kpa;      ///< (101.325)
    int32_t air_absorption;   ///< 1: the air absorbs (1)
    int32_t bands;            ///< es_bands (octave)
    int32_t format;           ///< es_format (mono)
    int32_t ambisonic_order;  ///< 0 ... 5 (1)
    const char* hrtf_file;    ///< SOFA file of a binaural format; null: a KEMAR manikin (null)
    double sample_rate;       ///< hertz, 1000 ... 768000 (48000)
    double length;            ///< of a response, seconds, 0 ... 3600; 0: until it has decayed (0)
    int32_t hrtf_raw;         ///< 1: the HRIR set as measured: not equalised, delays kept (0)
    int32_t responses;        ///< 1: impulse responses (1)
    int32_t metrics;          ///< 1: metrics, for which responses are made, too (1)
    int32_t histograms;       ///< 1: keep the energy histograms of late sound (0)
    int32_t keep_traces;      ///< 1: an es_simulator keeps beam trees from run to run: for points
                              ///< and parts of the geometry that move. Changes no result (0)
    int32_t speech;          ///< 1: STI of speech of the level below in the noise below; 0: of loud
                             ///< speech in a quiet room (0)
    double speech_level_db;  ///< A-weighted, 1 m in front of the talker, -200 ... 200 (60)
    const double* noise_db;  ///< (7) octave levels at the listener, 125 Hz ... 8 kHz; null: none
    es_visible_sets visible_sets;   ///< paths are left out whose first reflection is not in the set
                                    ///< of their source's cell; 0: none are (0)
    es_progress_callback progress;  ///< null: nobody wants to know (null)
    void* progress_data;            ///< its first argument
    int32_t threads;                ///< 0: one per core; changes no result (0)
    int32_t sofa;         ///< 1: keep what es_results_write_sofa() needs: responses of 64 bits (0)
    int32_t paths;        ///< 1: tell the paths; 0: none, in boxes in less time; changes no
                          ///< response and no metric (1)
    int32_t sensitivity;  ///< 1: tell which surfaces matter, es_result_sensitivity(); needs
                          ///< the paths (0)
    int32_t diffraction;  ///< max edges that a path bends round: 1, beside its reflections, or 2
                          ///< in turn without any (0)
    double min_diffraction_level_db;  ///< of a path round an edge in its loudest band, re the
                                      ///< direct sound if nothing were in the way; -inf: no limit
                                      ///< (-40)
} es_simulation_options;

/// Sets all members to their defaults, `struct_size` to `size`.
ES_API es_status es_simulation_options_init(es_simulation_options* options, size_t size);

/// Octave levels of the noise criterion curve NC-`number` (15 ... 70), 125 Hz ... 8 kHz, decibels.
ES_API es_status es_noise_criterion(double number, double levels_db[7]);

/// Simulates all pairs of a source and a listener at one instant. `options` null: the defaults.
/// Reads `scene`.
ES_API es_status es_simulate(es_scene scene,
                             const es_simulation_options* options,
                             es_result* result);

/// Prepares a copy of a scene for es_simulator_run(), which tells `progress` of the options. Reads
/// `scene`, which may be changed or released afterwards, as may what the options point to but
/// `progress_data`.
ES_API es_status es_simulator_create(es_scene scene,
                                     const es_simulation_options* options,
                                     es_simulator* simulator);
/// The result at `time` (seconds, of the animation): that of es_simulate(), in less time. Changes
/// `simulator`.
ES_API es_status es_simulator_run(es_simulator simulator, double time, es_result* result);
/// As es_scene_set_position() and es_scene_set_look_at(), for the next run. Change `simulator`.
ES_API es_status es_simulator_set_position(es_simulator simulator,
                                           int32_t item,
                                           uint32_t index,
                                           const double position[3]);
ES_API es_status es_simulator_set_look_at(es_simulator simulator,
                                          int32_t item,
                                          uint32_t index,
                                          const double* point);

// --- Results. They never change: every function below reads `result`, and views are valid until
// it is released. `source` and `listener` are indices of the scene.

typedef struct es_result_info {
    size_t struct_size;
    size_t sources;
    size_t listeners;
    size_t channels;        ///< of a response
    size_t samples;         ///< of the longest response; 0 without responses
    size_t bands;           ///< frequency bands
    size_t paths;           ///< of all pairs
    double sample_rate;     ///< hertz
    double time;            ///< seconds, of the animation
    double speed_of_sound;  ///< metres per second
    size_t triangles;       ///< that take part, after clean-up
    size_t facets;          ///< into which they were joined
    uint64_t frusta;        ///< that were traced
} es_result_info;

/// `info->struct_size` must be set.
ES_API es_status es_result_get_info(es_result result, es_result_info* info);
/// The nominal centres of its bands, hertz.
ES_API es_status es_result_bands(es_result result, const double** nominal_hz, size_t* count);

/// All impulse responses in one block, (sources, listeners, channels, samples): pressure re the
/// source's free field at 1 m, sample 0 is the instant of emission. Shorter ones end in zeros. The
/// numbers are those of the WAV files of `earshot ir`.
ES_API es_status es_result_responses(es_result result, const float** samples, size_t shape[4]);
/// How long each response is, (sources, listeners) samples.
ES_API es_status es_result_lengths(es_result result, const uint64_t** lengths, size_t shape[2]);
/// One response as a sound of its own length.
ES_API es_status es_result_sound(es_result result, size_t source, size_t listener, es_sound* sound);

typedef enum es_path_kind {
    ES_PATH_DIRECT = 0,
    ES_PATH_SPECULAR = 1,
    ES_PATH_TRANSMITTED = 2,
    ES_PATH_DIFFRACTED = 3  ///< bends round edges
} es_path_kind;

/// One way of sound from a source to a listener.
typedef struct es_path {
    uint32_t source;
    uint32_t listener;
    int32_t kind;                ///< es_path_kind
    uint32_t order;              ///< reflections, transmissions, edges; it has order + 2 points
    double length;               ///< metres
    double delay;                ///< seconds since emission
    double departure[3];         ///< unit direction of travel at the source
    double arrival[3];           ///< unit direction of travel at the listener
    uint64_t first_point;        ///< row of es_path_arrays::points where the path begins
    uint64_t first_interaction;  ///< index into es_path_arrays::triangles and materials
} es_path;

typedef struct es_path_arrays {
    size_t struct_size;
    const es_path* paths;  ///< (path_count), by source, listener, delay, order, triangles
    size_t path_count;
    const uint64_t* first_path;  ///< (sources * listeners + 1): where the paths of each pair begin
    const double* points;        ///< (point_count, 3): source, interactions, listener
    size_t point_count;
    const uint32_t* triangles;  ///< (interaction_count), of the scene
    const uint32_t* materials;  ///< (interaction_count), of the scene
    size_t interaction_count;
    /// (path_count, band_count): linear amplitude, spreading, air and directivity included;
    /// negative where the source radiates with the other sign.
    const double* pressure;
    size_t band_count;
    /// (path_count + 1): where the edges of each path begin. Diffracted paths have some.
    const uint64_t* first_edge;
    /// (edge_count, 2, 3): both ends of the part of each edge that diffracts, in the order in which
    /// the path meets them. Its point there is where the way over that part is shortest.
    const double* edges;
    size_t edge_count;
} es_path_arrays;

/// All paths as flat arrays. `arrays->struct_size` must be set. Fails with ES_ERROR_FAILED if they
/// were not asked for.
ES_API es_status es_result_paths(es_result result, es_path_arrays* arrays);

typedef enum es_metric {
    ES_METRIC_EDT = 0,          ///< early decay time, seconds
    ES_METRIC_T20 = 1,          ///< reverberation time from -5 to -25 dB, seconds
    ES_METRIC_T30 = 2,          ///< reverberation time from -5 to -35 dB, seconds
    ES_METRIC_C50 = 3,          ///< clarity, decibels
    ES_METRIC_C80 = 4,          ///< clarity, decibels
    ES_METRIC_D50 = 5,          ///< definition, 0 ... 1
    ES_METRIC_TS = 6,           ///< centre time, seconds
    ES_METRIC_G = 7,            ///< strength, decibels
    ES_METRIC_STI = 8,          ///< speech transmission index, 0 ... 1; one per pair
    ES_METRIC_SCHROEDER = 9,    ///< Schroeder frequency, hertz; one per pair
    ES_METRIC_LF = 10,          ///< early lateral energy fraction, of an ambisonic response
    ES_METRIC_IACC_EARLY = 11,  ///< interaural cross-correlation, of a binaural response
    ES_METRIC_IACC_LATE = 12,
    ES_METRIC_IACC = 13
} es_metric;

/// What a metric is of.
typedef enum es_metric_set {
    ES_EXPECTED = 0,  ///< of the energies that arrive: their mean over realisations
    ES_RESPONSE = 1   ///< of the response, one realisation
} es_metric_set;

typedef enum es_metric_form {
    ES_PER_BAND = 0,
    ES_SINGLE_NUMBER = 1  ///< mean over 500 Hz and 1 kHz (ISO 3382-1), or the one value of a pair
} es_metric_form;

/// A metric of all pairs, (sources, listeners, bands), bands 1 for single numbers; NaN where it has
/// no value, for which es_result_metric_note() gives the reason. `standard_errors`, of the same
/// shape, may be null: they are NaN where there are none, and may be numbers where the value is
/// withheld for being uncertain. ES_METRIC_STI and ES_METRIC_SCHROEDER have single numbers only;
/// LF and IACC have values per band, of the response, only; SCHROEDER is of ES_EXPECTED.
ES_API es_status es_result_metric(es_result result,
                                  int32_t metric,
                                  int32_t set,
                                  int32_t form,
                                  const double** values,
                                  const double** standard_errors,
                                  size_t shape[3]);
/// Why a metric of a pair has no value in a band, or what else is to be known of it; "" if nothing
/// is. `band`: its index; ES_NONE for a single number.
ES_API es_status es_result_metric_note(es_result result,
                                       int32_t metric,
                                       int32_t set,
                                       size_t source,
                                       size_t listener,
                                       uint32_t band,
                                       const char** text);
/// The key of a metric in metrics.json ("t30"), its unit ("s", "dB", "Hz" or ""), and its
/// just-noticeable difference, a share of the value if `relative` is 1 (NaN: not known). Each
/// pointer may be null. Valid for ever.
ES_API es_status es_metric_get(int32_t metric,
                               const char** key,
                               const char** unit,
                               double* just_noticeable_difference,
                               int32_t* relative);

/// The air that sound of the sources reaches, and the reverberation times of diffuse sound in it.
typedef struct es_room {
    size_t struct_size;
    int32_t is_enclosed;  ///< 0: outdoors, or no metrics were made; all else is then 0 and null
    int32_t reserved;
    double volume;             ///< cubic metres
    double surface;            ///< square metres that sound reaches, no openings
    double opening;            ///< square metres through which sound leaves
    const double* absorption;  ///< (band_count), mean over surface and opening
    const double* sabine;      ///< (band_count), seconds; infinite where nothing absorbs
    const double* eyring;      ///< likewise
    size_t band_count;
} es_room;

/// `room->struct_size` must be set.
ES_API es_status es_result_room(es_result result, es_room* room);

/// Late sound of a pair: energy over time, in units of a free field's at 1 m.
typedef struct es_histogram {
    size_t struct_size;
    double bin;            ///< seconds; entry k is of the interval that begins at k * bin
    const double* energy;  ///< (bin_count, band_count); null if histograms were not kept
    const double* error;   ///< likewise: standard errors
    size_t bin_count;
    size_t band_count;
    uint64_t rays;          ///< behind it
    double t30_error;       ///< relative standard error of T30
    double level_error_db;  ///< standard error of the level of all late sound
    int32_t error_reached;  ///< 0: es_simulation_options::rays_error was not reached
    int32_t is_full_decay;  ///< 1: it extends until the energy has decayed by about 60 dB
} es_histogram;

/// `histogram->struct_size` must be set.
ES_API es_status es_result_histogram(es_result result,
                                     size_t source,
                                     size_t listener,
                                     es_histogram* histogram);

/// Which surfaces matter: what each material of the scene means to each pair, before and after 80
/// ms. Arrays are (sources, listeners, material_count, band_count).
typedef struct es_sensitivity {
    size_t struct_size;
    const double* areas;  ///< (material_count), one side of the triangles, square metres
    /// Share of the energy at the listener that the material reflected at least once, of what
    /// arrives within 80 ms of the onset and later. Shares of materials overlap.
    const double* touched_before;
    const double* touched_after;
    /// Mean number of its reflections on the way of that energy.
    const double* reflections_before;
    const double* reflections_after;
    /// Share of the energy emitted by the source that the material absorbs, within 80 ms of the
    /// emission and later; 0 without rays.
    const double* absorbed_before;
    const double* absorbed_after;
    size_t material_count;
    size_t band_count;
} es_sensitivity;

/// `sensitivity->struct_size` must be set. Fails with ES_ERROR_FAILED if it was not asked for.
ES_API es_status es_result_sensitivity(es_result result, es_sensitivity* sensitivity);

/// Derivatives of an expected metric of all pairs by the energy absorption coefficients of the
/// scene's materials, per unit of the coefficient: (sources, listeners, materials, bands). A
/// metric of a band depends on the coefficient in that band; per band, ES_METRIC_STI is derived by
/// the coefficient in each band. Single numbers are derived by all bands together, bands is 1.
/// NaN where the metric has no value or the material absorbs everything. `standard_errors`, of the
/// same shape, may be null. `metric`: ES_METRIC_EDT ... ES_METRIC_STI. Fails as
/// es_result_sensitivity().
ES_API es_status es_result_derivative(es_result result,
                                      int32_t metric,
                                      int32_t form,
                                      const double** values,
                                      const double** standard_errors,
                                      size_t shape[4]);

/// What is to be told of the result: pairs without a path, errors not reached, decays that are
/// longer than the room explains.
ES_API es_status es_result_notes(es_result result, es_messages* messages);

/// Files of `earshot ir`.
typedef enum es_document {
    ES_PATHS_JSON = 0,
    ES_METRICS_JSON = 1,
    ES_HISTOGRAMS_JSON = 2,
    ES_SENSITIVITY_JSON = 3
} es_document;

/// Writes such a file, the same bytes as the program, whole or not at all. Fails with
/// ES_ERROR_FAILED if the result does not hold what it needs.
ES_API es_status es_result_write(es_result result, int32_t document, const char* file);

/// Writes all responses of results, one or several of one scene in order of time, to a SOFA file
/// (AES69, SingleRoomSRIR): that of `earshot ir --sofa`, the same bytes, whole or not at all. The
/// results must agree in format and sample rate. Fails with ES_ERROR_FAILED if a result does not
/// hold what it needs, or without the module libearshot-sofa.so. Reads `results`.
ES_API es_status es_results_write_sofa(const es_result* results, size_t count, const char* file);

#endif
