// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/mesh.h"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace earshot::frustum {

/// How frusta look for facets. Both modes verify every candidate sequence exactly, so neither
/// reports a false path; only `complete` promises that none is missing.
enum class Mode {
    complete,  ///< conservative: every facet that may be visible in a frustum is followed
    sampled,   ///< one sample ray per sub-frustum (Lauterbach 2010, section 6.1)
};

struct TraceOptions {
    int max_order = 4;  ///< of reflections and transmissions along a path, 0 ... 64
    Mode mode = Mode::complete;
    /// Sub-frusta along each side of a frustum, 1 ... 1024. In `complete` mode it changes the time
    /// only; 0 takes the mode's default.
    int resolution = 0;
    /// Longer paths are left out, metres.
    double max_length = std::numeric_limits<double>::infinity();
    /// Paths are left out for which the product of SceneView::max_pressure_factor over their
    /// facets, divided by their length in metres, is less.
    double min_pressure = 0.0;
    /// Answer rooms that are boxes by their image lattice in place of frusta, in complete mode.
    /// Changes the time only.
    bool box_lattice = true;

    friend bool operator==(const TraceOptions&, const TraceOptions&) = default;
};

/// Throws Error if an option is out of range.
void validate(const TraceOptions& options);

/// A sound path with specular reflections and straight transmissions.
struct SpecularPath {
    std::size_t listener = 0;                     ///< index into the listeners asked for
    std::vector<geometry::TriangleId> triangles;  ///< one per facet that it meets, source first
    /// One per triangle: 1 where the sound is transmitted, 0 where it is reflected. Empty: it is
    /// reflected everywhere.
    std::vector<std::uint8_t> transmitted{};
    std::vector<geometry::Vec3> points;  ///< source, where it meets facets, listener
    double length = 0.0;                 ///< metres
    friend bool operator==(const SpecularPath&, const SpecularPath&) = default;
};

/// Counts of work, for tables and benchmarks.
struct TraceStatistics {
    std::uint64_t frusta = 0;      ///< frusta traced through the hierarchy
    std::uint64_t candidates = 0;  ///< facet sequences that were verified for a listener
    std::uint64_t paths = 0;       ///< paths found, duplicates counted once
    /// Of kept beam trees: frusta that were not traced again, and sequences whose verdict of the
    /// instant before still held.
    std::uint64_t kept_frusta = 0, kept_candidates = 0;

    TraceStatistics& operator+=(const TraceStatistics& other) noexcept {
        frusta += other.frusta;
        candidates += other.candidates;
        paths += other.paths;
        kept_frusta += other.kept_frusta;
        kept_candidates += other.kept_candidates;
        return *this;
    }
    friend bool operator==(const TraceStatistics&, const TraceStatistics&) = default;
};

struct TraceResult {
    std::vector<SpecularPath> paths;  ///< sorted by listener, length, order, triangles
    TraceStatistics statistics;
};

}  // namespace earshot::frustum
