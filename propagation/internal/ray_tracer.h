// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/propagation/internal/near_field.h"
#include "earshot/propagation/internal/ray_surface.h"
#include "earshot/propagation/internal/receiver_tree.h"
#include "earshot/propagation/internal/weight_window.h"
#include "earshot/propagation/late_energy.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace earshot::propagation {

/// Rays of a batch, at most; numbers are drawn for (batch, ray).
inline constexpr std::uint64_t kMaxBatchRays = 2048;

/// Reflected and shadow rays start this far from a surface, re the extent of the scene: above the
/// rounding error of a hit, far below a wavelength.
inline constexpr double kSelfIntersectionOffset = 0x1p-32;

// Streams of random numbers of no reflection.
inline constexpr std::uint64_t kNearScatteringStream = std::uint64_t{1} << 63;
inline constexpr std::uint64_t kBallStream = kNearScatteringStream + 1;
inline constexpr std::uint64_t kFirstTrialStream = std::uint64_t{1} << 62;  // one per reflection
inline constexpr std::uint64_t kFirstRainStream = std::uint64_t{1} << 61;   // likewise

/// What a batch tells of materials, in the intervals of coarse_intervals(); empty where nobody
/// asked.
struct BatchMaterials {
    /// Listener, interval, material, band: energy times its reflections by the material, and energy
    /// that the material reflected at least once.
    std::vector<double> reflections, touched;
    std::vector<double> scatterings;  ///< as reflections, of those that scattered the energy
    /// Window of LateMaterials::absorbed, material, band: energy that the material absorbs, the
    /// loss in air before it included.
    std::vector<double> absorbed;
};

/// The result of a batch of rays.
struct BatchResult {
    std::vector<double> energy;      ///< listener after listener, bin after bin, band after band
    std::vector<double> directions;  ///< listener, interval, part, band; empty where nobody asked
    BatchMaterials materials;
    EnergyBalance balance;
    double visible_volume = 0.0;  ///< of the source, cubic metres
};

/// A ball about a receiver, which measures the energy density of specular legs.
struct ReceiverBall {
    double radius_squared = 0.0;
    double inverse_volume = 0.0;  ///< of the part of the ball that is visible from the receiver
};

/// A listener, or the source for reversed rays.
struct Receiver {
    geometry::Vec3 position{0.0};
    ReceiverBall ball{};            ///< for legs of rays that were never scattered
    ReceiverBall scattered_ball{};  ///< for those after a scattering
    /// Rays that start here, re those of a batch: the share that is scattered of the sound from
    /// surfaces near here, in the loudest band. 0: none scatters.
    double near_scattering = 0.0;
    /// Random points of the visible part of `ball`; empty where every image that the receiver sees
    /// is visible from all of it, and where exact paths leave no image to test.
    std::vector<geometry::Vec3> ball_points{};
    double rain_offset = 0.0;  ///< 0 ... 1, of its random numbers; see RayOptions::rain_radius
};

/// Reflections since the source, at most, whose image is tested for visibility from the receiver.
inline constexpr int kMaxTestedReflections = 4;

/// An image of the source.
struct ImageChain {
    geometry::Vec3 image{0.0};
    std::span<const geometry::TriangleId> mirrors{};  ///< in the order of the ray
    std::span<const RaySurface> surfaces{};           ///< as in RayTracer
};

/// A box that walls of one material each enclose.
struct RectangularRoom {
    std::array<geometry::Vec3, 3> axes{};
    /// Along each axis.
    std::array<double, 3> low{kInfinity, kInfinity, kInfinity};
    std::array<double, 3> high{-kInfinity, -kInfinity, -kInfinity};

    bool contains(const geometry::Vec3& point) const noexcept;

private:
    static constexpr double kInfinity = std::numeric_limits<double>::infinity();
};

/// Where a ray that starts at a listener is scattered first.
struct NearScattering {
    std::size_t start = 0;  ///< index of the ray's first direction
    geometry::Ray ray;      ///< that meets the place
    geometry::Hit hit;
    double travelled = 0.0;    ///< metres from the listener to the place, along the reflections
    audio::Spectrum energy{};  ///< at the place, re the start
    double share = 0.0;  ///< of the energy at the start that is scattered, in the loudest band
    /// Of the reflections before the place, as many as that.
    std::array<std::uint32_t, kMaxNearReflections> materials{};
    std::size_t reflections = 0;
};

/// Traces rays of one source through one scene. Only reads what it was given, which must outlive
/// it; const members may be called from many threads at once.
class RayTracer {
public:
    RayTracer(const RayScene& scene,
              const RaySource& source,
              std::span<const geometry::Vec3> listeners,
              const RayOptions& options,
              Executor& executor);

    /// Follows a change of the options' length or decay time; what is known of the scene stays.
    void set_length();
    void set_weight_window(WeightWindow window) { window_ = std::move(window); }

    std::size_t bins() const noexcept { return bins_; }
    std::size_t direction_intervals() const noexcept;
    /// Materials that batches report; 0 where nobody asked.
    std::size_t reported_materials() const noexcept {
        return options_.report_materials ? scene_.materials.size() : 0;
    }
    /// Numbers that a ray counts: reflections by each material, then those that scattered.
    std::size_t reflection_counts() const noexcept {
        return reported_materials() * (options_.report_scattering ? 2 : 1);
    }

    /// Batch `index`, which has `rays` rays and the whole energy of the source: a replicate of the
    /// experiment, independent of other batches.
    /// Leaves out listeners that are not `active`.
    BatchResult trace(std::uint64_t index,
                      std::uint64_t rays,
                      std::span<const std::uint8_t> active) const;

private:
    template <std::size_t kBands>
    friend class RayBatch;

    /// What a ray needs to know of a triangle.
    struct TriangleSurface {
        geometry::Vec3 normal;
        std::uint32_t front = 0;  // index of a surface; the back's is the next
    };
    /// Surfaces as rays of one direction see them, two per material: front and back.
    using Surfaces = std::vector<RaySurface>;

    double roulette_threshold(double travelled) const noexcept {
        const double step = std::min(travelled, max_distance_) * roulette_steps_per_metre_;
        return roulette_thresholds_[static_cast<std::size_t>(step)];
    }
    std::size_t material_intervals() const noexcept { return interval_of_bin_.back() + 1; }
    void describe_surfaces();
    void describe_intervals();
    BatchMaterials empty_materials() const;
    void describe_triangles();
    double scattered_radius() const;
    Receiver describe_receiver(const geometry::Vec3& position) const;
    void describe_receivers(std::span<const geometry::Vec3> listeners, Executor& executor);
    void describe_source();
    const RaySurface& reversed_surface(geometry::TriangleId triangle,
                                       const geometry::Vec3& direction) const;
    /// Of each direction at most one of the places that its ray meets, chosen by chance.
    /// `first_hits`: the closest hits of the rays in these directions.
    std::vector<NearScattering> find_near_scattering(
        const geometry::Vec3& from,
        std::span<const geometry::Vec3> directions,
        std::span<const std::optional<geometry::Hit>> first_hits,
        std::uint64_t first_id) const;
    geometry::Vec3 image_in(geometry::TriangleId triangle, const geometry::Vec3& point) const;
    bool is_same_mirror(const ImageChain& chain,
                        geometry::TriangleId one,
                        geometry::TriangleId other,
                        const geometry::Vec3& image,
                        const geometry::Vec3& direction) const;
    /// Whether a point sees an image by its mirrors, one after the other.
    bool is_visible(const ImageChain& chain, const geometry::Vec3& from) const;
    /// What to multiply the energy of an image with that a ray from it measured in the ball: 0 if
    /// the receiver does not see it; else its mean is the inverse of the share of the ball that
    /// does. Precondition: the receiver has ball_points.
    double image_weight(const Receiver& receiver,
                        const ImageChain& chain,
                        std::uint64_t random_key) const;
    std::vector<geometry::Vec3> draw_ball_points(const geometry::Vec3& centre) const;
    bool has_whole_walls(const RectangularRoom& room,
                         std::span<const std::size_t> axis_of_triangle) const;
    std::optional<RectangularRoom> find_rectangular_room() const;
    void trace_reversed(std::size_t listener,
                        std::uint64_t index,
                        std::uint64_t rays,
                        BatchResult& result) const;
    void limit_roulette();

    const RayScene& scene_;
    const RaySource& source_;
    const RayOptions& options_;
    std::size_t bands_;
    double max_distance_ = 0.0;  // metres that sound travels until the histogram ends
    double bins_per_metre_ = 0.0;
    std::size_t bins_ = 0;
    double self_intersection_offset_;
    Surfaces surfaces_;
    Surfaces reversed_surfaces_;                      // for rays against the direction of sound
    std::vector<TriangleSurface> triangle_surfaces_;  // per triangle
    std::optional<RectangularRoom> rectangular_room_;
    double scattered_radius_ = 0.0;          // of the balls for legs after a scattering, metres
    std::vector<Receiver> receivers_;        // per listener
    ReceiverTree receiver_tree_;             // over their balls
    Receiver source_receiver_;               // of reversed rays
    std::optional<NearField> source_field_;  // where surfaces near the source scatter
    /// Russian roulette begins below this share of a ray's first energy, per step of distance.
    std::vector<double> roulette_thresholds_;
    double roulette_steps_per_metre_ = 0.0;
    WeightWindow window_;  // in place of these, unless it is empty
    // For materials; empty where nobody asked.
    std::vector<std::size_t> interval_of_bin_;
    std::vector<double> air_loss_;  // of energy, per bin and band
};

}  // namespace earshot::propagation
