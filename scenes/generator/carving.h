// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/scenes/scene_draft.h"

#include <array>
#include <cstdint>
#include <vector>

namespace earshot::scenes {

/// Edges along the axes between two opposite corners, metres.
struct Box {
    Vec3 low{0.0};
    Vec3 high{0.0};
};

/// Which way a surface looks, from the solid into the air.
enum class Facing { any, left, right, down, up, back, front };  // -x +x -y +y -z +z

/// A room as air carved out of endless rock, box by box. Its surface is closed, free of
/// T-junctions, and made of as few corners as that allows; its faces look into the air. Lengths are
/// rounded to 0.1 mm, so that boxes which should touch do.
class Carving {
public:
    /// Everything is rock; surfaces get `material` unless painted.
    explicit Carving(std::size_t material) : material_(material) {}

    void carve(const Box& air) { steps_.push_back({air, true}); }
    void fill(const Box& rock) { steps_.push_back({rock, false}); }

    /// Gives a material to the surfaces inside a region (its border included) that look the given
    /// way. Later paint covers earlier paint. Paint that ends within a surface divides it.
    void paint(const Box& region, std::size_t material, Facing facing = Facing::any) {
        paints_.push_back({region, material, facing});
    }

    /// Divides all surfaces along a plane, as paint of two colours would.
    void divide(int axis, double at) { divisions_.push_back({axis, at}); }

    Faces surface() const;

private:
    struct Step {
        Box box;
        bool air = true;
    };
    struct Paint {
        Box region;
        std::size_t material = 0;
        Facing facing = Facing::any;
    };
    struct Division {
        int axis = 0;
        double at = 0.0;
    };

    std::size_t material_ = 0;
    std::vector<Step> steps_;
    std::vector<Paint> paints_;
    std::vector<Division> divisions_;

    friend class CarvedSurface;
};

}  // namespace earshot::scenes
