// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/bvh/tree.h"
#include "earshot/geometry/facets.h"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace earshot::frustum {

/// The scene at one instant, as the tracer sees it. Everything is owned by the caller and must
/// outlive the call.
struct Surroundings {
    const bvh::Tree& tree;           ///< over the triangles of `mesh`
    geometry::MeshView mesh;         ///< clean: no degenerate triangles
    const geometry::Facets& facets;  ///< of `mesh`
    /// Per facet: 1 if it reflects on its front only. Empty: every facet reflects on both sides.
    std::span<const std::uint8_t> one_sided{};
    /// Per facet: 1 if sound also goes straight through it, from either side. Empty: none does.
    std::span<const std::uint8_t> lets_through{};
    /// Per facet: no encounter with it leaves a path more of its pressure than this share. Empty:
    /// all. For TraceOptions::least_pressure.
    std::span<const double> gain{};
};

/// How frusta look for facets. Both modes verify every proposed path exactly, so neither reports a
/// false one; only `complete` promises that none is missing.
enum class Mode {
    complete,  ///< conservative: every facet that can be seen in a frustum is followed
    sampled,   ///< one sample ray per sub-frustum (Lauterbach 2010, section 6.1)
};

struct TraceOptions {
    int max_order = 4;  ///< most facets that a path meets, reflected or let through, >= 0
    Mode mode = Mode::complete;
    /// Sub-frusta along each side of a frustum, 1 ... 1024. In `complete` mode it changes the time
    /// only; 0 takes the mode's default.
    int resolution = 0;
    /// Longer paths are left out, metres.
    double max_length = std::numeric_limits<double>::infinity();
    /// Paths are left out for which the product of Surroundings::gain over their facets, divided by
    /// their length in metres, is less.
    double least_pressure = 0.0;
};

/// A sound path with mirror reflections, and straight ways through facets.
struct SpecularPath {
    std::size_t listener = 0;                     ///< index into the listeners asked for
    std::vector<geometry::TriangleId> triangles;  ///< one per facet that it meets, source first
    /// One per triangle: 1 where the sound goes through. Empty: nowhere.
    std::vector<std::uint8_t> passes{};
    std::vector<geometry::Vec3> points;  ///< source, where it meets facets, listener
    double length = 0.0;                 ///< metres
    friend bool operator==(const SpecularPath&, const SpecularPath&) = default;
};

/// What a trace did, for tables and benchmarks.
struct TraceStatistics {
    std::uint64_t frusta = 0;      ///< frusta traced through the hierarchy
    std::uint64_t candidates = 0;  ///< facet sequences proposed for a listener
    std::uint64_t paths = 0;       ///< paths verified, duplicates counted once
};

struct TraceResult {
    std::vector<SpecularPath> paths;  ///< sorted by listener, length, order, triangles
    TraceStatistics statistics;
};

/// Every specular path from `source` to each listener up to options.max_order. Frusta over whole
/// facets find candidate facet sequences; each is then built from exact image sources and its legs
/// are tested against the hierarchy, so no reported path is approximate. A path that meets an edge
/// shared by two facets stands once. A leg that touches a triangle other than at its own
/// reflection points is blocked, unless the facet lets sound through and does not run along the
/// leg. Throws Error if an option is out of range.
TraceResult find_specular_paths(const Surroundings& surroundings,
                                const geometry::Vec3& source,
                                std::span<const geometry::Vec3> listeners,
                                const TraceOptions& options = {},
                                Executor& executor = Executor::serial());

}  // namespace earshot::frustum
