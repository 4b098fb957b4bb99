// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/collision/broad_phase/internal/leaf_slabs.h"
#include "earshot/collision/broad_phase/internal/normal_cones.h"
#include "earshot/collision/broad_phase/internal/swept_bvh.h"
#include "earshot/collision/internal/moving_scene.h"
#include "earshot/collision/narrow_phase/min_separation.h"
#include "earshot/collision/world.h"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace earshot::collision {

/// Tests the elements of pairs of triangles against each other: the tester of SweptPairs.
class ElementTester {
public:
    /// `representatives`: see representative_features(). Without `normal_cones` no node is culled
    /// by them. All arguments must outlive the tester.
    ElementTester(const MovingScene& scene,
                  const SweptBvh& swept_bvh,
                  const LeafSlabs& leaf_slabs,
                  const NormalCones* normal_cones,
                  std::span<const std::uint8_t> representatives,
                  const ContactOptions& options)
        : scene_(scene),
          swept_bvh_(swept_bvh),
          leaf_slabs_(leaf_slabs),
          normal_cones_(normal_cones),
          representatives_(representatives),
          options_(options) {}

    bool accepts(std::uint32_t mesh_a, std::uint32_t mesh_b) const {
        return options_.accepts(mesh_a, mesh_b);
    }
    bool is_contact_free(std::uint32_t node) const {
        return normal_cones_ != nullptr && normal_cones_->is_contact_free(scene_, swept_bvh_, node);
    }
    bool disjoint_leaves(std::uint32_t a, std::uint32_t b) const {
        return leaf_slabs_.disjoint(a, b);
    }
    void test(std::uint32_t slot_a, std::uint32_t slot_b);

    /// Elements are not tested if they cannot be in contact by that time within the step.
    /// Contacts up to it are found all the same.
    void set_time_bound(double toi) noexcept { time_bound_ = toi; }

    /// The contacts found, in any order; pairs of elements that were tested twice occur twice.
    std::vector<Contact>& contacts() noexcept { return contacts_; }
    const WorldStatistics& statistics() const noexcept { return statistics_; }

private:
    bool is_late(std::uint32_t a,
                 std::uint32_t b,
                 const MovingElement& element_a,
                 const MovingElement& element_b) const;
    bool are_late(const std::array<geometry::VertexId, 4>& vertices,
                  std::size_t size,
                  std::uint32_t a,
                  std::uint32_t b) const;
    void test_elements(std::uint32_t a, std::uint32_t b);
    void test_corners(std::uint32_t of, std::uint32_t face);
    void test_edges(std::uint32_t a, unsigned i, std::uint32_t b, unsigned k);

    // Times of impact of features of two triangles, on chords or screws.
    std::optional<double> vertex_face_time(const std::array<geometry::VertexId, 4>& vertices,
                                           std::uint32_t of,
                                           std::uint32_t face) const;
    std::optional<double> edge_edge_time(const std::array<geometry::VertexId, 4>& vertices,
                                         std::uint32_t a,
                                         std::uint32_t b) const;

    std::uint32_t mesh_of(std::uint32_t triangle) const noexcept {
        return scene_.mesh_of_triangle[triangle];
    }
    MinSeparationOptions separation() const {
        return {.min_separation = options_.min_separation, .tolerance = options_.tolerance};
    }

    const MovingScene& scene_;
    const SweptBvh& swept_bvh_;
    const LeafSlabs& leaf_slabs_;
    const NormalCones* normal_cones_;
    std::span<const std::uint8_t> representatives_;
    const ContactOptions& options_;
    std::vector<Contact> contacts_;
    WorldStatistics statistics_;
    double time_bound_ = 1.0;
};

}  // namespace earshot::collision
