// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/base/progress.h"
#include "earshot/capi/earshot.h"
#include "earshot/capi/internal/result_object.h"
#include "earshot/capi/internal/visible_sets_object.h"
#include "earshot/propagation/response.h"
#include "earshot/propagation/simulator.h"

#include <memory>
#include <optional>

namespace earshot::capi {

/// An es_simulation_options that was checked, and what is prepared once for many runs.
class Simulation {
public:
    /// Null: the defaults. Throws Failure, or Error as what it prepares.
    explicit Simulation(const es_simulation_options* options);
    Simulation(const Simulation&) = delete;
    Simulation& operator=(const Simulation&) = delete;

    double time() const noexcept { return given_.time; }
    int threads() const noexcept { return given_.threads; }
    es_progress_callback progress() const noexcept { return given_.progress; }
    void* progress_data() const noexcept { return given_.progress_data; }
    const propagation::Options& options() const noexcept { return options_; }

    /// Simulates the scene of the simulator at `time`.
    std::shared_ptr<ResultObject> run(propagation::Simulator& simulator,
                                      const propagation::Scene& scene,
                                      double time,
                                      Executor& executor,
                                      Progress& progress) const;

private:
    void render(const propagation::Scene& scene,
                double time,
                ResultObject& result,
                Executor& executor,
                Progress& progress) const;
    void describe_room(const propagation::Simulator& simulator,
                       const propagation::Scene& scene,
                       double time,
                       ResultObject& result,
                       Executor& executor) const;
    void describe_materials(const propagation::Scene& scene,
                            double time,
                            ResultObject& result,
                            Executor& executor) const;

    es_simulation_options given_;
    std::shared_ptr<VisibleSetsObject> visible_sets_;  // kept alive for options_
    propagation::Options options_;
    propagation::ResponseFormat format_;
    std::optional<propagation::ResponseRenderer> renderer_;
};

/// Throws Error if a scene has no source or no listener.
void require_emitters(const propagation::Scene& scene);

}  // namespace earshot::capi
