// SPDX-License-Identifier: MIT
#include "support/compare_with_oracle.h"

#include "support/traced_room.h"

namespace earshot::support {

Comparison compare_with_oracle(const geometry::Mesh& mesh,
                               std::span<const std::uint32_t> labels,
                               const geometry::Vec3& source,
                               std::span<const geometry::Vec3> listeners,
                               const CompareOptions& options) {
    OracleOptions search = options.oracle;
    search.max_order = options.trace.max_order;
    const OracleResult oracle =
        search_image_sources(mesh.view(), labels, source, listeners, search);
    const TracedRoom room(mesh, labels, search.one_sided_labels);
    return compare_paths(
        room.trace(source, listeners, options.trace).paths, oracle, mesh, options.tolerance);
}

Comparison compare_with_oracle(const geometry::Mesh& mesh,
                               std::span<const std::uint32_t> labels,
                               const geometry::Vec3& source,
                               std::span<const geometry::Vec3> listeners,
                               int max_order) {
    return compare_with_oracle(
        mesh, labels, source, listeners, CompareOptions{.trace = {.max_order = max_order}});
}

}  // namespace earshot::support
