// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/frustum/paths.h"
#include "earshot/frustum/scene_view.h"
#include "earshot/geometry/wedge.h"

#include <optional>
#include <span>
#include <vector>

namespace earshot::frustum {

/// Why a sequence of facets is no path.
struct Rejection {
    enum class Reason {
        no_reflection,    ///< some point misses its facet, or the facets face another way
        blocked,          ///< a leg touches `occluder`
        blocked_by_layer  ///< a leg touches a triangle before which no transmissive layer lies
    };
    Reason reason = Reason::no_reflection;
    geometry::TriangleId occluder = 0;
};

/// Decides, in double precision and independently of how a sequence was found, whether the facets
/// `sequence` reflect sound from source to listener, and constructs the path. Every specular path
/// that is reported is made here.
///
/// The path is built backwards from the listener towards the image sources (Allen and Berkley 1979;
/// Borish 1984). It is valid if every reflection point lies in its facet (borders included, within
/// rounding), both neighbours of a reflection point are on one side of its facet (the front, if the
/// facet is one-sided), and no leg touches a triangle on the way. Consecutive facets lie on each
/// other's reflecting side, also where the path turns in the edge that they share, and no leg runs
/// between coincident layers. A leg may pass through transmissive facets, which are then added to
/// the path; of coincident layers the triangle with the lowest number counts.
class PathVerifier {
public:
    explicit PathVerifier(const SceneView& scene);

    /// `images[i]` is the source mirrored in the first i facets: images[0] is the source itself.
    /// Preconditions: images.size() == sequence.size() + 1, each made by Plane::mirror from the one
    /// before. The listener's index in the result is 0. `rejection`: set if there is no path; may
    /// be null.
    std::optional<SpecularPath> verify(std::span<const geometry::FacetId> sequence,
                                       std::span<const geometry::Vec3> images,
                                       const geometry::Vec3& listener,
                                       Rejection* rejection = nullptr) const;

    /// Whether sound over the sequence reaches a point on the edge of a wedge from within its air.
    /// As verify() for a listener there, but the surfaces that meet in the edge do not block the
    /// last leg, and transmissive facets do. Preconditions as for verify(); the last image lies in
    /// the wedge's sector, and no facet of the sequence ends in the edge.
    bool reaches_edge(std::span<const geometry::FacetId> sequence,
                      std::span<const geometry::Vec3> images,
                      const geometry::Wedge& wedge,
                      const geometry::Vec3& point) const;

    /// Whether the way over the sequence to a point has its reflection points in the facets,
    /// without regard to what lies between: if not, reaches_edge() is false. Preconditions as for
    /// verify().
    bool turns_in_facets(std::span<const geometry::FacetId> sequence,
                         std::span<const geometry::Vec3> images,
                         const geometry::Vec3& point) const;

    /// Metres: a point this close to a plane counts as in it, on a path of length `distance`.
    /// Sources and images within eight times as much of a facet's plane are not reflected there
    /// (the sound would graze the facet).
    double rounding_slack(double distance) const noexcept;

    /// Metres: only triangles that a leg meets this close to a reflection point can belong to the
    /// surface that reflects: neighbours across a corner, or a coincident layer.
    double contact_radius() const noexcept;

    /// Largest absolute coordinate of the scene, metres.
    double extent() const noexcept { return extent_; }

private:
    /// One end of a leg, for telling obstacles from the surface that reflects there.
    struct LegEnd {
        const geometry::FacetId* facet = nullptr;  // null: a source or listener
        double height = 0.0;  // metres of the other end above the facet's plane
    };

    bool belongs_to_reflection(const LegEnd& end,
                               geometry::TriangleId triangle,
                               double t,
                               double max_t) const;
    LegEnd end_of_leg(const geometry::FacetId* facet, const geometry::Vec3& other_end) const;
    std::optional<geometry::TriangleId> triangle_at(geometry::FacetId facet,
                                                    const geometry::Vec3& point,
                                                    double slack) const;
    template <typename Visit>
    void visit_triangles_at(geometry::FacetId facet,
                            const geometry::Vec3& point,
                            double slack,
                            Visit&& visit) const;
    bool extends_above(geometry::FacetId other,
                       double side,
                       geometry::FacetId facet,
                       const geometry::Vec3& point,
                       double slack) const;
    bool runs_between_layers(std::span<const geometry::FacetId> sequence,
                             const SpecularPath& path) const;
    bool turns_at_outer_edge(std::span<const geometry::FacetId> sequence,
                             std::span<const geometry::Vec3> images,
                             std::span<const geometry::Vec3> points,
                             double slack) const;
    /// Where a leg passes through a facet.
    struct Transmission {
        double t = 0.0;  // along the leg, 0 ... 1
        geometry::FacetId facet = 0;
        geometry::TriangleId triangle = 0;
    };

    std::optional<SpecularPath> reflect(std::span<const geometry::FacetId> sequence,
                                        std::span<const geometry::Vec3> images,
                                        const geometry::Vec3& listener) const;
    std::optional<SpecularPath> construct(std::span<const geometry::FacetId> sequence,
                                          std::span<const geometry::Vec3> images,
                                          const geometry::Vec3& listener) const;
    bool belongs_to_edge(const geometry::Wedge& wedge,
                         geometry::TriangleId triangle,
                         const geometry::Vec3& from,
                         const geometry::Vec3& to,
                         double t,
                         double max_t) const;
    bool leg_is_unobstructed(const SpecularPath& path,
                             std::span<const geometry::FacetId> sequence,
                             std::size_t leg,
                             const geometry::Wedge* edge,
                             std::vector<Transmission>& transmissions,
                             Rejection* rejection) const;
    bool leg_lies_in_plane(geometry::FacetId facet,
                           const geometry::Vec3& from,
                           const geometry::Vec3& to) const;
    void remove_covered(std::vector<Transmission>& transmissions,
                        const geometry::Vec3& from,
                        const geometry::Vec3& to) const;
    void deduplicate(std::vector<Transmission>& transmissions, double length) const;
    static void insert(SpecularPath& path,
                       std::size_t leg,
                       std::span<const Transmission> transmissions);

    bool is_transmissive(geometry::FacetId facet) const noexcept {
        return !scene_.transmissive.empty() && scene_.transmissive[facet] != 0;
    }
    /// By a transmissive layer, which then counts in place of the facet.
    bool may_be_covered(geometry::FacetId facet) const noexcept {
        return !may_be_covered_.empty() && may_be_covered_[facet] != 0;
    }

    SceneView scene_;
    std::vector<std::uint8_t> may_be_covered_;
    double extent_ = 0.0;
};

}  // namespace earshot::frustum
