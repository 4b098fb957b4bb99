// SPDX-License-Identifier: MIT
#pragma once

#include "support/compare_paths.h"

namespace earshot::support {

struct CompareOptions {
    frustum::TraceOptions trace{};  ///< max_order counts for the oracle, too
    OracleOptions oracle{};         ///< max_order is taken from `trace`
    PathTolerance tolerance{};
};

/// Traces and searches by brute force, and compares.
Comparison compare_with_oracle(const geometry::Mesh& mesh,
                               std::span<const std::uint32_t> labels,
                               const geometry::Vec3& source,
                               std::span<const geometry::Vec3> listeners,
                               const CompareOptions& options);

/// The same with default options up to an order.
Comparison compare_with_oracle(const geometry::Mesh& mesh,
                               std::span<const std::uint32_t> labels,
                               const geometry::Vec3& source,
                               std::span<const geometry::Vec3> listeners,
                               int max_order);

}  // namespace earshot::support
