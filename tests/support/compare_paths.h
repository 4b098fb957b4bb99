// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/frustum/paths.h"

#include "support/image_source_oracle.h"
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace earshot::support {

/// How traced paths differ from the oracle's.
struct Comparison {
    std::size_t expected = 0;     ///< certain paths of the oracle
    std::size_t ambiguous = 0;    ///< paths of the oracle that may be reported or not
    std::size_t found = 0;        ///< traced paths
    std::size_t missed = 0;       ///< certain paths that were not traced
    std::size_t false_paths = 0;  ///< traced paths that the oracle does not know
    std::size_t doubled = 0;      ///< traced paths that repeat one already traced
    std::size_t misnamed = 0;     ///< traced paths with a triangle that lacks the reflection point
    std::string details{};        ///< one line for each of the first few differences

    void operator+=(const Comparison& other);
};

/// Metres by which the same path may differ between tracer and oracle. Double precision keeps a
/// length to about 1e-14 of it; a point on a wall met at grazing incidence is worse by the cosine
/// to the normal. Where vertices are rounded to single precision, facets are not quite plane and
/// `length` and `point` must allow for that.
struct PathTolerance {
    double length = 1e-9;
    double point = 1e-6;
};

/// Matches traced paths with the oracle's, listener by listener.
Comparison compare_paths(std::span<const frustum::SpecularPath> traced,
                         const OracleResult& oracle,
                         const geometry::Mesh& mesh,
                         const PathTolerance& tolerance = {});

}  // namespace earshot::support
