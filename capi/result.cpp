// SPDX-License-Identifier: MIT
#include "earshot/capi/internal/checks.h"
#include "earshot/capi/internal/metric_kinds.h"
#include "earshot/capi/internal/result_object.h"
#include "earshot/capi/internal/scene_object.h"
#include "earshot/capi/internal/sound_object.h"
#include "earshot/io/metrics.h"
#include "earshot/io/results.h"
#include "earshot/io/sensitivity.h"
#include "earshot/io/whole_file.h"

#include <memory>
#include <string>

namespace earshot::capi {
namespace {

std::size_t require_pair(const ResultObject& result, std::size_t source, std::size_t listener) {
    require_index(source, result.info.sources, "source");
    require_index(listener, result.info.listeners, "listener");
    return result.pair_index(source, listener);
}

void require_responses(const ResultObject& result) {
    if (result.lengths.empty()) {
        throw Error("responses",
                    "were not asked for",
                    "simulate with es_simulation_options::responses = 1");
    }
}

void require_metrics(const ResultObject& result) {
    if (result.metrics.empty()) {
        throw Error(
            "metrics", "were not asked for", "simulate with es_simulation_options::metrics = 1");
    }
}

const MetricKind& require_metric(std::int32_t metric, std::int32_t set) {
    require_in(std::int64_t{metric}, ES_METRIC_EDT, ES_METRIC_IACC, "metric");
    require_in(std::int64_t{set}, ES_EXPECTED, ES_RESPONSE, "set");
    return *metric_kind(metric);
}

const MetricTable& table_of(const ResultObject& result,
                            std::int32_t metric,
                            std::int32_t set,
                            std::int32_t form) {
    const MetricKind& kind = require_metric(metric, set);
    require_in(std::int64_t{form}, ES_PER_BAND, ES_SINGLE_NUMBER, "form");
    require_metrics(result);
    const MetricTable& table =
        result.metric_tables[static_cast<std::size_t>(metric)][static_cast<std::size_t>(set)]
                            [static_cast<std::size_t>(form)];
    if (table.values.empty()) {
        throw Error(kind.key,
                    "is not among the metrics of that set and form, or of this response format",
                    "es_metric tells where each is found");
    }
    return table;
}

io::Sound sound_of(const ResultObject& result, std::size_t pair) {
    const std::size_t channels = result.info.channels, samples = result.info.samples;
    io::Sound sound = {.sample_rate = result.info.sample_rate,
                       .channels = static_cast<int>(channels),
                       .samples = {}};
    const float* block = result.responses.data() + pair * channels * samples;
    for (std::size_t n = 0; n < result.lengths[pair]; ++n) {
        for (std::size_t channel = 0; channel < channels; ++channel) {
            sound.samples.push_back(static_cast<double>(block[channel * samples + n]));
        }
    }
    return sound;
}

es_room room_of(const ResultObject& result) {
    es_room room{};
    if (result.room) {
        room.is_enclosed = 1;
        room.volume = result.room->volume;
        room.surface = result.room->surface;
        room.opening = result.room->opening;
        room.absorption = result.room->absorption.data();
        room.sabine = result.room->sabine.data();
        room.eyring = result.room->eyring.data();
        room.band_count = result.info.bands;
    }
    return room;
}

es_histogram histogram_of(const ResultObject& result, std::size_t pair) {
    const propagation::PairResult& of = result.pairs[pair];
    es_histogram histogram{};
    histogram.bin = of.late.bin;
    histogram.band_count = result.info.bands;
    histogram.rays = of.late_errors.rays;
    histogram.t30_error = of.late_errors.t30;
    histogram.level_error_db = of.late_errors.level_db;
    histogram.error_reached = of.late_errors.reached ? 1 : 0;
    histogram.is_full_decay = of.late.full_decay ? 1 : 0;
    if (result.has_histograms) {
        histogram.energy = result.histograms[pair].energy.data();
        histogram.error = result.histograms[pair].error.data();
        histogram.bin_count = of.late.energy.size();
    }
    return histogram;
}

}  // namespace

void require_paths(const ResultObject& result) {
    if (!result.has_paths) {
        throw Error(
            "paths", "were not asked for", "simulate with es_simulation_options::paths = 1");
    }
}

std::string document_text(const ResultObject& result, std::int32_t document) {
    require_in(std::int64_t{document}, ES_PATHS_JSON, ES_SENSITIVITY_JSON, "document");
    const io::ResultHeader header = {
        .scene = result.names, .bands = result.bands, .speed_of_sound = result.info.speed_of_sound};
    if (document == ES_PATHS_JSON) {
        require_paths(result);
        return io::encode_paths(header, result.pairs, result.listener_poses);
    }
    if (document == ES_METRICS_JSON) {
        require_metrics(result);
        return io::encode_metrics({.scene = result.names,
                                   .bands = result.bands,
                                   .room = result.room,
                                   .speech = result.speech},
                                  result.metrics);
    }
    if (document == ES_SENSITIVITY_JSON) {
        require_sensitivity(result);
        return io::encode_sensitivity(
            {.scene = result.names, .bands = result.bands, .areas = result.material_areas},
            result.sensitivity);
    }
    if (!result.has_histograms) {
        throw Error("histograms",
                    "were not asked for",
                    "simulate with es_simulation_options::histograms = 1");
    }
    return io::encode_histograms(header, result.pairs);
}

}  // namespace earshot::capi

using namespace earshot;
using namespace earshot::capi;

es_status es_result_get_info(es_result result, es_result_info* info) {
    return call(__func__, [&] {
        const Reading<ResultObject> object(result, "result");
        give_struct(object->info, info, sizeof(es_result_info), "info");
    });
}

es_status es_result_bands(es_result result, const double** nominal_hz, size_t* count) {
    return call(__func__, [&] {
        const Reading<ResultObject> object(result, "result");
        require(nominal_hz, "nominal_hz");
        require(count, "count") = object->bands.count();
        *nominal_hz = object->bands.nominal_hz().data();
    });
}

es_status es_result_responses(es_result result, const float** samples, size_t shape[4]) {
    return call(__func__, [&] {
        const Reading<ResultObject> object(result, "result");
        require(samples, "samples");
        require(shape, "shape");
        require_responses(*object);
        *samples = object->responses.data();
        shape[0] = object->info.sources;
        shape[1] = object->info.listeners;
        shape[2] = object->info.channels;
        shape[3] = object->info.samples;
    });
}

es_status es_result_lengths(es_result result, const uint64_t** lengths, size_t shape[2]) {
    return call(__func__, [&] {
        const Reading<ResultObject> object(result, "result");
        require(lengths, "lengths");
        require(shape, "shape");
        require_responses(*object);
        *lengths = object->lengths.data();
        shape[0] = object->info.sources;
        shape[1] = object->info.listeners;
    });
}

es_status es_result_sound(es_result result, size_t source, size_t listener, es_sound* sound) {
    return call(__func__, [&] {
        const Reading<ResultObject> object(result, "result");
        require(sound, "sound");
        require_responses(*object);
        const std::size_t pair = require_pair(*object, source, listener);
        *sound = publish(std::make_shared<SoundObject>(sound_of(*object, pair)));
    });
}

es_status es_result_paths(es_result result, es_path_arrays* arrays) {
    return call(__func__, [&] {
        const Reading<ResultObject> object(result, "result");
        require_paths(*object);
        give_struct({.struct_size = 0,
                     .paths = object->paths.data(),
                     .path_count = object->paths.size(),
                     .first_path = object->first_path.data(),
                     .points = object->points.data(),
                     .point_count = object->points.size() / 3,
                     .triangles = object->triangles.data(),
                     .materials = object->materials.data(),
                     .interaction_count = object->triangles.size(),
                     .pressure = object->pressure.data(),
                     .band_count = object->info.bands,
                     .first_edge = object->first_edge.data(),
                     .edges = object->edges.data(),
                     .edge_count = object->edges.size() / 6},
                    arrays,
                    sizeof(es_path_arrays),
                    "arrays");
    });
}

es_status es_result_metric(es_result result,
                           int32_t metric,
                           int32_t set,
                           int32_t form,
                           const double** values,
                           const double** standard_errors,
                           size_t shape[3]) {
    return call(__func__, [&] {
        const Reading<ResultObject> object(result, "result");
        require(values, "values");
        require(shape, "shape");
        const MetricTable& table = table_of(*object, metric, set, form);
        *values = table.values.data();
        if (standard_errors != nullptr) {
            *standard_errors = table.errors.data();
        }
        shape[0] = object->info.sources;
        shape[1] = object->info.listeners;
        shape[2] = form == ES_PER_BAND ? object->info.bands : 1;
    });
}

es_status es_result_metric_note(es_result result,
                                int32_t metric,
                                int32_t set,
                                size_t source,
                                size_t listener,
                                uint32_t band,
                                const char** text) {
    return call(__func__, [&] {
        const Reading<ResultObject> object(result, "result");
        require(text, "text");
        static_cast<void>(require_metric(metric, set));
        require_metrics(*object);
        const std::size_t pair = require_pair(*object, source, listener);
        if (band != ES_NONE) {
            require_index(band, object->info.bands, "band");
        }
        const std::string* note = note_of(*object, metric, set, pair, band);
        *text = note == nullptr ? "" : note->c_str();
    });
}

es_status es_metric_get(int32_t metric,
                        const char** key,
                        const char** unit,
                        double* just_noticeable_difference,
                        int32_t* relative) {
    return call(__func__, [&] {
        const MetricKind& kind = require_metric(metric, ES_EXPECTED);
        const auto give = [](const auto& value, auto* out) {
            if (out != nullptr) {
                *out = value;
            }
        };
        give(kind.key, key);
        give(kind.unit, unit);
        give(kind.just_noticeable_difference, just_noticeable_difference);
        give(kind.relative ? 1 : 0, relative);
    });
}

es_status es_result_room(es_result result, es_room* room) {
    return call(__func__, [&] {
        const Reading<ResultObject> object(result, "result");
        give_struct(room_of(*object), room, sizeof(es_room), "room");
    });
}

es_status es_result_histogram(es_result result,
                              size_t source,
                              size_t listener,
                              es_histogram* histogram) {
    return call(__func__, [&] {
        const Reading<ResultObject> object(result, "result");
        const std::size_t pair = require_pair(*object, source, listener);
        give_struct(histogram_of(*object, pair), histogram, sizeof(es_histogram), "histogram");
    });
}

es_status es_result_notes(es_result result, es_messages* messages) {
    return call(__func__, [&] {
        const Reading<ResultObject> object(result, "result");
        require(messages, "messages");
        *messages = publish_messages(object->notes);
    });
}

es_status es_result_write(es_result result, int32_t document, const char* file) {
    return call(__func__, [&] {
        const Reading<ResultObject> object(result, "result");
        const std::string path(require_text(file, "file"));
        io::write_whole_file(path, document_text(*object, document));
    });
}
