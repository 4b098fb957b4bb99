// SPDX-License-Identifier: MIT
#include "earshot/capi/internal/checks.h"
#include "earshot/capi/internal/scene_object.h"
#include "earshot/capi/internal/simulation.h"
#include "earshot/capi/internal/work.h"

#include <memory>
#include <optional>

namespace earshot::capi {
namespace {

/// A copy of a scene, prepared.
struct SimulatorObject : ObjectOf<ES_KIND_SIMULATOR> {
    SimulatorObject(const propagation::Scene& the_scene, const es_simulation_options* options)
        : scene(the_scene), simulation(options) {}

    propagation::Scene scene;
    Simulation simulation;
    /// Empty after a run that failed midway.
    std::optional<propagation::Simulator> simulator;

    void prepare(Executor& executor) {
        if (!simulator) {
            simulator.emplace(scene, simulation.options(), executor);
        }
    }
};

}  // namespace
}  // namespace earshot::capi

using namespace earshot;
using namespace earshot::capi;

es_status es_simulate(es_scene scene, const es_simulation_options* options, es_result* result) {
    return call(__func__, [&] {
        const Reading<SceneObject> object(scene, "scene");
        require(result, "result");
        const propagation::Scene& contents = object->loaded.scene;
        const Simulation simulation(options);
        require_emitters(contents);
        Executor executor(simulation.threads());
        CallbackProgress progress(simulation.progress(), simulation.progress_data());
        propagation::Simulator simulator(contents, simulation.options(), executor);
        *result =
            publish(simulation.run(simulator, contents, simulation.time(), executor, progress));
    });
}

es_status es_simulator_create(es_scene scene,
                              const es_simulation_options* options,
                              es_simulator* simulator) {
    return call(__func__, [&] {
        const Reading<SceneObject> object(scene, "scene");
        require(simulator, "simulator");
        require_emitters(object->loaded.scene);
        auto prepared = std::make_shared<SimulatorObject>(object->loaded.scene, options);
        Executor executor(prepared->simulation.threads());
        prepared->prepare(executor);
        *simulator = publish(std::move(prepared));
    });
}

es_status es_simulator_run(es_simulator simulator, double time, es_result* result) {
    return call(__func__, [&] {
        const Changing<SimulatorObject> object(simulator, "simulator");
        require(result, "result");
        require_time(time, "time");
        const Simulation& simulation = object->simulation;
        Executor executor(simulation.threads());
        CallbackProgress progress(simulation.progress(), simulation.progress_data());
        object->prepare(executor);
        try {
            *result = publish(
                simulation.run(*object->simulator, object->scene, time, executor, progress));
        } catch (...) {
            object->simulator.reset();
            throw;
        }
    });
}

es_status es_simulator_set_position(es_simulator simulator,
                                    int32_t item,
                                    uint32_t index,
                                    const double position[3]) {
    return call(__func__, [&] {
        const Changing<SimulatorObject> object(simulator, "simulator");
        set_position(object->scene, item, index, require_point(position, "position"));
    });
}

es_status es_simulator_set_look_at(es_simulator simulator,
                                   int32_t item,
                                   uint32_t index,
                                   const double* point) {
    return call(__func__, [&] {
        const Changing<SimulatorObject> object(simulator, "simulator");
        set_look_at(object->scene, item, index, point);
    });
}
