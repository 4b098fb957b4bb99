// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/bvh/exact_coordinates.h"
#include "earshot/geometry/mesh.h"
#include "earshot/geometry/types.h"

#include <atomic>
#include <cstdint>
#include <span>

namespace earshot::bvh {

/// Finds the ExactCoordinates of a mesh, from any number of threads.
class CoordinateRules {
public:
    /// `max_abs_coordinate` chooses the decimal numbers that are looked for.
    explicit CoordinateRules(double max_abs_coordinate) noexcept;
    /// Finds no others than these.
    explicit CoordinateRules(const ExactCoordinates& candidate) noexcept;

    /// Excludes the rules that do not hold for all positions.
    void check(std::span<const geometry::Vec3> positions, Executor& executor);
    /// The same for the vertices of some triangles.
    void check(std::span<const std::uint32_t> triangles, const geometry::MeshView& mesh) noexcept;

    /// What holds for all vertices that were checked.
    ExactCoordinates result() const noexcept;

private:
    ExactCoordinates decimal_;
    std::atomic<bool> is_single_;
    std::atomic<bool> is_decimal_;
};

}  // namespace earshot::bvh
