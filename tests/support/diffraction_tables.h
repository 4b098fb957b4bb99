// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/math.h"
#include "earshot/propagation/diffraction.h"

#include <nlohmann/json.hpp>

#include "support/test_paths.h"
#include <cmath>
#include <complex>
#include <fstream>
#include <string>

namespace earshot::support {

/// A table of tests/data/diffraction.
inline nlohmann::json diffraction_table(const std::string& name) {
    std::ifstream file(test::source_file("tests/data/diffraction/" + name));
    return nlohmann::json::parse(file);
}

inline std::complex<double> complex_of(const nlohmann::json& pair) {
    return {pair[0].get<double>(), pair[1].get<double>()};
}

inline double radians(double angle_deg) {
    return angle_deg * math::kPi / 180.0;
}

inline double wave_number(double frequency_hz) {
    return 2.0 * math::kPi * frequency_hz / 343.0;
}

/// R0: the shortest way over the edge's line.
inline double apex_length(const propagation::EdgeDiffraction& edge) {
    return std::hypot(edge.source.radius + edge.listener.radius, edge.source.z - edge.listener.z);
}

inline double decibels(const std::complex<double>& a, const std::complex<double>& b) {
    return 20.0 * std::log10(std::abs(a) / std::abs(b));
}

}  // namespace earshot::support
