// SPDX-License-Identifier: MIT
#include "earshot/propagation/plausibility.h"

#include "earshot/base/math.h"
#include "earshot/geometry/tolerance.h"
#include "earshot/propagation/internal/closed_surfaces.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace earshot::propagation {
namespace {

using geometry::Vec3;

constexpr double kMinExtent = 1.5;       // metres: of a booth
constexpr double kMaxExtent = 200.0;     // metres: of an arena
constexpr double kMinHeight = 1.8;       // metres: of a person
constexpr double kMaxHeight = 40.0;      // metres: of a cathedral
constexpr double kMinSide = 0.8;         // metres: the width of a corridor, for proposed sizes
constexpr double kMaxVolume = 200000.0;  // cubic metres
constexpr double kUsualHeight = 3.0;     // metres

double largest_side(const Vec3& size) {
    return std::max({size.x, size.y, size.z});
}

/// The property of a scene that is implausible for a room; empty if there is none.
std::string implausible(const Vec3& size, double volume) {
    const double extent = largest_side(size);
    if (extent < kMinExtent || extent > kMaxExtent) {
        return "an extent of " + short_text(extent) + " m";
    }
    if (size.y < kMinHeight || size.y > kMaxHeight) {
        return "a height of " + short_text(size.y) + " m";
    }
    return volume > kMaxVolume ? "a volume of " + short_text(volume) + " m3" : "";
}

/// The score of a changed up axis: the up axis of the file is kept unless the size of the scene
/// clearly contradicts it.
constexpr double kSwapPenalty = 0.1;

/// A score that is 0 for a room of the usual height. It increases with the deviation from that
/// height, and for a scene that is higher than wide.
double improbability(const Vec3& size) {
    return std::abs(math::log(size.y / kUsualHeight)) +
           std::max(0.0, math::log(size.y / std::min(size.x, size.z)));
}

/// A source or a listener with its position.
struct PlacedEmitter {
    const Emitter* emitter = nullptr;
    bool is_source = false;
    Vec3 position{0.0};

    std::string name() const {
        return (is_source ? "source \"" : "listener \"") + emitter->name + "\" at " +
               short_text(position.x) + ", " + short_text(position.y) + ", " +
               short_text(position.z);
    }
};

std::vector<PlacedEmitter> placed_emitters(const Scene& scene, double time) {
    std::vector<PlacedEmitter> placed;
    for (const Emitter& source : scene.sources) {
        placed.push_back({&source, true, scene.position_at(source, time)});
    }
    for (const Emitter& listener : scene.listeners) {
        placed.push_back({&listener, false, scene.position_at(listener, time)});
    }
    return placed;
}

bool is_beyond(const SceneExtent& extent, const Vec3& point, double tolerance) {
    return glm::any(glm::lessThan(point, extent.lower - tolerance)) ||
           glm::any(glm::greaterThan(point, extent.upper + tolerance));
}

/// The side of a closed surface that a point lies on. A point on the surface counts as on the same
/// side as every other point.
enum class Side { inside, outside, on_surface };

/// Whether a source and a listener lie on different sides of a closed surface.
bool separates_a_pair(const std::vector<PlacedEmitter>& placed, const std::vector<Side>& sides) {
    for (std::size_t i = 0; i < placed.size(); ++i) {
        for (std::size_t k = 0; k < placed.size(); ++k) {
            if (placed[i].is_source && !placed[k].is_source && sides[i] != sides[k] &&
                sides[i] != Side::on_surface && sides[k] != Side::on_surface) {
                return true;
            }
        }
    }
    return false;
}

}  // namespace

std::string short_text(double value) {
    std::array<char, 32> text{};
    const bool is_long = std::abs(value) >= 1000.0 && std::abs(value) < 1e12;
    std::snprintf(text.data(), text.size(), is_long ? "%.0f" : "%.3g", value);
    return text.data();
}

std::string size_text(const Vec3& size) {
    return short_text(size.x) + " x " + short_text(size.y) + " x " + short_text(size.z) +
           " m (height in the middle)";
}

SceneExtent scene_extent(const Scene& scene, double time) {
    const std::vector<Vec3> positions = scene.mesh.positions_at(time);
    const auto triangles = scene.mesh.triangles();
    SceneExtent extent{positions[triangles[0][0]], positions[triangles[0][0]]};
    for (const geometry::Triangle& triangle : triangles) {
        for (const geometry::VertexId vertex : triangle) {
            extent.lower = glm::min(extent.lower, positions[vertex]);
            extent.upper = glm::max(extent.upper, positions[vertex]);
        }
    }
    return extent;
}

std::optional<UnitProposal> propose_unit(const Vec3& size, double volume, const ReadAs& read_as) {
    UnitProposal best{.problem = implausible(size, volume)};
    if (best.problem.empty()) {
        return std::nullopt;
    }
    constexpr std::array<std::pair<std::string_view, double>, 4> kUnits{
        {{"mm", 0.001}, {"cm", 0.01}, {"in", 0.0254}, {"m", 1.0}}};
    double best_score = 0.0;
    for (const auto& [name, metres] : kUnits) {
        const double scale = metres / read_as.metres_per_unit;
        for (const bool swap_up_axis : {false, true}) {
            const Vec3 scaled = (swap_up_axis ? Vec3(size.x, size.z, size.y) : size) * scale;
            if (std::min(scaled.x, scaled.z) < kMinSide ||
                !implausible(scaled, volume * scale * scale * scale).empty()) {
                continue;
            }
            const double score = improbability(scaled) + (swap_up_axis ? kSwapPenalty : 0.0);
            if (best.unit.empty() || score < best_score) {
                best.unit = name;
                best.up = swap_up_axis ? (read_as.z_is_up ? "y" : "z") : "";
                best.size = scaled;
                best_score = score;
            }
        }
    }
    return best;
}

std::string unit_warning(const UnitProposal& proposal, const Vec3& size, bool has_unit_option) {
    const std::string found = "the scene measures " + size_text(size) + "; " + proposal.problem +
                              " is not that of a room";
    if (proposal.unit.empty()) {
        return found + (has_unit_option ? "; check the unit and the up axis (--units, --up)"
                                        : "; check scale and up axis of the export");
    }
    const std::string unit(proposal.unit);
    const std::string up(proposal.up);
    const std::string remedy =
        has_unit_option
            ? "--units " + unit + (up.empty() ? "" : " --up " + up) + " makes it "
            : "coordinates in " + unit + (up.empty() ? "" : " with +" + up + " up") + " would be ";
    return found + "; " + remedy + size_text(proposal.size);
}

Warnings misplaced_emitters(const Scene& scene, double time) {
    const std::vector<PlacedEmitter> placed = placed_emitters(scene, time);
    const SceneExtent extent = scene_extent(scene, time);
    const std::vector<Vec3> positions = scene.mesh.positions_at(time);
    const auto triangles = scene.mesh.triangles();
    const double tolerance = geometry::coplanar_tolerance({positions, triangles});
    Warnings warnings;
    std::vector<bool> is_reported(placed.size(), false);
    for (std::size_t i = 0; i < placed.size(); ++i) {
        if (is_beyond(extent, placed[i].position, tolerance)) {
            warnings.push_back({scene.name,
                                placed[i].name() + " lies outside of the scene, which measures " +
                                    size_text(extent.size())});
            is_reported[i] = true;
        }
    }
    for (const ClosedSurface& surface : closed_surfaces(positions, triangles)) {
        std::vector<Side> sides;
        for (const auto& [emitter, is_source, position] : placed) {
            sides.push_back(is_on(surface, positions, triangles, position, tolerance)
                                ? Side::on_surface
                            : is_inside(surface, positions, triangles, position) ? Side::inside
                                                                                 : Side::outside);
        }
        if (!separates_a_pair(placed, sides)) {
            continue;
        }
        // A surface at least half as large as the scene is assumed to be the boundary of the room,
        // a smaller one that of a solid.
        const bool is_room =
            2.0 * glm::length(surface.upper - surface.lower) >= glm::length(extent.size());
        for (std::size_t i = 0; i < placed.size(); ++i) {
            if (sides[i] != (is_room ? Side::outside : Side::inside) || is_reported[i]) {
                continue;
            }
            warnings.push_back(
                {scene.name,
                 placed[i].name() +
                     (is_room ? " lies outside of the closed surface of "
                              : " lies inside the closed surface of ") +
                     std::to_string(surface.triangles.size()) + " triangles that measures " +
                     size_text(surface.upper - surface.lower) +
                     (is_room ? ", which holds the others" : ", a solid or a room of its own")});
            is_reported[i] = true;
        }
    }
    return warnings;
}

}  // namespace earshot::propagation
