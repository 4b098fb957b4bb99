// SPDX-License-Identifier: MIT
#include "earshot/capi/internal/checks.h"
#include "earshot/capi/internal/scene_object.h"
#include "earshot/capi/internal/simulation_options.h"
#include "earshot/capi/internal/work.h"
#include "earshot/io/scene_glb.h"
#include "earshot/io/simplification_report.h"
#include "earshot/io/whole_file.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <utility>

namespace earshot::capi {
namespace {

// Those of `earshot simplify`.
constexpr es_simplify_options kDefaults = {.struct_size = sizeof(es_simplify_options),
                                           .distance = 0.01,
                                           .max_frequency = 0.0,
                                           .angle_deg = 180.0,
                                           .object_size = std::numeric_limits<double>::quiet_NaN(),
                                           .progress = nullptr,
                                           .progress_data = nullptr,
                                           .threads = 0,
                                           .reserved = 0};

es_simplify_options checked(const es_simplify_options* options) {
    if (options == nullptr) {
        return kDefaults;
    }
    const es_simplify_options whole =
        require_struct(*options, kDefaults, sizeof(es_simplify_options), "options");
    constexpr double kMaxLength = 1e3;
    constexpr double kMaxFrequency = 1e5;
    require_in(whole.distance, 1e-4, kMaxLength, "options->distance");
    require_in(whole.max_frequency, 0.0, kMaxFrequency, "options->max_frequency");
    require_in(whole.angle_deg, 0.0, 180.0, "options->angle_deg");
    if (!std::isnan(whole.object_size)) {
        require_in(whole.object_size, 0.0, kMaxLength, "options->object_size");
    }
    require_threads(whole.threads, "options->threads");
    require_in(std::int64_t{whole.reserved}, 0, 0, "options->reserved");
    return whole;
}

propagation::SimplificationOptions limits_of(const es_simplify_options& options) {
    propagation::SimplificationOptions limits{.max_distance = options.distance};
    if (options.max_frequency > 0.0) {
        limits = propagation::options_for_frequency(
            options.max_frequency, propagation::speed_of_sound(propagation::Air{}));
    }
    constexpr double kDegree = 0.017453292519943295;
    limits.max_angle = std::min(limits.max_angle, kDegree * options.angle_deg);
    if (!std::isnan(options.object_size)) {
        limits.max_object_size = options.object_size;
        limits.boxes = options.object_size > 0.0;
    }
    return limits;
}

std::shared_ptr<SceneObject> simplified_of(const SceneObject& original,
                                           const es_simplify_options& options,
                                           const es_simulation_options* simulation) {
    CallbackProgress progress(options.progress, options.progress_data);
    propagation::SimplificationOptions limits = limits_of(options);
    limits.progress = &progress;
    Executor executor(options.threads);
    const propagation::Scene& before = original.loaded.scene;
    const auto start = std::chrono::steady_clock::now();
    propagation::SimplifiedModel model = propagation::simplify_model(before, limits, executor);
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    std::optional<propagation::ModelComparison> comparison;
    if (simulation != nullptr && !before.sources.empty() && !before.listeners.empty()) {
        comparison = propagation::compare_models(before,
                                                 model.scene,
                                                 simulator_options(checked_options(simulation)),
                                                 executor,
                                                 &progress);
    }
    auto object = std::make_shared<SceneObject>();
    object->loaded = original.loaded;
    object->read_as = original.read_as;
    object->has_unit_option = original.has_unit_option;
    object->simplification_json =
        io::encode_simplification_report({.model = model,
                                          .options = limits,
                                          .comparison = comparison ? &*comparison : nullptr,
                                          .seconds = seconds.count()});
    object->loaded.scene = std::move(model.scene);
    return object;
}

}  // namespace
}  // namespace earshot::capi

using namespace earshot;
using namespace earshot::capi;

es_status es_simplify_options_init(es_simplify_options* options, size_t size) {
    return call(__func__,
                [&] { init_struct(kDefaults, options, size, sizeof(es_simplify_options)); });
}

es_status es_scene_simplify(es_scene scene,
                            const es_simplify_options* options,
                            const es_simulation_options* simulation,
                            es_scene* simplified) {
    return call(__func__, [&] {
        const Reading<SceneObject> object(scene, "scene");
        require(simplified, "simplified");
        const es_simplify_options whole = checked(options);
        require_triangles_of(object->loaded.scene);
        *simplified = publish(simplified_of(*object, whole, simulation));
    });
}

es_status es_scene_simplification_json(es_scene scene, const char** text) {
    return call(__func__, [&] {
        const Reading<SceneObject> object(scene, "scene");
        require(text, "text") = object->simplification_json.c_str();
    });
}

es_status es_scene_write(es_scene scene, const char* file) {
    return call(__func__, [&] {
        const Reading<SceneObject> object(scene, "scene");
        const std::string name(require_text(file, "file"));
        require_triangles_of(object->loaded.scene);
        if (object->loaded.scene.mesh.duration() > 0.0) {
            throw Error(object->loaded.scene.name, "moves", "write a scene without animation");
        }
        io::write_whole_file(name, io::encode_glb(object->loaded.scene));
    });
}
