// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/mesh.h"
#include "earshot/visibility/global_pvs.h"
#include "earshot/visibility/internal/mutation_candidates.h"
#include "earshot/visibility/region.h"

#include <cstdint>
#include <optional>
#include <vector>

namespace earshot::visibility {

/// A sample ray, to be cast both ways from its origin.
struct Sample {
    SampleDistribution distribution = SampleDistribution::two_point;
    geometry::Ray ray{};
    std::optional<MutationCandidate> candidate{};  ///< of a mutation
    geometry::Vec3 silhouette_point{};  ///< of a silhouette mutation: just past the object
};

/// Draws sample rays from each distribution. Sample i of a distribution is a pure function of the
/// seed, of i and, for mutations, of the candidate. Mesh and objects must outlive the generator.
class SampleGenerator {
public:
    SampleGenerator(const geometry::MeshView& mesh,
                    const Objects& objects,
                    const ViewRegion& region,
                    std::uint64_t seed);

    /// Draws the ray of a sample from its distribution. Precondition: there are objects; a mutation
    /// has a candidate.
    void draw(Sample& sample, std::uint64_t index) const;

    /// Radius of an object: half the diagonal of its box, metres.
    double radius(ObjectId object) const noexcept { return radii_[object]; }

    /// Whether a ray from `from` through `towards` intersects the object, all others left out.
    bool intersects(const geometry::Vec3& from,
                    const geometry::Vec3& towards,
                    ObjectId object) const;

private:
    struct SurfacePoint {
        geometry::Vec3 point, normal;
    };
    double number(std::uint64_t index, std::uint32_t base) const noexcept;
    geometry::Vec3 point_in_region(std::uint64_t index) const noexcept;
    SurfacePoint point_on_object(std::uint64_t index) const noexcept;
    geometry::Ray object_surface_ray(std::uint64_t index) const;
    geometry::Ray two_point_mutation(const MutationCandidate& candidate, std::uint64_t index) const;
    void silhouette_mutation(Sample& sample, std::uint64_t index) const;

    geometry::MeshView mesh_;
    const Objects& objects_;
    ViewRegion region_;
    std::uint64_t seed_;
    double max_coordinate_ = 0.0;  // largest absolute coordinate of the mesh
    std::vector<double> radii_;
    std::vector<double> areas_;  // of triangles, object by object, cumulative within each
    std::vector<std::size_t> first_area_;
};

}  // namespace earshot::visibility
