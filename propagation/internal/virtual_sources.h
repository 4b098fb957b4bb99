// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/geometry/aabb.h"
#include "earshot/propagation/coherent_sampling.h"
#include "earshot/propagation/internal/ray_surface.h"
#include "earshot/propagation/late_energy.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace earshot::propagation {

/// A point of a surface that radiates by Lambert's law what it reflects (instant radiosity: Keller
/// 1997).
struct VirtualSource {
    geometry::Vec3 position{0.0};  ///< a little off the surface, on the side that radiates
    geometry::Vec3 normal{0.0};    ///< unit, to that side
    geometry::TriangleId triangle = 0;
    double travelled = 0.0;          ///< metres from the source of sound
    SamplingKey key{};               ///< of the ray and its reflection: the same at every update
    std::size_t first_of_bands = 0;  ///< of its energies in VirtualSources::energies()
};

/// The virtual sources that the rays of one source of sound leave behind where they are reflected.
/// Ray i has the same random numbers at every update, so that the virtual sources move with what
/// moves, and stay where nothing does: a ray is traced again from the first leg that comes near
/// something that moved.
///
/// The last reflection on the way to a listener is by Lambert's law, whatever the material; all
/// others are scattered or specular by the material. Sound that was only reflected specularly, up
/// to RayOptions::specular_order times, is left out.
class VirtualSources {
public:
    /// Of the options count: rays, seed, length, specular_order, bands, air and transmission.
    explicit VirtualSources(const RayOptions& options);

    /// Follows source and scene. The result is that of new virtual sources, to the bit. Returns how
    /// many legs were traced. Precondition: materials and the source's directivity do not change.
    std::size_t update(const RayScene& scene,
                       const RaySource& source,
                       Executor& executor = Executor::serial());

    /// In the order of rays and their reflections. Valid until the next update.
    std::span<const VirtualSource> list() const noexcept { return list_; }
    /// Per band, in the units of EnergyHistogram: `share` of it arrives at a listener, see
    /// lambert_share().
    std::span<const double> energies(const VirtualSource& source) const noexcept {
        return {energies_.data() + source.first_of_bands, options_.bands.count()};
    }
    /// As LateEnergy::visible_volume.
    double visible_volume() const noexcept { return visible_volume_; }
    const RayOptions& options() const noexcept { return options_; }

private:
    /// From one reflection to the next.
    struct Leg {
        geometry::Ray ray;
        geometry::TriangleId from = 0;  // but for the first leg
        double travelled = 0.0;         // metres, at its start
        int specular_reflections = 0;   // and transmissions before
        bool scattered_before = false;
        bool is_traced = false;
        SamplingKey key{};  // of its virtual source on the side from which it comes
        std::optional<geometry::Hit> hit{};
        audio::Spectrum energy{};
    };
    /// The surface that a leg hits, and where.
    struct Arrival {
        const RaySurface& surface;
        geometry::Vec3 point, normal;  // the normal on the side of the leg
        double along = 0.0;            // the leg's direction, in parts of the triangle's normal
        geometry::Vec3 triangle_normal;
    };

    bool is_same_start(const RaySource& source) const;
    std::optional<std::vector<geometry::Aabb>> moved_boxes(const RayScene& scene) const;
    void start(const RayScene& scene, const RaySource& source);
    void forget_legs_in(std::span<const geometry::Aabb> boxes);
    void remember(const RayScene& scene, const RaySource& source);
    std::size_t trace(const RayScene& scene, std::size_t first, std::size_t last);
    Arrival arrival(const RayScene& scene, const Leg& leg) const;
    std::optional<Leg> next_leg(const Arrival& arrival, const Leg& leg, std::uint64_t key) const;
    void list_sources(const RayScene& scene);
    void add_source(const Arrival& arrival,
                    const Leg& leg,
                    double side,
                    const SamplingKey& key,
                    const audio::Spectrum& energy);

    RayOptions options_;
    double max_distance_ = 0.0;
    double self_intersection_offset_ = 0.0;
    std::vector<std::vector<Leg>> legs_;  // per ray
    std::vector<RaySurface> surfaces_;    // two per material: front and back
    // Of the last update.
    std::vector<geometry::Vec3> positions_;
    std::vector<geometry::Triangle> triangles_;
    std::vector<std::uint32_t> materials_;
    RaySource source_{};

    std::vector<VirtualSource> list_;
    std::vector<double> energies_;
    double visible_volume_ = 0.0;
};

/// The share of a virtual source's energy that reaches a point in sight, per square metre of its
/// distance: cos / (pi d^2), 0 behind the surface. Distances below kMinVirtualDistance count as
/// that, as one virtual source stands for a part of the surface.
double lambert_share(const VirtualSource& source, const geometry::Vec3& point) noexcept;

inline constexpr double kMinVirtualDistance = 0.25;  ///< metres

}  // namespace earshot::propagation
