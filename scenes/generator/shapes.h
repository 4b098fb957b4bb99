// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/scenes/scene_draft.h"

#include <vector>

namespace earshot::scenes {

/// A corner of a profile, metres.
struct Vec2 {
    double u = 0.0;
    double v = 0.0;
};

/// A right-handed frame: u x v points along w.
struct Frame {
    Vec3 origin{0.0};
    Vec3 u{1.0, 0.0, 0.0};
    Vec3 v{0.0, 1.0, 0.0};
    Vec3 w{0.0, 0.0, 1.0};
};

/// A closed prism: `profile` (counter-clockwise in u and v) swept by `length` along w. Its faces
/// look outwards.
Faces prism(const std::vector<Vec2>& profile,
            double length,
            const Frame& frame,
            std::size_t material);

/// A closed box between two opposite corners; its faces look outwards.
Faces box(const Vec3& low, const Vec3& high, std::size_t material);

void append(Faces& faces, const Faces& more);

}  // namespace earshot::scenes
