// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/bvh/wide_tree.h"
#include "earshot/propagation/late_rays.h"

#include <span>
#include <vector>

namespace earshot::propagation {

/// What a batch of rays brings home.
struct RayTally {
    std::vector<double> energy;      ///< listener after listener, bin after bin, band after band
    std::vector<double> directions;  ///< listener, span, part, band; empty where nobody asked
    EnergyBalance balance;
    double cubed_first_legs = 0.0;  ///< sum over rays that hit something, cubic metres
};

/// Follows rays of one source through one scene. Only reads what it was given, which must outlive
/// it; const members may be called from many threads at once.
class RayTracer {
public:
    RayTracer(const RayScene& scene,
              const RaySource& source,
              std::span<const geometry::Vec3> listeners,
              const RayOptions& options,
              Executor& executor);

    std::size_t bins() const noexcept { return bins_; }
    std::size_t spans() const noexcept;

    /// Rays begin ... end - 1 of options.rays.
    RayTally trace(std::uint64_t begin, std::uint64_t end) const;

private:
    /// What becomes of sound at a surface, per band.
    struct Surface {
        std::vector<double> absorbed, mirrored, scattered, through;  // shares of what arrives
        bool one_sided = false;
    };
    struct Path {
        double travelled = 0.0;  // metres
        std::uint64_t id = 0;
        int mirrors = 0;
        bool was_scattered = false;  // ever
        bool is_rain = false;        // the leg that begins has been heard as rain
    };
    /// Rays under way; entry i of each belongs together, energies are band after band.
    struct Flock {
        std::vector<geometry::Ray> rays;
        std::vector<Path> paths;
        std::vector<double> energy;
    };
    /// Energy that leaves a point of a surface after Lambert.
    struct Drop {
        geometry::Vec3 from, normal;
        double travelled = 0.0;
    };
    struct Rain {
        std::vector<Drop> drops;
        std::vector<double> energy;  // drop after drop
    };

    void describe_surfaces();
    double radius_for_space() const;
    geometry::Vec3 direction_of(std::uint64_t id, double count) const;
    void emit(std::uint64_t id, Flock& flock, EnergyBalance& balance) const;
    void advance(Flock& flock, std::uint64_t bounce, Rain& rain, RayTally& tally) const;
    void count_passages(const geometry::Ray& ray,
                        const Path& path,
                        const double* energy,
                        double reach,
                        RayTally& tally) const;
    void hear(std::size_t listener,
              double travelled,
              const geometry::Vec3& towards,
              const double* energy,
              double share,
              RayTally& tally) const;
    bool reflect(const geometry::Hit& hit,
                 std::uint64_t bounce,
                 geometry::Ray& ray,
                 Path& path,
                 double* energy,
                 Rain& rain,
                 EnergyBalance& balance) const;
    bool stays(double die, double* energy, EnergyBalance& balance) const;
    void let_it_rain(const Rain& rain, RayTally& tally) const;

    const RayScene& scene_;
    const RaySource& source_;
    std::span<const geometry::Vec3> listeners_;
    const RayOptions& options_;
    bvh::WideTree wide_;
    std::size_t bands_;
    double speed_;
    std::size_t bins_;
    double lift_;
    std::vector<Surface> surfaces_;        // per material
    std::vector<geometry::Vec3> normals_;  // per triangle
    std::vector<double> radii_;            // per listener
};

}  // namespace earshot::propagation
