// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/collision/broad_phase/internal/leaf_slabs.h"
#include "earshot/collision/broad_phase/internal/normal_cones.h"
#include "earshot/collision/broad_phase/internal/swept_bvh.h"
#include "earshot/collision/internal/moving_scene.h"
#include "earshot/collision/narrow_phase/min_separation.h"
#include "earshot/collision/world.h"

#include <cstdint>
#include <span>
#include <vector>

namespace earshot::collision {

/// Tests the elements of pairs of triangles against each other: the rules of a PartSearch.
class ElementTester {
public:
    /// `own`: see own_elements(). `patches`: none are left out if null. All must outlive it.
    ElementTester(const MovingScene& scene,
                  const SweptForest& forest,
                  const LeafPlates& plates,
                  const SmoothPatches* patches,
                  std::span<const std::uint8_t> own,
                  const ContactOptions& options)
        : scene_(scene),
          forest_(forest),
          plates_(plates),
          patches_(patches),
          own_(own),
          options_(options) {}

    bool accepts(std::uint32_t mesh_a, std::uint32_t mesh_b) const {
        return options_.accepts(mesh_a, mesh_b);
    }
    bool is_free_of_contact(std::uint32_t node) const {
        return patches_ != nullptr && patches_->is_free_of_contact(scene_, forest_, node);
    }
    bool are_leaves_apart(std::uint32_t a, std::uint32_t b) const {
        return plates_.are_apart(a, b);
    }
    void test(std::uint32_t slot_a, std::uint32_t slot_b);

    /// What was found, in any order; elements that were tested twice stand there twice.
    std::vector<Contact>& contacts() noexcept { return contacts_; }
    const WorldStatistics& statistics() const noexcept { return statistics_; }

private:
    void test_elements(std::uint32_t a, std::uint32_t b);
    void test_corners(std::uint32_t of, std::uint32_t face);
    void test_edges(std::uint32_t a, unsigned i, std::uint32_t b, unsigned k);

    std::uint32_t mesh_of(std::uint32_t triangle) const noexcept {
        return scene_.mesh_of_triangle[triangle];
    }
    MinSeparationOptions separation() const {
        return {.min_separation = options_.min_separation, .tolerance = options_.tolerance};
    }

    const MovingScene& scene_;
    const SweptForest& forest_;
    const LeafPlates& plates_;
    const SmoothPatches* patches_;
    std::span<const std::uint8_t> own_;
    const ContactOptions& options_;
    std::vector<Contact> contacts_;
    WorldStatistics statistics_;
};

}  // namespace earshot::collision
