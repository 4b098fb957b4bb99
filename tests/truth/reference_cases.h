// SPDX-License-Identifier: MIT
#pragma once

#include "support/rooms.h"
#include <ostream>
#include <string>
#include <vector>

namespace earshot::support {

/// One table of tests/data/paths and the question it answers.
struct ReferenceCase {
    std::string name;   ///< of the test
    std::string table;  ///< file in tests/data/paths
    Room (*room)() = reference_box;
    geometry::Vec3 source{};
    geometry::Vec3 listener{};
    int max_order = 3;
    std::size_t ambiguous = 0;  ///< paths beyond the table that meet an edge exactly
};

inline void PrintTo(const ReferenceCase& one, std::ostream* stream) {  // NOLINT: gtest's spelling
    *stream << one.table;
}

/// The tables' rooms and positions, from the README of the reference data.
inline std::vector<ReferenceCase> reference_cases() {
    struct Placing {
        std::string name;
        geometry::Vec3 source;
        geometry::Vec3 listener;
    };
    std::vector<ReferenceCase> cases = {{.name = "box_order_3",
                                         .table = "oracle-shoebox-o3.csv",
                                         .room = reference_box,
                                         .source = from_z_up(2.0, 1.5, 1.2),
                                         .listener = from_z_up(5.5, 4.0, 1.6),
                                         .max_order = 3}};
    const std::vector<Placing> placings = {
        {"los", from_z_up(1.0, 4.6, 1.5), from_z_up(4.4, 0.9, 1.2)},
        {"nlos", from_z_up(1.5, 5.0, 1.5), from_z_up(5.0, 1.8, 1.2)},
        {"symedge", from_z_up(1.0, 4.5, 1.5), from_z_up(4.5, 1.0, 1.2)}};
    for (const Placing& placing : placings) {
        for (const int order : {3, 4}) {
            cases.push_back(
                {.name = placing.name + "_order_" + std::to_string(order),
                 .table = "oracle-lroom-" + placing.name + "-o" + std::to_string(order) + ".csv",
                 .room = reference_l_room,
                 .source = placing.source,
                 .listener = placing.listener,
                 .max_order = order,
                 .ambiguous = placing.name == "symedge" && order == 4 ? 1U : 0U});
        }
    }
    return cases;
}

}  // namespace earshot::support
