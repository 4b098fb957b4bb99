// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/mesh.h"
#include "earshot/visibility/global_sampling.h"
#include "earshot/visibility/internal/mutation_store.h"

#include <cstdint>
#include <optional>
#include <vector>

namespace earshot::visibility {

/// A line to be cast both ways from a point on it.
struct Sample {
    SampleDistribution distribution = SampleDistribution::two_point;
    geometry::Ray ray{};
    std::optional<Candidate> origin{};  ///< what was varied
    geometry::Vec3 aimed_at{};          ///< of a silhouette mutation: just beside the object
};

/// Draws the lines of each distribution. Sample i of a distribution is a pure function of the seed,
/// i and, for mutations, of what is varied. Only reads what it was given, which must outlive it.
class SampleSource {
public:
    SampleSource(const geometry::MeshView& mesh,
                 const Objects& objects,
                 const ViewRegion& region,
                 std::uint64_t seed);

    /// Precondition: there are objects; a mutation has an origin.
    void draw(Sample& sample, std::uint64_t index) const;

    /// Half the diagonal of the object's box, metres.
    double radius(ObjectId object) const noexcept { return radii_[object]; }

    /// Whether a ray from `from` through `towards` meets the object, if nothing else were there.
    bool meets(const geometry::Vec3& from, const geometry::Vec3& towards, ObjectId object) const;

private:
    struct Spot {
        geometry::Vec3 point, normal;
    };
    double number(std::uint64_t index, std::uint32_t base) const noexcept;
    geometry::Vec3 in_region(std::uint64_t index) const noexcept;
    Spot on_object(std::uint64_t index) const noexcept;
    geometry::Ray lambert_ray(std::uint64_t index) const;
    geometry::Ray two_point_mutation(const Candidate& origin, std::uint64_t index) const;
    void silhouette_mutation(Sample& sample, std::uint64_t index) const;

    geometry::MeshView mesh_;
    const Objects& objects_;
    ViewRegion region_;
    std::uint64_t seed_;
    double reach_ = 0.0;  // the largest absolute coordinate of the mesh
    std::vector<double> radii_;
    std::vector<double> areas_;  // triangles in the order of their objects, summed up in each
    std::vector<std::size_t> first_;
};

}  // namespace earshot::visibility
