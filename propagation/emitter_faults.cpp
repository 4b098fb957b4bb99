// SPDX-License-Identifier: MIT
#include "earshot/propagation/internal/emitter_faults.h"

#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>

#include <algorithm>

namespace earshot::propagation {
namespace {

/// An emitter that sees at least this share of backs is behind surfaces, not before them.
constexpr double kMinBackShare = 0.9;
/// An emitter of whose rays more than the second share leave the scene is outside where another's
/// hardly do.
constexpr double kMaxEscapesInside = 0.1;
constexpr double kMinEscapesOutside = 0.5;

bool contains(const std::vector<std::uint32_t>& ascending, std::uint32_t value) {
    return std::binary_search(ascending.begin(), ascending.end(), value);
}

class FaultFinder {
public:
    FaultFinder(std::span<const PlacedEmitter> emitters, const EmitterSurroundings& surroundings)
        : emitters_(emitters), of_(surroundings) {}

    std::optional<MisplacedEmitter> fault_of(std::size_t i) const {
        const auto fault = [&](EmitterFault kind, bool is_proven) {
            return MisplacedEmitter{.is_source = emitters_[i].is_source,
                                    .index = emitters_[i].index,
                                    .position = emitters_[i].position,
                                    .fault = kind,
                                    .is_proven = is_proven};
        };
        const bool sees_backs = of_.reached.back_share[i] >= kMinBackShare &&
                                of_.reached.escape_share[i] < kMinEscapesOutside;
        if (sees_backs && is_in_small_surface(i)) {
            return fault(EmitterFault::in_solid, true);
        }
        if (const auto is_proven = outside(i)) {
            return fault(EmitterFault::outside, *is_proven);
        }
        if (!is_alone(i)) {
            return std::nullopt;
        }
        if (sees_backs && sees_fronts_anywhere()) {
            return fault(EmitterFault::in_solid, false);
        }
        return fault(EmitterFault::sealed, is_parted_from_counterparts(i));
    }

private:
    bool is_small(std::uint32_t surface) const {
        const geometry::Island& island = of_.surfaces[surface];
        return 2.0 * glm::length(island.upper - island.lower) < glm::length(of_.extent.size());
    }

    bool is_in_small_surface(std::size_t i) const {
        const auto& place = of_.enclosures[i];
        return place && std::any_of(place->inside.begin(),
                                    place->inside.end(),
                                    [&](std::uint32_t surface) { return is_small(surface); });
    }

    /// Whether an emitter is outside of what holds others, and if so, whether that is proven.
    std::optional<bool> outside(std::size_t i) const {
        const auto& mine = of_.enclosures[i];
        for (std::size_t k = 0; k < emitters_.size(); ++k) {
            const auto& other = of_.enclosures[k];
            // Who is in a closed room of its own is not outside of the other's.
            if (!mine || !other || is_enclosed_without(*mine, *other)) {
                continue;
            }
            for (const std::uint32_t surface : other->inside) {
                if (!is_small(surface) && !contains(mine->inside, surface) &&
                    !contains(mine->on_surface, surface)) {
                    return true;
                }
            }
        }
        const geometry::Vec3& at = emitters_[i].position;
        const bool is_beyond = glm::any(glm::lessThan(at, of_.extent.lower)) ||
                               glm::any(glm::greaterThan(at, of_.extent.upper));
        bool others_are_inside = false;
        for (std::size_t k = 0; k < emitters_.size(); ++k) {
            others_are_inside =
                others_are_inside || (k != i && of_.reached.escape_share[k] < kMaxEscapesInside);
        }
        const bool escapes = of_.reached.escape_share[i] > kMinEscapesOutside;
        // In the open a source may well stand beside the model that it is heard with.
        return (is_beyond && !shares_air(i)) || (escapes && others_are_inside && is_alone(i))
                   ? std::optional<bool>(false)
                   : std::nullopt;
    }

    /// A closed surface holds the first, and not the second.
    static bool is_enclosed_without(const Separation::Enclosure& a,
                                    const Separation::Enclosure& b) {
        return std::any_of(a.inside.begin(), a.inside.end(), [&](std::uint32_t surface) {
            return !contains(b.inside, surface) && !contains(b.on_surface, surface);
        });
    }

    bool shares_air(std::size_t i) const {
        for (std::size_t k = 0; k < emitters_.size(); ++k) {
            if (emitters_[k].is_source != emitters_[i].is_source &&
                of_.reached.air_of_point[k] == of_.reached.air_of_point[i]) {
                return true;
            }
        }
        return false;
    }

    /// No counterpart shares its air although there are some.
    bool is_alone(std::size_t i) const {
        bool has_counterpart = false;
        for (std::size_t k = 0; k < emitters_.size(); ++k) {
            if (emitters_[k].is_source != emitters_[i].is_source) {
                has_counterpart = true;
                if (of_.reached.air_of_point[k] == of_.reached.air_of_point[i]) {
                    return false;
                }
            }
        }
        return has_counterpart;
    }

    bool sees_fronts_anywhere() const {
        return std::any_of(of_.reached.back_share.begin(),
                           of_.reached.back_share.end(),
                           [](double share) { return share < 1.0 - kMinBackShare; });
    }

    /// A closed surface lies between it and every counterpart.
    bool is_parted_from_counterparts(std::size_t i) const {
        for (std::size_t k = 0; k < emitters_.size(); ++k) {
            if (emitters_[k].is_source == emitters_[i].is_source) {
                continue;
            }
            const auto& mine = of_.enclosures[i];
            const auto& other = of_.enclosures[k];
            if (!mine || !other) {
                return false;
            }
            if (!is_enclosed_without(*mine, *other) && !is_enclosed_without(*other, *mine)) {
                return false;
            }
        }
        return true;
    }

    std::span<const PlacedEmitter> emitters_;
    const EmitterSurroundings& of_;
};

}  // namespace

std::vector<PlacedEmitter> placed_emitters(const Scene& scene, double time) {
    std::vector<PlacedEmitter> placed;
    for (std::size_t i = 0; i < scene.sources.size(); ++i) {
        placed.push_back({true, i, scene.position_at(scene.sources[i], time)});
    }
    for (std::size_t i = 0; i < scene.listeners.size(); ++i) {
        placed.push_back({false, i, scene.position_at(scene.listeners[i], time)});
    }
    return placed;
}

std::vector<MisplacedEmitter> find_misplaced(std::span<const PlacedEmitter> emitters,
                                             const EmitterSurroundings& surroundings) {
    const FaultFinder finder(emitters, surroundings);
    std::vector<MisplacedEmitter> misplaced;
    for (std::size_t i = 0; i < emitters.size(); ++i) {
        if (const auto fault = finder.fault_of(i)) {
            misplaced.push_back(*fault);
        }
    }
    return misplaced;
}

}  // namespace earshot::propagation
