// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/capi/internal/object_table.h"
#include "earshot/propagation/locate.h"

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace earshot::capi {

/// Located sources and listeners, and their views. Never changes.
struct LocationObject : ObjectOf<ES_KIND_LOCATION> {
    struct Points {
        std::vector<double> positions, standard_errors, data_shares;  // (count, 3)
    };

    LocationObject(propagation::LocateResult located,
                   std::vector<std::optional<double>> held_out_errors,
                   std::string document);

    propagation::LocateResult result;
    std::vector<std::optional<double>> held_out;
    std::string json;              // as the program writes it
    std::array<Points, 2> points;  // of sources, of listeners
    std::vector<double> latencies, latency_errors;
    std::vector<double> walls, wall_errors;  // (count, 5), (count)
    std::vector<std::uint32_t> wall_materials;
    std::vector<double> arrivals;  // (count, 4)
};

}  // namespace earshot::capi
