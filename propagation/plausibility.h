// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/error.h"
#include "earshot/geometry/types.h"
#include "earshot/propagation/scene.h"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace earshot::propagation {

// Whether a model means what its user thinks: a room in inches that is read in metres, or a
// listener inside a table, gives numbers that look like any others.

/// The size of a scene at one instant, metres, +Y up.
struct SceneExtent {
    geometry::Vec3 lower{0.0};
    geometry::Vec3 upper{0.0};

    geometry::Vec3 size() const noexcept { return upper - lower; }
};

/// Of all vertices that a triangle uses. Precondition: there is a triangle.
SceneExtent scene_extent(const Scene& scene, double time);

/// A number for people: three digits, without an exponent below 1e12.
std::string short_text(double value);

/// "8 x 3.5 x 6 m (height in the middle)".
std::string size_text(const geometry::Vec3& size);

/// How a file was read: its unit, and whether +Z was taken for up.
struct ReadAs {
    double metres_per_unit = 1.0;
    bool z_is_up = false;
};

/// What a scene is like if its coordinates are in another unit, or another axis is up.
struct UnitReading {
    std::string_view unit{};   ///< "mm", "cm", "in", "m"; empty: none makes it a room
    std::string_view up{};     ///< "y" or "z"; empty: the axis is right as it is
    geometry::Vec3 size{0.0};  ///< as it is read, metres
};

/// What a model is of: its size is judged by that.
enum class ModelKind : std::uint8_t { room, outdoors };

struct UnitProposal {
    ModelKind kind = ModelKind::room;
    std::string problem{};              ///< "an extent of 8000 m"
    UnitReading best{};                 ///< the most probable reading
    std::vector<UnitReading> others{};  ///< hardly less probable ones, in the order of the units
};

/// Outdoors if surfaces that absorb everything, as the sky is modelled, are a tenth or more of the
/// area of its triangles.
ModelKind model_kind(const Scene& scene, double time);

/// Limits of what a room measures: its largest side 1.5 ... 200 m, its height 1.8 ... 40 m, the
/// volume of its air at most 200,000 m3; outdoors the largest side 3 m ... 20 km, the height at
/// most 500 m. Empty if the scene keeps them. Otherwise the unit, of mm, cm, in and m, and the up
/// axis that make it keep them: of several those whose height is nearest to 3 m (outdoors: whose
/// largest side is nearest to 300 m), by ratio, and not above its other sides. The up axis changes
/// only where the height is not the smallest side. `volume` in cubic metres, 0 where it is unknown.
/// Feet cannot be told by size alone.
std::optional<UnitProposal> propose_unit(const geometry::Vec3& size,
                                         double volume,
                                         const ReadAs& read_as,
                                         ModelKind kind = ModelKind::room);

/// "an extent of 8000 m is not that of a room".
std::string unit_reason(const UnitProposal& proposal);

/// The message of a proposal. `has_unit_option`: the file's unit can be told by --units, as that of
/// a glTF file, which is always in metres, cannot.
std::string unit_warning(const UnitProposal& proposal,
                         const geometry::Vec3& size,
                         bool has_unit_option);

/// Sources and listeners that no sound can link, or that are probably misplaced, at `time`: a
/// listener outside of the closed surface around the sources, inside a solid, or beyond the
/// scene's extent. Each warning names the emitter and its position. A closed surface is a set of
/// connected triangles (vertices of one position are one) in which every edge has an even number
/// of triangles; which side a point is on is the parity of its crossings with a line.
Warnings misplaced_emitters(const Scene& scene, double time);

}  // namespace earshot::propagation
