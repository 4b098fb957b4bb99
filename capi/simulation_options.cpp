// SPDX-License-Identifier: MIT
#include "earshot/capi/internal/simulation_options.h"

#include "earshot/audio/spatial.h"
#include "earshot/audio/speech_levels.h"
#include "earshot/capi/internal/bands.h"
#include "earshot/capi/internal/checks.h"
#include "earshot/capi/internal/scene_object.h"
#include "earshot/capi/internal/sofa.h"
#include "earshot/capi/internal/work.h"
#include "earshot/io/default_hrir_set.h"

#include <algorithm>
#include <limits>
#include <string>

namespace earshot::capi {
namespace {

constexpr double kNoLevel = -std::numeric_limits<double>::infinity();
constexpr double kMaxLevelDb = 200.0;  // either way

// Those of `earshot ir`.
constexpr es_simulation_options kDefaults = {.struct_size = sizeof(es_simulation_options),
                                             .time = 0.0,
                                             .order = 4,
                                             .mode = ES_MODE_COMPLETE,
                                             .resolution = 0,
                                             .transmission = 0,
                                             .max_length = 0.0,
                                             .min_level_db = kNoLevel,
                                             .rays = 1000000,
                                             .rays_error = 0.02,
                                             .seed = 1,
                                             .temperature_c = 20.0,
                                             .humidity_percent = 50.0,
                                             .pressure_kpa = 101.325,
                                             .air_absorption = 1,
                                             .bands = ES_BANDS_OCTAVE,
                                             .format = ES_FORMAT_MONO,
                                             .ambisonic_order = 1,
                                             .hrtf_file = nullptr,
                                             .sample_rate = 48000.0,
                                             .length = 0.0,
                                             .hrtf_raw = 0,
                                             .responses = 1,
                                             .metrics = 1,
                                             .histograms = 0,
                                             .keep_traces = 0,
                                             .speech = 0,
                                             .speech_level_db = audio::kNormalSpeechDb,
                                             .noise_db = nullptr,
                                             .visible_sets = 0,
                                             .progress = nullptr,
                                             .progress_data = nullptr,
                                             .threads = 0,
                                             .sofa = 0,
                                             .paths = 1,
                                             .sensitivity = 0,
                                             .diffraction = 0,
                                             .min_diffraction_level_db = -40.0};

void check_paths(const es_simulation_options& options) {
    require_time(options.time, "options->time");
    require_in(std::int64_t{options.order}, 0, 64, "options->order");
    require_in(
        std::int64_t{options.diffraction}, 0, propagation::kMaxDiffraction, "options->diffraction");
    require_in(std::int64_t{options.mode}, ES_MODE_COMPLETE, ES_MODE_SAMPLED, "options->mode");
    require_in(std::int64_t{options.resolution}, 0, 1024, "options->resolution");
    require_flag(options.transmission, "options->transmission");
    require_in(options.max_length, 0.0, 1e9, "options->max_length");
    if (options.min_level_db != kNoLevel) {
        require_in(options.min_level_db, -1000.0, 1000.0, "options->min_level_db");
    }
    if (options.min_diffraction_level_db != kNoLevel) {
        require_in(
            options.min_diffraction_level_db, -1000.0, 1000.0, "options->min_diffraction_level_db");
    }
}

void check_rays_and_air(const es_simulation_options& options) {
    constexpr std::uint64_t kMaxRays = 1000000000, kMaxSeed = std::uint64_t{1} << 63U;
    if (options.rays > kMaxRays) {
        fail_argument("options->rays",
                      "are " + std::to_string(options.rays) + ", more than 1000000000",
                      "ask for fewer");
    }
    if (options.rays_error != 0.0) {
        require_in(options.rays_error, 0.001, 1.0, "options->rays_error");
    }
    if (options.seed >= kMaxSeed) {
        fail_argument("options->seed", "is 2^63 or more", "give a smaller number");
    }
    require_in(options.temperature_c, -50.0, 70.0, "options->temperature_c");
    require_in(options.humidity_percent, 0.0, 100.0, "options->humidity_percent");
    require_in(options.pressure_kpa, 10.0, 200.0, "options->pressure_kpa");
    require_flag(options.air_absorption, "options->air_absorption");
}

void check_form(const es_simulation_options& options) {
    static_cast<void>(bands_of(options.bands, "options->bands"));
    require_in(
        std::int64_t{options.format}, ES_FORMAT_MONO, ES_FORMAT_AMBISONIC, "options->format");
    require_in(std::int64_t{options.ambisonic_order},
               0,
               audio::kMaxAmbisonicOrder,
               "options->ambisonic_order");
    static_cast<void>(text_or(options.hrtf_file, "", "options->hrtf_file"));
    require_in(options.sample_rate, 1000.0, 768000.0, "options->sample_rate");
    require_in(options.length, 0.0, 3600.0, "options->length");
    require_flag(options.hrtf_raw, "options->hrtf_raw");
    require_flag(options.responses, "options->responses");
    require_flag(options.metrics, "options->metrics");
    require_flag(options.histograms, "options->histograms");
    require_flag(options.keep_traces, "options->keep_traces");
    require_flag(options.sofa, "options->sofa");
    require_flag(options.paths, "options->paths");
    require_flag(options.sensitivity, "options->sensitivity");
    if (options.sensitivity != 0 && options.paths == 0) {
        fail_argument("options->sensitivity", "needs the paths", "set options->paths to 1");
    }
    require_flag(options.speech, "options->speech");
    require_in(options.speech_level_db, -kMaxLevelDb, kMaxLevelDb, "options->speech_level_db");
    for (std::size_t i = 0; options.noise_db != nullptr && i < audio::kSpeechBands; ++i) {
        require_in(options.noise_db[i], -kMaxLevelDb, kMaxLevelDb, "options->noise_db");
    }
    require_threads(options.threads, "options->threads");
}

}  // namespace

void require_threads(std::int32_t threads, const char* argument) {
    constexpr std::int64_t kMaxThreads = 1024;
    require_in(std::int64_t{threads}, 0, kMaxThreads, argument);
}

es_simulation_options checked_options(const es_simulation_options* options) {
    if (options == nullptr) {
        return kDefaults;
    }
    const es_simulation_options whole =
        require_struct(*options, kDefaults, sizeof(es_simulation_options), "options");
    check_paths(whole);
    check_rays_and_air(whole);
    check_form(whole);
    return whole;
}

es_simulation_options checked_options_or(const es_simulation_options* options, double rays_error) {
    es_simulation_options all = checked_options(options);
    if (options == nullptr) {
        constexpr std::int32_t kOrder = 3;
        constexpr std::uint64_t kMaxRays = 200000;
        all.order = kOrder;
        all.rays_error = rays_error;
        all.rays = kMaxRays;
    }
    return all;
}

propagation::Options simulator_options(const es_simulation_options& options) {
    return {
        .specular_order = options.order,
        .diffraction = options.diffraction,
        .min_diffraction_level_db = options.min_diffraction_level_db,
        .mode = options.mode == ES_MODE_SAMPLED ? frustum::Mode::sampled : frustum::Mode::complete,
        .resolution = options.resolution,
        .report_paths = options.paths != 0,
        .air = {.temperature_c = options.temperature_c,
                .humidity_percent = options.humidity_percent,
                .pressure_kpa = options.pressure_kpa},
        .air_absorption = options.air_absorption != 0,
        .transmission = options.transmission != 0,
        .max_length =
            options.max_length > 0.0 ? options.max_length : std::numeric_limits<double>::infinity(),
        .min_level_db = options.min_level_db,
        .rays = static_cast<std::size_t>(options.rays),
        .max_error = options.rays_error,
        .seed = options.seed,
        .late_length = options.length,
        .late_directions = options.format != ES_FORMAT_MONO,
        .report_materials = options.sensitivity != 0,
        .keep_traces = options.keep_traces != 0,
        .bands = bands_of(options.bands, "options->bands")};
}

std::optional<audio::SpeechConditions> speech_conditions(const es_simulation_options& options) {
    if (options.speech == 0) {
        return std::nullopt;
    }
    audio::SpeechConditions speech;
    speech.speech_level_db = options.speech_level_db;
    if (options.noise_db != nullptr) {
        speech.noise_db.emplace();
        std::copy_n(options.noise_db, audio::kSpeechBands, speech.noise_db->begin());
    }
    return speech;
}

propagation::ResponseFormat response_format(const es_simulation_options& options) {
    propagation::ResponseFormat format = {.ambisonic_order = options.ambisonic_order,
                                          .sample_rate = options.sample_rate,
                                          .length = options.length,
                                          .seed = options.seed,
                                          .report_metrics = options.metrics != 0};
    if (options.format == ES_FORMAT_BINAURAL) {
        format.channels = propagation::Channels::binaural;
        format.hrir_set = options.hrtf_file == nullptr && options.hrtf_raw == 0
                              ? io::default_hrir_set()
                              : read_hrir_set(options.hrtf_file, options.hrtf_raw != 0);
    } else if (options.format == ES_FORMAT_AMBISONIC) {
        format.channels = propagation::Channels::ambisonic;
    }
    format.speech = speech_conditions(options);
    return format;
}

}  // namespace earshot::capi

using namespace earshot;
using namespace earshot::capi;

es_status es_simulation_options_init(es_simulation_options* options, size_t size) {
    return call(__func__,
                [&] { init_struct(kDefaults, options, size, sizeof(es_simulation_options)); });
}

es_status es_noise_criterion(double number, double levels_db[7]) {
    return call(__func__, [&] {
        require(levels_db, "levels_db");
        require_in(number, audio::kMinNoiseCriterion, audio::kMaxNoiseCriterion, "number");
        const auto levels = audio::noise_criterion_db(number);
        std::copy(levels->begin(), levels->end(), levels_db);
    });
}
