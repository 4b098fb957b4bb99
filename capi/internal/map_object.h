// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/capi/internal/object_table.h"
#include "earshot/propagation/metric_map.h"

#include <string>
#include <utility>
#include <vector>

namespace earshot::capi {

/// A map and its views. Never changes.
struct MapObject : ObjectOf<ES_KIND_METRIC_MAP> {
    MapObject(std::string scene_name, propagation::MetricMap metric_map);

    std::string scene;
    propagation::MetricMap map;
    std::vector<double> values, standard_errors;  // as map.values, NaN for nothing
    std::vector<double> points;                   // (points, 3)
    std::vector<double> cells;                    // (points, 4)
    std::vector<std::string> units;               // per metric
};

/// Of a limit of a metric, in its unit. Fails with the argument's name.
void require_map_limit(double value, const char* argument);

}  // namespace earshot::capi
