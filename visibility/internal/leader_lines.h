// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/visibility/internal/label_interior.h"
#include "earshot/visibility/label_layout.h"

#include <glm/vec2.hpp>

#include <optional>
#include <span>
#include <vector>

namespace earshot::visibility {

/// A leader line that an object may get.
struct LeaderLine {
    glm::dvec2 anchor{0.0}, end{0.0};
    /// Distance of the anchor from the outline of the area, pixels; of a fixed anchor 1.
    double salience = 1.0;
    double feasibility = 1.0;
    bool is_left = false;
};

/// Anchors and horizontal leader lines by greedy optimisation (Cmolik and Bittner 2010, section
/// 6.1): one for each object that has a pixel or a fixed anchor. Arguments as of place_labels().
std::vector<std::optional<LeaderLine>> place_leader_lines(const IdImage& image,
                                                          std::span<const LabelledObject> objects,
                                                          const LabelOptions& options,
                                                          const LabelInterior& interior,
                                                          const LabelLayout* previous);

}  // namespace earshot::visibility
