// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/math.h"
#include "earshot/base/random.h"
#include "earshot/propagation/internal/ray_tracer.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

namespace earshot::propagation {

/// Rays that are traced through the scene together, a reflection at a time. The number of bands is
/// known when this is compiled, so that a ray's energies are a few registers.
template <std::size_t kBands>
class RayBatch {
public:
    /// A batch of `rays` rays, which start with the whole energy of the source.
    RayBatch(const RayTracer& tracer, std::uint64_t rays, RayTally& tally)
        : tracer_(tracer),
          scene_(tracer.scene_),
          options_(tracer.options_),
          start_energy_(4.0 * math::kPi / static_cast<double>(rays)),
          tally_(tally) {}

    /// Records what needs no rays.
    void record_direct_scattering();
    /// Starts a ray. Numbers are drawn for its `id`.
    void emit(std::uint64_t id, const geometry::Vec3& direction);
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
        int reflections_of_image = 0;  // since then; a transmission counts as too many to be near
        bool scattered_before = false;
        bool rain_cast = false;                 // diffuse rain has recorded the leg that begins
        geometry::Vec3 scattering_normal{0.0};  // at the image, mirrored along
        double scattering_cosine = 0.0;         // of the direction in which it was scattered
    };
    /// The chord of a leg in the ball of a listener.
    struct Chord {
        std::size_t ray, listener;
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
        Energies energy;
    };
    struct Probabilities {
        double specular, scattered, transmitted;
        double rain;
    };
    /// The streams of one reflection.
    struct RandomStreams {
        RandomStream branch, direction, roulette, chord;
    };

    void find_hits(std::uint64_t bounce);
    bool interact(std::size_t i, const RandomStreams& random);
    Probabilities probabilities_at(const RaySurface& surface, const Energies& energy) const;
    void attenuate(const RaySurface& surface,
                   const audio::Spectrum& share,
                   double probability,
                   Energies& energy);
    void add_secondary_source(const SurfacePoint& point,
                              const RaySurface& surface,
                              double weight,
                              const Energies& energy);
    bool survives_roulette(const RandomStream& random, const Path& path, Energies& energy);
    void find_chords(const RandomStream& random);
    void find_chord(std::size_t i, std::size_t listener, double hit_distance, double random);
    void record_chords();
    void record_near_field(std::size_t i,
                           const geometry::Vec3& hit_point,
                           const geometry::Vec3& normal);
    void cast_diffuse_rain();
    void record(std::size_t listener,
                double travelled,
                const geometry::Vec3& towards,
                const Energies& energy,
                double share);
    static void add(double share, const Energies& energy, double* to) {
        for (std::size_t band = 0; band < kBands; ++band) {
            to[band] += share * energy[band];
        }
    }

    const RayTracer& tracer_;
    const RayScene& scene_;
    const RayOptions& options_;
    double start_energy_;  // of a ray
    RayTally& tally_;

    // Entry i of each belongs together.
    std::vector<geometry::Ray> rays_;
    std::vector<geometry::TriangleId> origin_triangles_;  // the triangle that the ray leaves
    std::vector<Path> paths_;
    std::vector<Energies> energies_;

    std::vector<std::optional<geometry::Hit>> hits_;
    std::vector<Chord> chords_;
    std::vector<SecondarySource> secondary_sources_;  // at least one per ray
    std::size_t secondary_source_count_ = 0;
    std::vector<geometry::Segment> shadow_rays_;
    std::vector<geometry::TriangleId> shadow_ray_origins_;
    std::vector<std::pair<std::size_t, std::size_t>>
        shadow_ray_ends_;  // secondary source, listener
    std::vector<std::uint8_t> occluded_;
};

}  // namespace earshot::propagation
