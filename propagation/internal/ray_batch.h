// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/math.h"
#include "earshot/base/random.h"
#include "earshot/propagation/internal/ray_tracer.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace earshot::propagation {

/// Rays that start at a listener, against the direction of sound: they tell what surfaces near the
/// listener scatter to it. The source receives them.
struct ReversedRays {
    std::size_t listener = 0;
    std::uint64_t first_id = 0;
    std::span<const geometry::Vec3> directions;  ///< at the listener, of rays first_id, ...
};

/// Rays that are traced through the scene together, a reflection at a time. The number of bands is
/// known when this is compiled, so that a ray's energies are a few registers.
template <std::size_t kBands>
class RayBatch {
public:
    /// Rays from the source, each with the energy `start_energy`. Listeners that are not `active`
    /// receive nothing.
    RayBatch(const RayTracer& tracer,
             double start_energy,
             std::span<const std::uint8_t> active,
             BatchResult& result)
        : tracer_(tracer),
          scene_(tracer.scene_),
          options_(tracer.options_),
          surfaces_(tracer.surfaces_),
          receivers_(tracer.receivers_),
          active_(active),
          start_energy_(start_energy),
          materials_(tracer.reported_materials()),
          counts_(tracer.reflection_counts()),
          result_(result),
          balance_(result.balance) {}
    /// Reversed rays, which go on from their first scattering with about the energy
    /// `start_energy`.
    RayBatch(const RayTracer& tracer,
             double start_energy,
             const ReversedRays& reversed,
             BatchResult& result,
             EnergyBalance& balance)
        : tracer_(tracer),
          scene_(tracer.scene_),
          options_(tracer.options_),
          surfaces_(tracer.reversed_surfaces_),
          receivers_(&tracer.source_receiver_, 1),
          reversed_(&reversed),
          start_energy_(start_energy),
          materials_(tracer.reported_materials()),
          counts_(tracer.reflection_counts()),
          result_(result),
          balance_(balance) {}

    /// Starts a ray at the source. Numbers are drawn for its `id`.
    void emit(std::uint64_t id, const geometry::Vec3& direction);
    /// Starts reversed rays where they are scattered first; `energy` is that of each at the
    /// listener.
    void scatter_near(std::span<const NearScattering> places, double energy);
    bool has_rays() const { return !rays_.empty(); }
    /// Traces every ray to its next surface and reflects it there.
    void advance(std::uint64_t bounce);

private:
    using Energies = std::array<double, kBands>;

    /// The way of a ray. Unfolded, the way since the source or the last scattering begins at an
    /// image of that point, straight behind the leg.
    struct Path {
        double travelled = 0.0;       // metres
        double image_distance = 0.0;  // of that, since the image
        std::uint64_t id = 0;
        int specular_bounces = 0;
        int reflections_of_image = 0;  // since then; a transmission counts as too many to test
        std::array<geometry::TriangleId, kMaxTestedReflections> mirrors{};  // the first of them
        bool scattered_before = false;
        bool recorded_by_rain = false;          // the leg that begins
        std::uint32_t start = 0;                // of a reversed ray: index of its direction
        geometry::Vec3 scattering_normal{0.0};  // at the image, mirrored along
        double scattering_cosine = 0.0;         // of the direction in which it was scattered
        /// Of the only scattering point, per solid angle about the start of the ray: cosine /
        /// distance^2. 0: there is none, or there are several.
        double start_density = 0.0;
    };
    /// The chord of a leg in the ball of a listener.
    struct Chord {
        std::size_t ray, receiver;
        double travelled;
        geometry::Vec3 towards;
        double share;
    };
    struct SurfacePoint {
        geometry::Vec3 from, normal;  // offset from the surface, and pointing away from it
        double travelled = 0.0;
        geometry::TriangleId triangle = 0;
    };
    /// A secondary source of diffuse rain: energy that leaves a point of a surface by Lambert's
    /// law.
    struct SecondarySource {
        SurfacePoint point;
        std::uint64_t id = 0;        // of the ray
        std::uint32_t start = 0;     // likewise
        double start_density = 0.0;  // as in Path
        Energies energy;
    };
    /// What a receiver gets of a secondary source.
    struct Rain {
        std::size_t source, receiver;
        double weight;  // of this estimator
    };
    struct Probabilities {
        double specular, scattered, transmitted;
        double rain;
    };
    /// The streams of one reflection.
    struct RandomStreams {
        RandomStream branch, direction, roulette, chord, trials, rain;
    };

    void find_hits(std::uint64_t bounce);
    bool interact(std::size_t i, const RandomStreams& random);
    Probabilities probabilities_at(const RaySurface& surface, const Energies& energy) const;
    void attenuate(const RaySurface& surface,
                   const audio::Spectrum& share,
                   double probability,
                   Energies& energy);
    void scatter(std::size_t i, const SurfacePoint& point, double cosine, std::uint64_t bits);
    void add_secondary_source(const SurfacePoint& point,
                              const Path& path,
                              double cosine,
                              const RaySurface& surface,
                              double weight,
                              const Energies& energy);
    double single_scattering_density(const Path& path, double cosine) const;
    double estimator_weight(const Receiver& receiver,
                            double distance,
                            double cosine,
                            int reflections,
                            double start_density) const;
    bool survives_roulette(const RandomStream& random, const Path& path, Energies& energy);
    void survive(double probability, Energies& energy);
    double weight_in_window(const Path& path, const Energies& energy) const;
    void split(std::size_t i, const RandomStream& direction);
    void move_ray(std::size_t from, std::size_t to);
    void find_chords(const RandomStream& random);
    void find_chord(std::size_t i, std::size_t receiver, double hit_distance, double random);
    void record_chords(const RandomStream& trials);
    double image_weight(const Chord& chord, const RandomStream& trials) const;
    void record_near_field(std::size_t i,
                           const RaySurface& surface,
                           const geometry::Vec3& hit_point,
                           const geometry::Vec3& normal);
    double rain_probability(double along, double squared_distance) const;
    void cast_diffuse_rain(const RandomStream& random);
    bool is_active(std::size_t receiver) const { return reversed_ || active_[receiver] != 0; }
    void record(std::size_t receiver,
                std::uint32_t start,
                double travelled,
                const geometry::Vec3& towards,
                const Energies& energy,
                double share,
                const std::uint32_t* reflections);
    void record_at_listener(std::size_t listener,
                            double travelled,
                            const geometry::Vec3& towards,
                            const Energies& energy,
                            double share,
                            const std::uint32_t* reflections);
    void record_materials(std::size_t listener,
                          std::size_t bin,
                          const Energies& energy,
                          double share,
                          const std::uint32_t* reflections);
    void record_absorption(std::size_t material,
                           double travelled,
                           const RaySurface& surface,
                           const Energies& energy);
    /// Of a ray: RayTracer::reflection_counts(); of no use where nobody asked.
    std::uint32_t* reflections_of(std::size_t ray) { return reflections_.data() + ray * counts_; }
    const std::uint32_t* reflections_of(std::size_t ray) const {
        return reflections_.data() + ray * counts_;
    }
    /// Counts a reflection. Precondition: materials are reported.
    void count_reflection(std::uint32_t material,
                          bool is_scattered,
                          std::uint32_t* reflections) const {
        ++reflections[material];
        if (is_scattered && counts_ > materials_) {
            ++reflections[materials_ + material];
        }
    }
    /// The last secondary source has the reflections of a ray, and a scattering by a material.
    void set_rain_reflections(std::size_t ray, std::uint32_t material);
    static void add(double share, const Energies& energy, double* to) {
        for (std::size_t band = 0; band < kBands; ++band) {
            to[band] += share * energy[band];
        }
    }

    const RayTracer& tracer_;
    const RayScene& scene_;
    const RayOptions& options_;
    const RayTracer::Surfaces& surfaces_;
    std::span<const Receiver> receivers_;
    std::span<const std::uint8_t> active_{};  // per receiver
    const ReversedRays* reversed_ = nullptr;
    double start_energy_;    // of a ray
    std::size_t materials_;  // that are reported
    std::size_t counts_;     // of each ray, of its reflections
    BatchResult& result_;
    EnergyBalance& balance_;

    // Entry i of each belongs together.
    std::vector<geometry::Ray> rays_;
    std::vector<geometry::TriangleId> origin_triangles_;  // the triangle that the ray leaves
    std::vector<Path> paths_;
    std::vector<Energies> energies_;
    std::vector<std::uint32_t> reflections_;  // per ray: counts

    std::vector<std::optional<geometry::Hit>> hits_;
    std::vector<Chord> chords_;
    std::vector<SecondarySource> secondary_sources_;  // at least one per ray
    std::size_t secondary_source_count_ = 0;
    std::vector<std::uint32_t> rain_reflections_;  // per secondary source: counts
    std::vector<std::uint32_t> near_reflections_;  // counts of one contribution
    std::vector<geometry::Segment> shadow_rays_;
    std::vector<geometry::TriangleId> shadow_ray_origins_;
    std::vector<Rain> rain_;  // per shadow ray
    std::vector<std::uint8_t> occluded_;
};

}  // namespace earshot::propagation
