// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/capi/internal/object_table.h"
#include "earshot/propagation/engine/engine.h"

#include <atomic>
#include <mutex>

namespace earshot::capi {

/// An engine, whose three kinds of threads are kept apart: calls that move things take turns, of
/// those that update or render there is one at a time.
struct EngineObject : ObjectOf<ES_KIND_ENGINE> {
    EngineObject(const propagation::Scene& scene,
                 const propagation::EngineOptions& options,
                 int threads)
        : executor(threads), engine(scene, options, executor) {}

    Executor executor;
    mutable propagation::Engine engine;
    mutable std::mutex control;
    mutable std::mutex update;  // held by whoever updates, starts or ends the thread of updates
    mutable bool is_started = false;
    mutable std::atomic<bool> is_rendering{false};
};

}  // namespace earshot::capi
