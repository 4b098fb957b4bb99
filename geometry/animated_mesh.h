// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/mesh.h"

#include <glm/gtc/quaternion.hpp>
#include <glm/mat4x4.hpp>

#include <cstddef>
#include <string>
#include <vector>

namespace earshot::geometry {

/// Translation, rotation, scale of a node relative to its parent, as in glTF 2.0 section 3.5.3.
struct Transform {
    Vec3 translation{0.0};
    glm::dquat rotation{1.0, 0.0, 0.0, 0.0};  ///< w, x, y, z; unit length
    Vec3 scale{1.0};
};

enum class Interpolation { step, linear, cubic_spline };

/// Key frames of one property (glTF 2.0 section 3.11). `values` holds `width` numbers per key, or
/// three times as many for cubic_spline (in-tangent, value, out-tangent). No keys: not animated.
struct Track {
    Interpolation interpolation = Interpolation::linear;
    std::vector<double> times;  ///< seconds, strictly ascending
    std::vector<double> values;

    /// The value at `t`, held before the first and after the last key. Rotations (x, y, z, w) are
    /// interpolated along the shorter great arc and normalised.
    void sample(double t, std::span<double> out, bool is_rotation) const;
};

/// A node of the scene graph. A parent always stands before its children.
struct Node {
    std::string name;
    int parent = -1;  ///< index of a node before this one; -1: a root
    Transform rest;
    Track translation, rotation, scale;  ///< replace the part of `rest` they animate
};

/// Influence of one joint on one vertex.
struct JointWeight {
    std::uint32_t joint = 0;  ///< index into Skin::joints
    double weight = 0.0;
};

/// Joints that deform a part. inverse_bind[i] belongs to joints[i].
struct Skin {
    std::vector<int> joints;  ///< node indices
    std::vector<glm::dmat4> inverse_bind;
};

/// One displacement per vertex of the part, scaled by an animated weight.
struct MorphTarget {
    std::vector<Vec3> displacement;
};

/// A run of vertices that move with one node: rigidly, by a skin, by morph targets, or both.
struct Part {
    int node = -1;                ///< -1: positions are world positions and never move
    std::vector<Vec3> positions;  ///< in the node's space (in the bind pose where `skin` >= 0)
    int skin = -1;                ///< index into the skins; -1: rigid
    std::vector<std::array<JointWeight, 4>>
        influences;  ///< per vertex where skinned; weights sum to 1
    std::vector<MorphTarget> targets;
    std::vector<double> rest_weights;  ///< one per target
    Track weights;                     ///< one value per target per key
};

/// The moving geometry of a scene. Positions depend on `t` alone, so frames can be evaluated in
/// any order and on any thread. Vertices are numbered part after part.
class AnimatedMesh {
public:
    AnimatedMesh() = default;

    /// Throws Error if a node, skin, joint or vertex index is out of range, a parent does not stand
    /// before its child, a number is not finite, or array sizes do not fit together.
    AnimatedMesh(std::vector<Node> nodes,
                 std::vector<Skin> skins,
                 std::vector<Part> parts,
                 std::vector<Triangle> triangles);

    /// A mesh that never moves.
    static AnimatedMesh fixed(Mesh mesh);

    std::size_t vertex_count() const noexcept { return vertex_count_; }
    const std::vector<Triangle>& triangles() const noexcept { return triangles_; }
    const std::vector<Node>& nodes() const noexcept { return nodes_; }

    double duration() const noexcept {
        return duration_;
    }  ///< seconds, the last key; 0: nothing moves

    /// World positions at time `t` (seconds, clamped to [0, duration]).
    /// Precondition: out.size() == vertex_count().
    void positions_at(double t, std::span<Vec3> out) const;
    std::vector<Vec3> positions_at(double t) const;

    /// World transform of a node at time `t`.
    glm::dmat4 node_transform(int node, double t) const;

private:
    std::vector<Node> nodes_;
    std::vector<Skin> skins_;
    std::vector<Part> parts_;
    std::vector<Triangle> triangles_;
    std::size_t vertex_count_ = 0;
    double duration_ = 0.0;
};

}  // namespace earshot::geometry
