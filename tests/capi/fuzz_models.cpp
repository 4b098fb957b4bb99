// SPDX-License-Identifier: MIT
// Calls that check, mend and calibrate models.
#include "capi/fuzz_caller.h"

namespace earshot::capi_fuzz {
namespace {

es_status make_check(Caller& c) {
    const es_scene scene = c.handle(ES_KIND_SCENE);
    es_check_options given;
    es_check_options_init(&given, sizeof given);
    given.time = c.number(-1e12, 1e12);
    given.rays = c.chance(0.97) ? 1000 + c.count(2000) : c.count(999);
    c.wrong = c.wrong || given.rays < 1000;
    given.crack = c.number(0.0, 1.0);
    given.forecast_seconds = c.chance(0.97) ? 0.0 : -1.0;
    c.wrong = c.wrong || given.forecast_seconds < 0.0;
    given.threads = c.threads();
    es_model_check check = 0;
    return kept(c, es_check_create(scene, &given, c.out(check)), check);
}

/// Reads all of an array.
template <typename T>
es_status read_records(es_status status, const T* array, std::size_t count) {
    double read = 0.0;
    for (std::size_t i = 0; status == ES_OK && i < count * sizeof(T); ++i) {
        read += reinterpret_cast<const unsigned char*>(array)[i];
    }
    keep_reading(read);
    return status;
}

es_status use_check(Caller& c) {
    const es_model_check check = c.handle(ES_KIND_MODEL_CHECK);
    std::size_t count = 0;
    const auto records = [&](auto function, auto* array) {
        const es_status status = function(check, c.out(array), &count);
        return read_records(status, array, count);
    };
    const auto chosen = [&](auto function, int choices, auto* array) {
        const std::int32_t choice = c.choice(choices);
        const es_status status = function(check, choice, c.out(array), &count);
        return read_records(status, array, count);
    };
    switch (c.below(12)) {
        case 0:
            return records(es_check_leaks, static_cast<const es_leak*>(nullptr));
        case 1:
            return records(es_check_holes, static_cast<const es_hole*>(nullptr));
        case 2:
            return records(es_check_misplaced, static_cast<const es_misplaced*>(nullptr));
        case 3:
            return records(es_check_airs, static_cast<const es_air*>(nullptr));
        case 4:
            return records(es_check_materials, static_cast<const es_material_use*>(nullptr));
        case 5:
            return records(es_check_small_facets, static_cast<const es_small_facets*>(nullptr));
        case 6:
            return records(es_check_costs, static_cast<const es_order_cost*>(nullptr));
        case 7:
            return chosen(es_check_faces, 2, static_cast<const es_face_group*>(nullptr));
        case 8:
            return chosen(es_check_triangles, 3, static_cast<const std::uint32_t*>(nullptr));
        case 9:
            return chosen(es_check_air_of, 2, static_cast<const std::uint32_t*>(nullptr));
        case 10: {
            const char* file = c.text({"fuzz.json", "fuzz.csv", ""});
            const es_status status = es_check_write(check, file);
            c.wrong = false;
            return status;
        }
        default: {
            es_check_info info{};
            info.struct_size = sizeof info;
            static_cast<void>(es_check_get_info(check, &info));
            std::int32_t severity = 0;
            const char* text = nullptr;
            const std::size_t index = c.index(info.findings);
            return es_check_finding(check, index, &severity, c.out(text));
        }
    }
}

es_status mend(Caller& c) {
    std::uint64_t handle = 0;
    if (c.below(3) == 0) {
        const es_model_check check = c.handle(ES_KIND_MODEL_CHECK);
        es_mend_options given;
        es_mend_options_init(&given, sizeof given);
        given.max_hole_area = c.number(0.0, 1e6, {0.0, 10.0});
        given.freeze = c.flag();
        return kept(c, es_mending_create(check, &given, c.out(handle)), handle);
    }
    const es_mending mending = c.handle(ES_KIND_MENDING);
    const std::uint32_t* triangles = nullptr;
    std::size_t count = 0;
    switch (c.below(4)) {
        case 0: {
            const std::int32_t list = c.choice(5);
            const es_status status = es_mending_triangles(mending, list, c.out(triangles), &count);
            return read_records(status, triangles, count);
        }
        case 1:
            return kept(c, es_mending_scene(mending, c.out(handle)), handle);
        case 2: {
            const char* file = c.text({"fuzz.glb", "fuzz.gltf", ""});
            const es_status status = es_mending_write(mending, file);
            c.wrong = false;
            return status;
        }
        default: {
            es_mending_info info{};
            info.struct_size = sizeof info;
            return es_mending_get_info(mending, c.out(info));
        }
    }
}

es_status make_calibration(Caller& c) {
    const es_scene scene = c.handle(ES_KIND_SCENE);
    es_simulation_options simulation = simulation_options_of(c);
    simulation.rays = 0;
    es_calibration_options given;
    es_calibration_options_init(&given, sizeof given);
    given.default_error = c.number(1e-3, 1e3);
    given.spread = c.number(1e-3, 1e3);
    given.max_simulations = 1 + c.choice(2);
    given.fit_scattering = c.choice(2);
    std::array<es_measured_metric, 3> measured{};
    const std::size_t count = c.count(3);
    for (std::size_t i = 0; i < count; ++i) {
        measured[i] = {.source = static_cast<std::uint32_t>(c.below(3)),
                       .listener = static_cast<std::uint32_t>(c.below(3)),
                       .metric = c.choice(8),
                       .reserved = 0,
                       .band_hz = c.chance(0.1) ? 440.0 : 500.0,
                       .value = c.number(-1e6, 1e6, {0.3, 3.0}),
                       .error = c.number(0.0, 1e6, {0.0, 0.5})};
    }
    given.measured = c.text({"none.csv", "fuzz.csv", "/", ""}, true);
    // Indices and doubled values may be wrong whatever each member is.
    c.wrong = false;
    es_calibration calibration = 0;
    return kept(
        c,
        es_calibrate(scene, &simulation, &given, measured.data(), count, c.out(calibration)),
        calibration);
}

es_status use_calibration(Caller& c) {
    const es_calibration calibration = c.handle(ES_KIND_CALIBRATION);
    if (c.chance(0.3)) {
        return es_calibration_apply(calibration, c.handle(ES_KIND_SCENE));
    }
    const double* values = nullptr;
    std::size_t shape[2] = {};
    const es_status status = es_calibration_values(calibration, c.choice(9), c.out(values), shape);
    keep_reading(status == ES_OK ? sum(values, shape[0] * shape[1]) : 0.0);
    return status;
}

}  // namespace

const std::vector<WeightedCall>& model_calls() {
    static const std::vector<WeightedCall> calls = {{"make_calibration", make_calibration, 1},
                                                    {"use_calibration", use_calibration, 6},
                                                    {"make_check", make_check, 1},
                                                    {"use_check", use_check, 8},
                                                    {"mend", mend, 6}};
    return calls;
}

}  // namespace earshot::capi_fuzz
