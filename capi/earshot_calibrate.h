// SPDX-License-Identifier: MIT
//
// Calibration: absorption and scattering of materials fitted to measurements.
// Part of earshot.h, which says what holds for all.
#ifndef EARSHOT_CALIBRATE_H
#define EARSHOT_CALIBRATE_H

#include "earshot_base.h"
#include "earshot_simulation.h"

/// A metric of a pair in one band, as measured.
typedef struct es_measured_metric {
    uint32_t source;    ///< index into the scene's sources
    uint32_t listener;  ///< index into the scene's listeners
    int32_t metric;     ///< es_metric: ES_METRIC_EDT ... ES_METRIC_G
    int32_t reserved;   ///< 0
    double band_hz;     ///< nominal frequency
    double value;       ///< in the metric's unit
    double error;       ///< standard error, > 0; 0: not known
} es_measured_metric;

/// Options of `earshot calibrate`, with their defaults (in brackets).
typedef struct es_calibration_options {
    size_t struct_size;
    /// Standard error of values that have none, just-noticeable differences, > 0 (0.5).
    double default_error;
    /// How far coefficients may be off, a factor of the spread in literature, > 0 (1).
    double spread;
    int32_t max_simulations;  ///< until the coefficients stay, >= 1 (5)
    int32_t noise_free;       ///< 1: recordings are computed responses without a noise floor (0)
    /// Materials of which nothing is known, beside those without data (null, 0).
    const uint32_t* unknown_materials;
    size_t unknown_count;
    /// Materials that keep their coefficients (null, 0).
    const uint32_t* kept_materials;
    size_t kept_count;
    /// Instead of an array: a folder of recordings named SOURCE__LISTENER.wav, or a table .csv with
    /// the columns source, listener, metric, band, value and, if known, standard error (null).
    const char* measured;
    /// Of these files, between commas; null: "edt,t30,c80" of recordings, all of a table (null).
    const char* metrics;
    /// Level of the source in free field at 1 m, decibels re full scale, for G of recordings; NaN:
    /// not calibrated (NaN).
    double reference_db;
    int32_t fit_scattering;  ///< 1: scattering is fitted as well (0)
    int32_t reserved;        ///< 0
} es_calibration_options;

/// Sets all members to their defaults, `struct_size` to `size`.
ES_API es_status es_calibration_options_init(es_calibration_options* options, size_t size);

/// Fits the absorption of the scene's materials, and their scattering if asked for, to `count`
/// measured metrics, or to those that `options->measured` names if `count` is 0. `simulation` null:
/// the defaults of es_simulate() with order 3, rays_error 0.01 and 200000 rays; its time, order,
/// transmission, rays, rays_error, seed, air, bands, progress and threads count. Reads `scene`,
/// which stays as it is. Fails if this build is without Ceres.
ES_API es_status es_calibrate(es_scene scene,
                              const es_simulation_options* simulation,
                              const es_calibration_options* options,
                              const es_measured_metric* measured,
                              size_t count,
                              es_calibration* calibration);

// Calibrations never change: every function below reads `calibration`, and views are valid until it
// is released.

typedef struct es_calibration_info {
    size_t struct_size;
    size_t materials;     ///< of the scene
    size_t bands;         ///< of the simulation
    size_t metrics;       ///< measured values
    size_t rays;          ///< of each simulation, per source
    int32_t simulations;  ///< that were made
    int32_t converged;    ///< 0: max_simulations were not enough
} es_calibration_info;

/// `info->struct_size` must be set.
ES_API es_status es_calibration_get_info(es_calibration calibration, es_calibration_info* info);

typedef enum es_calibration_table {
    ES_CALIBRATION_PRIOR = 0,        ///< absorption before
    ES_CALIBRATION_PRIOR_ERROR = 1,  ///< its standard deviation; 0 of kept materials
    ES_CALIBRATION_ABSORPTION = 2,   ///< fitted; as before where nothing was measured
    ES_CALIBRATION_ERROR = 3,        ///< standard error, of data and prior together
    ES_CALIBRATION_LOWER = 4,        ///< ends of the 95 % interval
    ES_CALIBRATION_UPPER = 5,
    ES_CALIBRATION_DATA_ERROR = 6,  ///< standard error of the data alone; NaN: they do not tell it
    ES_CALIBRATION_DATA_SHARE = 7,  ///< of the prior's variance that the data have removed, 0 ... 1
    ES_CALIBRATION_IDENTIFIED = 8,  ///< 1: the data alone tell it; 0 otherwise
    /// The same of scattering, in the same order.
    ES_CALIBRATION_SCATTERING_PRIOR = 9,
    ES_CALIBRATION_SCATTERING_PRIOR_ERROR = 10,
    ES_CALIBRATION_SCATTERING = 11,
    ES_CALIBRATION_SCATTERING_ERROR = 12,
    ES_CALIBRATION_SCATTERING_LOWER = 13,
    ES_CALIBRATION_SCATTERING_UPPER = 14,
    ES_CALIBRATION_SCATTERING_DATA_ERROR = 15,
    ES_CALIBRATION_SCATTERING_DATA_SHARE = 16,
    ES_CALIBRATION_SCATTERING_IDENTIFIED = 17
} es_calibration_table;

/// Numbers of an es_calibration_table, (materials, bands). Fails for scattering that was not
/// fitted.
ES_API es_status es_calibration_values(es_calibration calibration,
                                       int32_t table,
                                       const double** values,
                                       size_t shape[2]);
/// Per measured value, in their order, in the metric's unit: as measured, and by the model before
/// and after the fit; NaN where the model has no value. `weights`: 1, less for outliers, 0 of what
/// was left out. Each pointer may be null.
ES_API es_status es_calibration_metrics(es_calibration calibration,
                                        const double** measured,
                                        const double** before,
                                        const double** after,
                                        const double** weights,
                                        size_t* count);
/// What is odd about the measurements and the fit.
ES_API es_status es_calibration_warnings(es_calibration calibration, es_messages* messages);
/// The JSON text of `earshot calibrate --json`.
ES_API es_status es_calibration_json(es_calibration calibration, const char** text);
/// Writes the materials as a file SCENE.materials.json, the same bytes as the program, whole or not
/// at all.
ES_API es_status es_calibration_write(es_calibration calibration, const char* file);
/// Gives the coefficients to the materials of a scene that has as many, those of the same index.
/// Changes `scene`.
ES_API es_status es_calibration_apply(es_calibration calibration, es_scene scene);

#endif
