// SPDX-License-Identifier: MIT
// Calls on simulations, results and sounds.
#include "capi/fuzz_caller.h"

namespace earshot::capi_fuzz {
namespace {

/// The minimum level of a path, which may be -inf: no limit.
double level(Caller& c, std::array<double, 2> good) {
    const bool was_wrong = c.wrong;
    const double level_db = c.number(-1000.0, 1000.0, good);
    if (level_db == -std::numeric_limits<double>::infinity()) {
        c.wrong = was_wrong;
    }
    return level_db;
}

}  // namespace

es_simulation_options simulation_options_of(Caller& c) {
    es_simulation_options options;
    es_simulation_options_init(&options, sizeof options);
    if (c.chance(0.02)) {
        options.struct_size = c.count(500);
        c.wrong = options.struct_size != sizeof options;
    }
    options.time = c.number(-1e12, 1e12);
    options.order = c.chance(0.98) ? c.below(2) : c.choice(3);
    options.mode = c.choice(2);
    options.diffraction = c.chance(0.9) ? 0 : c.choice(2);
    options.transmission = c.flag();
    options.max_length = c.number(0.0, 1e9, {0.0, 30.0});
    options.min_level_db = level(c, {-90.0, -20.0});
    options.min_diffraction_level_db = level(c, {-60.0, -10.0});
    options.rays = c.chance(0.03) ? 64 : 0;
    options.rays_error = c.chance(0.9) ? 0.0 : c.number(0.001, 1.0);
    options.temperature_c = c.number(-50.0, 70.0);
    options.humidity_percent = c.number(0.0, 100.0);
    options.pressure_kpa = c.number(10.0, 200.0);
    options.air_absorption = c.flag();
    options.bands = c.choice(2);
    options.format = c.chance(0.9) ? ES_FORMAT_MONO : ES_FORMAT_AMBISONIC;
    options.ambisonic_order = c.choice(3);
    options.sample_rate = c.number(1000.0, 768000.0, {4000.0, 8000.0});
    options.length = c.number(0.0, 3600.0, {0.01, 0.1});
    options.responses = c.flag();
    options.metrics = c.chance(0.02) ? 1 : 0;
    options.histograms = c.flag();
    options.keep_traces = c.flag();
    options.sofa = c.flag();
    options.paths = c.flag();
    options.sensitivity = c.flag();
    options.speech = c.flag();
    options.speech_level_db = c.number(-200.0, 200.0);
    options.visible_sets = c.chance(0.9) ? 0 : c.some(ES_KIND_VISIBLE_SETS);
    if (c.chance(0.01)) {
        c.wrong = true;
        options.visible_sets = 12345;
    }
    options.threads = c.threads();
    return options;
}

namespace {

constexpr es_metric kLastMetric = ES_METRIC_IACC;

es_status simulate(Caller& c) {
    const es_scene scene = c.handle(ES_KIND_SCENE);
    const es_simulation_options given = simulation_options_of(c);
    es_result result = 0;
    return kept(c, es_simulate(scene, &given, c.out(result)), result);
}

es_status create_simulator(Caller& c) {
    const es_scene scene = c.handle(ES_KIND_SCENE);
    const es_simulation_options given = simulation_options_of(c);
    es_simulator simulator = 0;
    return kept(c, es_simulator_create(scene, &given, c.out(simulator)), simulator);
}

es_status run_simulator(Caller& c) {
    const es_simulator simulator = c.handle(ES_KIND_SIMULATOR);
    es_result result = 0;
    switch (c.below(3)) {
        case 0: {
            const double time = c.number(-1e12, 1e12);
            return kept(c, es_simulator_run(simulator, time, c.out(result)), result);
        }
        case 1: {
            const std::int32_t item = c.choice(2);
            const double* position = c.points(1, 2.0);
            return es_simulator_set_position(simulator, item, 0, position);
        }
        default: {
            const std::int32_t item = c.choice(2);
            const double* point = c.points(1, 2.0, true);
            return es_simulator_set_look_at(simulator, item, 0, point);
        }
    }
}

es_status init(Caller& c) {
    es_simulation_options options;
    const std::size_t size = c.chance(0.5) ? sizeof options : c.count(300);
    c.wrong = size != sizeof options;
    return es_simulation_options_init(c.out(options), size);
}

es_result_info info_of(es_result result) {
    es_result_info info{};
    info.struct_size = sizeof info;
    static_cast<void>(es_result_get_info(result, &info));
    return info;
}

double read(const es_path_arrays& arrays) {
    double total = sum(arrays.points, 3 * arrays.point_count) +
                   sum(arrays.triangles, arrays.interaction_count) +
                   sum(arrays.materials, arrays.interaction_count) +
                   sum(arrays.pressure, arrays.path_count * arrays.band_count) +
                   sum(arrays.first_edge, arrays.path_count + 1) +
                   sum(arrays.edges, 6 * arrays.edge_count);
    for (std::size_t i = 0; i < arrays.path_count; ++i) {
        total += arrays.paths[i].length + sum(arrays.points + 3 * arrays.paths[i].first_point, 6);
    }
    return total;
}

es_status views(Caller& c) {
    const es_result result = c.handle(ES_KIND_RESULT);
    const es_result_info info = info_of(result);
    size_t shape[4] = {};
    switch (c.below(7)) {
        case 0: {
            const float* samples = nullptr;
            const es_status status = es_result_responses(result, c.out(samples), shape);
            if (status == ES_OK) {
                keep_reading(sum(samples, shape[0] * shape[1] * shape[2] * shape[3]));
            }
            return status;
        }
        case 1: {
            const uint64_t* lengths = nullptr;
            const es_status status = es_result_lengths(result, c.out(lengths), shape);
            if (status == ES_OK) {
                keep_reading(sum(lengths, shape[0] * shape[1]));
            }
            return status;
        }
        case 2: {
            es_path_arrays arrays{};
            arrays.struct_size = c.chance(0.95) ? sizeof arrays : c.count(200);
            c.wrong = c.wrong || arrays.struct_size != sizeof arrays;
            const es_status status = es_result_paths(result, &arrays);
            if (status == ES_OK) {
                keep_reading(read(arrays));
            }
            return status;
        }
        case 3: {
            es_histogram histogram{};
            histogram.struct_size = sizeof histogram;
            const std::size_t source = c.index(info.sources), listener = c.index(info.listeners);
            const es_status status =
                es_result_histogram(result, source, listener, c.out(histogram));
            if (status == ES_OK) {
                keep_reading(sum(histogram.energy, histogram.bin_count * histogram.band_count));
            }
            return status;
        }
        case 4: {
            es_sensitivity sensitivity{};
            sensitivity.struct_size = c.chance(0.95) ? sizeof sensitivity : c.count(200);
            c.wrong = c.wrong || sensitivity.struct_size != sizeof sensitivity;
            const es_status status = es_result_sensitivity(result, &sensitivity);
            if (status == ES_OK) {
                keep_reading(sum(sensitivity.absorbed_after,
                                 info.sources * info.listeners * sensitivity.material_count *
                                     sensitivity.band_count));
            }
            return status;
        }
        case 5: {
            const double *values = nullptr, *errors = nullptr;
            const std::int32_t metric = c.choice(ES_METRIC_STI + 1);
            const std::int32_t form = c.choice(2);
            const es_status status = es_result_derivative(
                result, metric, form, c.out(values), c.chance(0.5) ? &errors : nullptr, shape);
            if (status == ES_OK) {
                const std::size_t count = shape[0] * shape[1] * shape[2] * shape[3];
                keep_reading(sum(values, count) + (errors != nullptr ? sum(errors, count) : 0.0));
            }
            return status;
        }
        default: {
            es_room room{};
            room.struct_size = c.chance(0.95) ? sizeof room : c.count(200);
            c.wrong = c.wrong || room.struct_size != sizeof room;
            return es_result_room(result, &room);
        }
    }
}

es_status metrics(Caller& c) {
    const es_result result = c.handle(ES_KIND_RESULT);
    const es_result_info info = info_of(result);
    const std::int32_t metric = c.choice(kLastMetric + 1);
    if (c.below(3) == 0) {
        c.wrong = metric < 0 || metric > kLastMetric;
        const char* key = nullptr;
        return es_metric_get(metric, &key, nullptr, nullptr, nullptr);
    }
    const std::int32_t set = c.choice(2);
    if (c.below(2) == 0) {
        const std::int32_t form = c.choice(2);
        const double* values = nullptr;
        size_t shape[3] = {};
        const es_status status =
            es_result_metric(result, metric, set, form, c.out(values), nullptr, shape);
        keep_reading(status == ES_OK ? sum(values, shape[0] * shape[1] * shape[2]) : 0.0);
        return status;
    }
    const std::size_t source = c.index(info.sources), listener = c.index(info.listeners);
    const char* text = nullptr;
    return es_result_metric_note(result, metric, set, source, listener, 0, c.out(text));
}

es_status documents(Caller& c) {
    const es_result result = c.handle(ES_KIND_RESULT);
    if (c.below(2) == 0) {
        es_messages notes = 0;
        return kept(c, es_result_notes(result, c.out(notes)), notes);
    }
    if (c.below(2) == 0) {
        const es_result results[2] = {result, c.some(ES_KIND_RESULT)};
        const std::size_t count = results[1] == 0 ? 1 : c.count(2);
        c.wrong = c.wrong || count == 0;
        const char* sofa = c.text({"fuzz.sofa", "none/none.sofa"});
        return es_results_write_sofa(results, count, sofa);
    }
    const std::int32_t document = c.choice(3);
    const char* file = c.text({"fuzz.json", "none/none.json"});
    return es_result_write(result, document, file);
}

es_status write_report(Caller& c) {
    const es_result result = c.handle(ES_KIND_RESULT);
    es_report_options given;
    es_report_options_init(&given, sizeof given);
    given.scene = c.chance(0.5) ? 0 : c.handle(ES_KIND_SCENE);
    given.title = c.text({"title", "<script>", ""}, true);
    given.command = c.text({"earshot ir", "\xff"}, true);
    given.reference_file = c.text({"", "fuzz.json", "none"}, true);
    const char* const limits[] = {c.text({"sti=0.6", "t30=0.8", "sti", "x=1"}),
                                  c.text({"c80=1", "g=1e999", "="})};
    given.limits = limits;
    given.limit_count = c.count(2);
    // Whether it fails depends on files that other calls write.
    const char* file = c.text({"fuzz.html", "report.json", "none/none.html"});
    c.wrong = false;
    return es_result_write_report(result, c.chance(0.9) ? &given : nullptr, file);
}

es_status make_sound(Caller& c) {
    es_sound sound = 0;
    if (c.below(3) == 0) {
        const es_result result = c.handle(ES_KIND_RESULT);
        const es_result_info info = info_of(result);
        const std::size_t source = c.index(info.sources), listener = c.index(info.listeners);
        return kept(c, es_result_sound(result, source, listener, c.out(sound)), sound);
    }
    const std::size_t frames = c.count(40), channels = 1 + c.count(1);
    const double* samples = c.values(frames * channels, -1.0, 1.0);
    const double rate = c.chance(0.5) ? 8000.0 : c.number(1000.0, 655350.0, {4000.0, 9000.0});
    std::size_t given = channels;
    if (c.chance(0.03)) {
        given = c.chance(0.5) ? 0 : static_cast<std::size_t>(-1);
        c.wrong = true;
    }
    return kept(c, es_sound_create(samples, frames, given, rate, c.out(sound)), sound);
}

es_status use_sound(Caller& c) {
    const es_sound sounds[] = {c.handle(ES_KIND_SOUND), c.some(ES_KIND_SOUND)};
    const std::size_t count = sounds[1] == 0 ? 1 : 1 + c.count(1);
    es_sound made = 0;
    if (c.below(2) == 0) {
        const double gains[] = {c.number(-200.0, 200.0, {-6.0, 6.0}), 0.0};
        return kept(c, es_sound_mix(sounds, gains, count, 0.0, c.out(made)), made);
    }
    const es_sound dry = c.handle(ES_KIND_SOUND);
    const std::int32_t threads = c.threads();
    return kept(c, es_auralize(dry, sounds, count, threads, c.out(made)), made);
}

es_status play_moving(Caller& c) {
    es_simulation_options simulation;
    es_motion_options motion;
    static_cast<void>(es_simulation_options_init(&simulation, sizeof simulation));
    static_cast<void>(es_motion_options_init(&motion, sizeof motion));
    simulation.order = 1;
    simulation.rays = c.chance(0.2) ? 50 : 0;
    simulation.length = 0.05;
    simulation.threads = c.threads();
    motion.step = c.number(1e-4, 1e3, {0.01, 1.0});
    double path[8] = {0.0, 0.5, 0.5, 0.5, 1.0};
    const double* place = c.points(1, 1.0);
    for (int k = 0; place != nullptr && k < 3; ++k) {
        path[5 + k] = place[k];
    }
    motion.source_path = place == nullptr ? nullptr : path;
    motion.source_path_count = 2;
    es_sound wet = 0;
    const es_scene scene = c.handle(ES_KIND_SCENE);
    const es_sound dry = c.handle(ES_KIND_SOUND);
    return kept(c, es_auralize_moving(scene, dry, &simulation, &motion, c.out(wet)), wet);
}

es_status play_paths(Caller& c) {
    es_simulation_options simulation;
    static_cast<void>(es_simulation_options_init(&simulation, sizeof simulation));
    simulation.format = c.chance(0.8) ? ES_FORMAT_AMBISONIC : c.choice(3);
    simulation.threads = c.threads();
    const es_sound dry = c.handle(ES_KIND_SOUND);
    es_sound wet = 0;
    if (c.below(2) == 0) {
        const char* file = c.text({"fuzz.json", "none"});
        const char* source = c.text({"source1", "nobody"}, true);
        const char* listener = c.text({"listener1", ""}, true);
        return kept(
            c, es_auralize_paths(file, source, listener, dry, &simulation, c.out(wet)), wet);
    }
    const es_result results[] = {c.handle(ES_KIND_RESULT), c.some(ES_KIND_RESULT)};
    const es_result_info info = info_of(results[0]);
    const std::size_t count = c.chance(0.9) ? 2 : c.count(1);
    c.wrong = c.wrong || count < 2 || results[1] == 0;
    const auto source = static_cast<std::uint32_t>(c.index(info.sources));
    const auto listener = static_cast<std::uint32_t>(c.index(info.listeners));
    return kept(c,
                es_auralize_results(results, count, source, listener, dry, &simulation, c.out(wet)),
                wet);
}

es_status read_sound(Caller& c) {
    const es_sound sound = c.handle(ES_KIND_SOUND);
    const double* samples = nullptr;
    size_t frames = 0, channels = 0;
    if (c.below(2) == 0) {
        const es_status status =
            es_sound_samples(sound, c.out(samples), c.out(frames), c.out(channels), nullptr);
        keep_reading(status == ES_OK ? sum(samples, frames * channels) : 0.0);
        return status;
    }
    const char* file = c.text({"fuzz.wav", "fuzz.flac", "fuzz.mp3", ""});
    return es_sound_write(sound, file, nullptr);
}

es_status make_map(Caller& c) {
    const es_scene scene = c.handle(ES_KIND_SCENE);
    es_simulation_options simulation = simulation_options_of(c);
    simulation.rays = 0;
    es_map_options given;
    es_map_options_init(&given, sizeof given);
    given.area = c.choice(3);
    given.material = static_cast<std::uint32_t>(c.below(4));
    given.rectangle[0] = c.number(-1e9, 1e9, {-1.0, 1.0});
    given.rectangle[2] = c.number(-1e9, 1e9, {1.0, 3.0});
    given.rectangle[1] = -1.0;
    given.rectangle[3] = 2.0;
    given.height = c.number(-1e9, 1e9, {0.1, 2.0});
    given.step = c.number(1e-3, 1e9, {0.5, 2.0});
    given.coarse_step = c.chance(0.8) ? 0.0 : c.number(given.step, 1e9);
    given.clearance = c.number(0.0, 1e9, {0.0, 0.3});
    given.point_count = c.count(6);
    given.points = c.points(given.point_count);
    given.metrics = c.text({"sti", "t30,c80", "g:125", "", "t3O", ","}, true);
    // Whether these fail is not told by each alone: other members say which are read.
    c.wrong = false;
    es_metric_map map = 0;
    return kept(c, es_map_create(scene, &simulation, &given, c.out(map)), map);
}

es_status use_map(Caller& c) {
    const es_metric_map map = c.handle(ES_KIND_METRIC_MAP);
    es_map_info info{};
    info.struct_size = sizeof info;
    static_cast<void>(es_map_get_info(map, &info));
    const double *values = nullptr, *errors = nullptr;
    std::size_t count = 0;
    switch (c.below(8)) {
        case 0: {
            std::size_t shape[3] = {};
            const es_status status = es_map_values(map, c.out(values), &errors, shape);
            const std::size_t numbers = shape[0] * shape[1] * shape[2];
            keep_reading(status == ES_OK ? sum(values, numbers) + sum(errors, numbers) : 0.0);
            return status;
        }
        case 1: {
            const es_status status = es_map_cells(map, c.out(values), &count);
            keep_reading(status == ES_OK ? sum(values, 4 * count) : 0.0);
            return status;
        }
        case 2: {
            es_map_limit limit{};
            limit.struct_size = sizeof limit;
            const std::size_t source = c.index(info.sources), metric = c.index(info.metrics);
            const double value = c.number(-1e9, 1e9, {0.3, 1.0});
            const std::int32_t is_minimum = c.flag();
            return es_map_evaluate_limit(map, source, metric, value, is_minimum, c.out(limit));
        }
        case 3: {
            const std::size_t metric = c.index(info.metrics);
            const char *name = nullptr, *unit = nullptr;
            return es_map_metric(map, metric, &name, &unit, nullptr, nullptr);
        }
        case 4: {
            const std::size_t source = c.index(info.sources), metric = c.index(info.metrics);
            const double level = c.number(-1e9, 1e9, {0.3, 1.0});
            const std::size_t capacity = c.count(20);
            double* at = c.room(3 * capacity, capacity == 0);
            std::uint32_t* lines = c.numbers(capacity, capacity == 0);
            return es_map_contour(map, source, metric, level, at, lines, capacity, c.out(count));
        }
        case 5:
            return es_map_write(map, c.text({"fuzz.csv", "fuzz.json", "none/none.csv", "fuzz"}));
        case 6: {
            const std::size_t source = c.index(info.sources), metric = c.index(info.metrics);
            const es_scene scene = c.chance(0.3) ? 0 : c.handle(ES_KIND_SCENE);
            const double limit =
                c.chance(0.5) ? std::numeric_limits<double>::quiet_NaN() : c.number(-1e9, 1e9);
            const char* file = c.text({"fuzz.svg", "fuzz.png", "none/none.svg", "fuzz"});
            return es_map_draw(map, source, metric, scene, limit, file);
        }
        default:
            return es_map_points(map, c.out(values), &count);
    }
}

es_status read_files(Caller& c) {
    std::uint64_t handle = 0;
    const char* file = c.text({"none", "fuzz.wav", "fuzz.json", "fuzz.pvs", "/", ""});
    return c.below(2) == 0 ? kept(c, es_sound_read(file, c.out(handle)), handle)
                           : kept(c, es_visible_sets_read(file, c.out(handle)), handle);
}

es_status criterion(Caller& c) {
    double levels[7];
    const double number = c.number(15.0, 70.0);
    return es_noise_criterion(number, c.out(levels[0]));
}

}  // namespace

const std::vector<WeightedCall>& simulation_calls() {
    static const std::vector<WeightedCall> calls = {{"simulate", simulate, 4},
                                                    {"create_simulator", create_simulator, 2},
                                                    {"run_simulator", run_simulator, 4},
                                                    {"init", init, 3},
                                                    {"views", views, 40},
                                                    {"metrics", metrics, 20},
                                                    {"documents", documents, 4},
                                                    {"write_report", write_report, 3},
                                                    {"make_map", make_map, 2},
                                                    {"use_map", use_map, 8},
                                                    {"make_sound", make_sound, 10},
                                                    {"use_sound", use_sound, 10},
                                                    {"play_moving", play_moving, 1},
                                                    {"play_paths", play_paths, 4},
                                                    {"read_sound", read_sound, 8},
                                                    {"read_files", read_files, 3},
                                                    {"criterion", criterion, 2}};
    return calls;
}

}  // namespace earshot::capi_fuzz
