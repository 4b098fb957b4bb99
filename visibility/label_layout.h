// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/floating_point.h"

#include <glm/vec2.hpp>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

namespace earshot::visibility {

// External labels of the objects in a picture (Cmolik and Bittner 2010): every visible object gets
// an anchor in its area, a leader line to the boundary of a convex interior area around the
// drawing, and a label box outside of it. Coordinates are in pixels, x to the right, y down; the
// middle of the first pixel is (0.5, 0.5).

/// A pixel of the background, outside of the drawing.
inline constexpr std::uint32_t kBackground = std::numeric_limits<std::uint32_t>::max();
/// A pixel of the drawing that belongs to no labelled object.
inline constexpr std::uint32_t kUnlabelled = kBackground - 1;

/// Which object is visible in each pixel, row by row.
struct IdImage {
    std::size_t width = 0, height = 0;
    std::vector<std::uint32_t> objects;  ///< an index below the number of objects, or as above
};

/// What gets a label.
struct LabelledObject {
    /// A fixed anchor, for a point that is marked in the picture. Without one the anchor floats in
    /// the object's area of the id image, and an object without a pixel gets no label.
    std::optional<glm::dvec2> anchor{};
};

/// The sides of the drawing that labels stand at; leader lines are horizontal where there is room.
enum class LabelSides { left, right, both };

/// Exponents of the membership functions, from 0 (ignore the criterion) to 1.
struct LabelWeights {
    double leader_length = 0.2;
    double anchor_salience = 1.0;  ///< distance from the outline of the area
    double anchor_distance = 1.0;  ///< between anchors
    double end_distance = 1.0;     ///< between ends of leader lines
    double line_clearance = 1.0;   ///< between leader lines and the fixed anchors of others
    double anchor_coherence = 0.7;
    double end_coherence = 0.7;
};

struct LabelOptions {
    LabelSides sides = LabelSides::both;
    double box_height = 16.0;  ///< of every label box, and between the middles of two, above 0
    double margin = 8.0;  ///< from the drawing to the boundary of the interior area, at least 0
    /// Anchors are wanted to be apart by this fraction of the diagonal of the interior area.
    double min_anchor_distance = 0.05;
    LabelWeights weights{};
};

struct Label {
    glm::dvec2 anchor{0.0};
    glm::dvec2 end{0.0};  ///< of the horizontal leader line, on the boundary of the interior area
    /// Where the leader line leaves the interior area: `end`, unless the box had to move.
    glm::dvec2 exit{0.0};
    /// Where the leader line, horizontal from `exit` on, meets the box: the middle of its side.
    glm::dvec2 box{0.0};
    bool is_left = false;  ///< the box is to the left of `box`, else to its right
};

struct LabelLayout {
    std::vector<std::optional<Label>> labels;  ///< one per object
};

/// Places the labels. Leader lines do not cross, and boxes of `box_height` overlap neither each
/// other nor the interior area, whatever their width; a stack of boxes may be higher than the
/// image. With the layout of the `previous` picture of a sequence, of the same objects, labels stay
/// near where they were. Ties go to the left side, the first pixel and the first object; the result
/// depends on the arguments alone. O(pixels x objects).
LabelLayout place_labels(const IdImage& image,
                         std::span<const LabelledObject> objects,
                         const LabelOptions& options = {},
                         const LabelLayout* previous = nullptr);

}  // namespace earshot::visibility
