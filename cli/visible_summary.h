// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/bvh/update_statistics.h"
#include "earshot/cli/picture_choice.h"
#include "earshot/propagation/scene.h"
#include "earshot/visibility/visible_triangle_set.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace earshot::cli {

/// The summary of `earshot visible`: the triangles that are visible at any instant, and the
/// materials' shares of the sphere, averaged over instants.
class VisibleSummary {
public:
    /// Precondition: the scene outlives the summary.
    explicit VisibleSummary(const propagation::Scene& scene);

    void add_frame(const visibility::VisibleTriangles& visible);
    /// How the hierarchy followed the scene over all frames.
    void set_updates(const bvh::UpdateStatistics& updates) { updates_ = updates; }

    /// Where results were written; empty: not.
    struct Outputs {
        geometry::Vec3 point{};
        double seconds = 0.0;
        std::string file{};
        const PictureChoice& picture;
    };
    std::string json(const Outputs& outputs) const;
    std::string text(const Outputs& outputs) const;

private:
    /// A material's row.
    struct Row {
        std::size_t material = 0;
        std::size_t triangles = 0;
        double share = 0.0;
    };

    /// The rows of visible materials, the largest share first, equal ones by index.
    std::vector<Row> rows() const;
    std::size_t triangles_seen() const;
    double share(double solid_angle) const;

    const propagation::Scene& scene_;
    std::vector<bool> seen_;            // per triangle
    std::vector<double> solid_angles_;  // per material, of all instants
    double free_solid_angle_ = 0.0;
    std::uint64_t rays_ = 0;
    std::size_t instants_ = 0;
    bvh::UpdateStatistics updates_;
    bool is_complete_ = true;
};

}  // namespace earshot::cli
