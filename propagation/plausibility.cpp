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
#include <limits>
#include <utility>

namespace earshot::propagation {
namespace {

using geometry::Vec3;

/// Limits of what a model measures, metres and cubic metres.
struct SizeLimits {
    double min_extent = 0.0, max_extent = 0.0;
    double min_height = 0.0, max_height = 0.0;
    double min_side = 0.0;  ///< on the ground, of proposed sizes
    double max_volume = std::numeric_limits<double>::infinity();
};

constexpr SizeLimits kRoom{.min_extent = 1.5,          // of a booth
                           .max_extent = 200.0,        // of an arena
                           .min_height = 1.8,          // of a person
                           .max_height = 40.0,         // of a cathedral
                           .min_side = 0.8,            // the width of a corridor
                           .max_volume = 2.0e5};       // of an arena
constexpr SizeLimits kOutdoors{.min_extent = 3.0,      // of a yard
                               .max_extent = 20000.0,  // of a city
                               .min_height = 0.0,      // of the ground alone
                               .max_height = 500.0,    // of a skyscraper
                               .min_side = 3.0};
constexpr double kUsualHeight = 3.0;    // of rooms
constexpr double kUsualExtent = 300.0;  // outdoors

/// The share of surfaces that absorb everything from which on they are taken for the sky.
constexpr double kMinSkyShare = 0.1;

/// Readings whose score is higher than the best by less than this, a factor of two in height, are
/// told too.
constexpr double kCloseScore = 0.7;

const SizeLimits& limits_of(ModelKind kind) {
    return kind == ModelKind::room ? kRoom : kOutdoors;
}

double largest_side(const Vec3& size) {
    return std::max({size.x, size.y, size.z});
}

/// The property of a scene that is implausible; empty if there is none.
std::string implausible(const SizeLimits& limits, const Vec3& size, double volume) {
    const double extent = largest_side(size);
    if (extent < limits.min_extent || extent > limits.max_extent) {
        return "an extent of " + short_text(extent) + " m";
    }
    if (size.y < limits.min_height || size.y > limits.max_height) {
        return "a height of " + short_text(size.y) + " m";
    }
    return volume > limits.max_volume ? "a volume of " + short_text(volume) + " m3" : "";
}

/// A score that is 0 for a room of the usual height, or outdoors for the usual extent. It increases
/// with the deviation from that, and for a scene that is higher than wide.
double improbability(ModelKind kind, const Vec3& size) {
    const double deviation = kind == ModelKind::room ? math::log(size.y / kUsualHeight)
                                                     : math::log(largest_side(size) / kUsualExtent);
    const double slenderness =
        size.y > 0.0 ? std::max(0.0, math::log(size.y / std::min(size.x, size.z))) : 0.0;
    return std::abs(deviation) + slenderness;
}

/// The score of a changed up axis: the up axis of the file is kept unless the size of the scene
/// clearly contradicts it.
constexpr double kSwapPenalty = 0.1;

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

ModelKind model_kind(const Scene& scene, double time) {
    std::vector<bool> is_sky;
    for (const Material& material : scene.materials) {
        const auto points = material.absorption.points();
        is_sky.push_back(std::all_of(
            points.begin(), points.end(), [](const auto& point) { return point.value == 1.0; }));
    }
    const std::vector<Vec3> positions = scene.mesh.positions_at(time);
    double area = 0.0;
    double sky = 0.0;
    for (std::size_t t = 0; t < scene.mesh.triangles().size(); ++t) {
        const auto [a, b, c] = geometry::corners(positions, scene.mesh.triangles()[t]);
        const double doubled = glm::length(glm::cross(b - a, c - a));
        area += doubled;
        sky += is_sky[scene.material_of_triangle[t]] ? doubled : 0.0;
    }
    return sky > 0.0 && sky >= kMinSkyShare * area ? ModelKind::outdoors : ModelKind::room;
}

std::optional<UnitProposal> propose_unit(const Vec3& size,
                                         double volume,
                                         const ReadAs& read_as,
                                         ModelKind kind) {
    const SizeLimits& limits = limits_of(kind);
    UnitProposal proposal{.kind = kind, .problem = implausible(limits, size, volume)};
    if (proposal.problem.empty()) {
        return std::nullopt;
    }
    constexpr std::array<std::pair<std::string_view, double>, 4> kUnits{
        {{"mm", 0.001}, {"cm", 0.01}, {"in", 0.0254}, {"m", 1.0}}};
    const bool is_flat = size.y <= std::min(size.x, size.z);
    std::vector<std::pair<double, UnitReading>> readings;
    for (const auto& [name, metres] : kUnits) {
        const double scale = metres / read_as.metres_per_unit;
        for (const bool swap_up_axis : {false, true}) {
            const Vec3 scaled = (swap_up_axis ? Vec3(size.x, size.z, size.y) : size) * scale;
            if ((swap_up_axis && is_flat) || std::min(scaled.x, scaled.z) < limits.min_side ||
                !implausible(limits, scaled, volume * scale * scale * scale).empty()) {
                continue;
            }
            const char* up = !swap_up_axis ? "" : read_as.z_is_up ? "y" : "z";
            readings.push_back({improbability(kind, scaled) + (swap_up_axis ? kSwapPenalty : 0.0),
                                {.unit = name, .up = up, .size = scaled}});
        }
    }
    const auto best =
        std::min_element(readings.begin(), readings.end(), [](const auto& a, const auto& b) {
            return a.first < b.first;
        });
    if (best != readings.end()) {
        proposal.best = best->second;
        for (const auto& [score, reading] : readings) {
            if (reading.unit != proposal.best.unit && score < best->first + kCloseScore) {
                proposal.others.push_back(reading);
            }
        }
    }
    return proposal;
}

std::string unit_reason(const UnitProposal& proposal) {
    return proposal.problem + " is not that of " +
           (proposal.kind == ModelKind::room ? "a room" : "a place outdoors");
}

std::string unit_warning(const UnitProposal& proposal, const Vec3& size, bool has_unit_option) {
    const std::string found =
        "the scene measures " + size_text(size) + "; " + unit_reason(proposal);
    if (proposal.best.unit.empty()) {
        return found + (has_unit_option ? "; check the unit and the up axis (--units, --up)"
                                        : "; check scale and up axis of the export");
    }
    const auto remedy = [has_unit_option](const UnitReading& reading) {
        const std::string unit(reading.unit);
        const std::string up(reading.up);
        return has_unit_option
                   ? "--units " + unit + (up.empty() ? "" : " --up " + up) + " makes it "
                   : "coordinates in " + unit + (up.empty() ? "" : " with +" + up + " up") +
                         " would be ";
    };
    std::string text = found + "; " + remedy(proposal.best) + size_text(proposal.best.size);
    for (const UnitReading& other : proposal.others) {
        text += ", " + remedy(other) + size_text(other.size);
    }
    return text;
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
