// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/mesh.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace earshot::support {

struct OracleOptions {
    int max_order = 3;
    /// How far from its plane a facet's vertices may lie, metres. 0: four units in the last place
    /// of single precision at the largest coordinate, because files store floats.
    double coplanar_tolerance = 0.0;
    /// Decisions that a shift of less than this many metres would turn are not decided.
    double ambiguity_margin = 1e-9;
    /// Per label: 1 if its triangles reflect on their front only. Missing labels: both sides.
    std::vector<std::uint8_t> one_sided_labels{};
    /// Gives up sequences early. Off: every sequence is tried, for the test of the pruning.
    bool prunes = true;
};

struct OraclePath {
    std::size_t listener = 0;
    std::vector<std::uint32_t> labels;   ///< of the facets met, source first
    std::vector<geometry::Vec3> points;  ///< source, reflection points, listener
    double length = 0.0;                 ///< metres
    /// Metres by which something would have to move before the path appears or disappears: positive
    /// if it is a path, cut off at 1e-3.
    double margin = 0.0;
};

struct OracleResult {
    std::vector<OraclePath> paths;      ///< certain: margin >= ambiguity_margin
    std::vector<OraclePath> ambiguous;  ///< |margin| < ambiguity_margin: on an edge, or grazing
};

/// Every specular path by brute force (Borish 1984): all sequences of facets, each built backwards
/// from its image sources in extended precision, each leg tested against every facet. A sequence is
/// given up early only where no point of the next facet can be reached from the image source
/// through the ones before (half-spaces and cones around bounding balls). Shares no code with the
/// library beyond the mesh type. Paths are sorted by listener, order, length; the same polyline
/// stands once.
OracleResult search_image_sources(const geometry::MeshView& mesh,
                                  std::span<const std::uint32_t> labels,
                                  const geometry::Vec3& source,
                                  std::span<const geometry::Vec3> listeners,
                                  const OracleOptions& options = {});

/// The tolerance that OracleOptions::coplanar_tolerance = 0 stands for.
double default_coplanar_tolerance(const geometry::MeshView& mesh);

}  // namespace earshot::support
