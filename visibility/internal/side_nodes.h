// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/bvh/mesh_bvh.h"
#include "earshot/visibility/air_cut.h"
#include "earshot/visibility/triangle_sides.h"

#include <array>
#include <cstdint>
#include <vector>

namespace earshot::visibility {

/// Per triangle 1 if it meets another with which it shares no vertex: intersects it, or comes
/// within the tolerance (Zhou et al. 2008, section 2). A part of its sides may be covered; the
/// sides of other triangles lie in one air as a whole.
std::vector<std::uint8_t> find_meeting_triangles(const bvh::MeshBvh& bvh,
                                                 double tolerance,
                                                 Executor& executor);

/// The half-space nodes of the visibility graph (Zhou et al. 2008, section 3.1): node 2 k and its
/// opposite 2 k + 1 are the two sides of a cluster of triangles, or of a sample point on a triangle
/// that meets others.
class SideNodes {
public:
    SideNodes(const bvh::MeshBvh& bvh, const AirCutOptions& options, Executor& executor);

    std::size_t size() const noexcept { return 2 * areas_.size(); }
    std::size_t cluster_count() const noexcept { return clusters_.size(); }
    std::size_t sampled_triangles() const noexcept { return sampled_triangles_; }

    /// Square metres that the node stands for.
    double area(std::uint32_t node) const noexcept { return areas_[node / 2]; }
    bool is_sample(std::uint32_t node) const noexcept { return node / 2 >= clusters_.size(); }
    /// Triangles of a node: of a cluster all, of a sample one.
    std::size_t triangles(std::uint32_t node) const noexcept {
        return is_sample(node) ? 1 : clusters_[node / 2].sides.size();
    }

    /// Random ray `index` of a node.
    geometry::Ray ray(std::uint32_t node, std::uint64_t seed, std::uint64_t index) const;
    /// The triangle that the ray starts from.
    geometry::TriangleId origin(std::uint32_t node, std::uint64_t seed, std::uint64_t index) const;

    /// The node of a side that was hit at a point: of a sampled triangle that of the nearest
    /// sample.
    std::uint32_t node_at(SideId side, const geometry::Vec3& point) const;
    /// Where a sample looks from.
    const geometry::Vec3& eye(std::uint32_t sample_node) const noexcept {
        return samples_[sample_node / 2 - clusters_.size()].eyes[sample_node % 2];
    }

    /// The nodes of a triangle's front: one, or those of its samples.
    template <typename Visit>
    void for_each_node(SideId side, Visit&& visit) const {
        const geometry::TriangleId t = triangle_of(side);
        if (first_sample_[t] == kNone) {
            visit(cluster_node(side));
        } else {
            for (std::uint32_t i = 0; i < sample_count_; ++i) {
                visit(sample_node(t, i) + (is_back(side) ? 1U : 0U));
            }
        }
    }

private:
    static constexpr std::uint32_t kNone = 0xffffffffU;
    struct Cluster {
        std::vector<SideId> sides;       // of its front
        std::vector<double> area_until;  // cumulative
    };
    struct Sample {
        geometry::TriangleId triangle = 0;
        geometry::Vec3 point{0.0};
        std::array<geometry::Vec3, 2> eyes{};  // of front and back
    };

    std::uint32_t cluster_node(SideId side) const noexcept {
        return node_of_front_[triangle_of(side)] ^ (is_back(side) ? 1U : 0U);
    }
    std::uint32_t sample_node(geometry::TriangleId t, std::uint32_t i) const noexcept {
        return static_cast<std::uint32_t>(2 * (clusters_.size() + first_sample_[t] + i));
    }
    SideId random_side(std::uint32_t node, std::uint64_t seed, std::uint64_t index) const;
    void make_clusters(bool cluster);
    void make_samples(const AirCutOptions& options, Executor& executor);
    Sample placed(geometry::TriangleId t, double of_b, double of_c, double tolerance) const;

    bvh::MeshBvh bvh_;
    std::vector<std::uint8_t> meets_others_;    // per triangle
    std::vector<std::uint32_t> node_of_front_;  // per triangle of a cluster
    std::vector<std::uint32_t> first_sample_;   // per triangle that meets others
    std::uint32_t sample_count_ = 0;            // per such triangle
    std::size_t sampled_triangles_ = 0;
    std::vector<Cluster> clusters_;
    std::vector<Sample> samples_;
    std::vector<double> areas_;  // per node and its opposite
};

}  // namespace earshot::visibility
