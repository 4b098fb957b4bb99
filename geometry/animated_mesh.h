// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/mesh.h"
#include "earshot/geometry/track.h"

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace earshot::geometry {

/// A node of the scene graph. A parent always stands before its children.
struct Node {
    std::string name;
    int parent = -1;  ///< index of a node before this one; -1: a root
    Transform rest;
    std::optional<glm::dmat4> matrix;    ///< affine; instead of `rest`, where no track moves it
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
    int skin = -1;  ///< index into the skins, whose joints replace the node; -1: rigid
    std::size_t influences_per_vertex = 0;  ///< joints per vertex where skinned, any number
    std::vector<JointWeight> influences;    ///< vertex after vertex; weights of one sum to 1
    std::vector<MorphTarget> targets;       ///< applied before the skin or the node
    std::vector<double> rest_weights;       ///< one per target
    Track weights;                          ///< one value per target per key
};

/// The moving geometry of a scene. Positions depend on `t` alone, so frames can be evaluated in
/// any order and on any thread. Vertices are numbered part after part.
class AnimatedMesh {
public:
    AnimatedMesh() = default;

    /// `triangles` are counter-clockwise seen from their front in the space of their part. Those
    /// that are mirrored at time 0 (negative determinant of the node's world transform, or of the
    /// first vertex's blended joints) are stored reversed, so that every triangle is
    /// counter-clockwise in the world (glTF 2.0 section 3.7.4).
    ///
    /// Throws Error if a node, skin, joint or vertex index is out of range, a parent does not stand
    /// before its child, a number is not finite, or array sizes do not fit together.
    AnimatedMesh(std::vector<Node> nodes,
                 std::vector<Skin> skins,
                 std::vector<Part> parts,
                 std::vector<Triangle> triangles);

    /// A mesh that never moves.
    static AnimatedMesh fixed(Mesh mesh);

    /// Says which triangles belong to one mesh, and the meshes' names. Without it the parts of one
    /// node are a mesh, named like the node, and a part without a node is one. Throws Error if the
    /// sizes do not fit, a number is out of range, or a vertex is in triangles of two meshes.
    void set_meshes(std::vector<std::string> names, std::vector<std::uint32_t> mesh_of_triangle);

    /// The meshes' names, which may be empty and need not differ.
    const std::vector<std::string>& mesh_names() const noexcept { return mesh_names_; }
    const std::vector<std::uint32_t>& mesh_of_triangle() const noexcept {
        return mesh_of_triangle_;
    }
    /// A vertex in no triangle belongs to the mesh of the vertex before it in its part.
    const std::vector<std::uint32_t>& mesh_of_vertex() const noexcept { return mesh_of_vertex_; }

    std::size_t vertex_count() const noexcept { return vertex_count_; }
    const std::vector<Part>& parts() const noexcept { return parts_; }
    const std::vector<Triangle>& triangles() const noexcept { return triangles_; }
    const std::vector<Node>& nodes() const noexcept { return nodes_; }

    /// Seconds, the last key of any track; 0: nothing moves.
    double duration() const noexcept { return duration_; }

    /// World positions at time `t` (seconds, clamped to [0, duration]).
    /// Precondition: out.size() == vertex_count().
    void positions_at(double t, std::span<Vec3> out) const;
    std::vector<Vec3> positions_at(double t) const;

    /// World transform of a node at time `t` (clamped likewise).
    glm::dmat4 node_transform(int node, double t) const;

private:
    std::vector<glm::dmat4> node_transforms(double t) const;
    void validate() const;
    void flip_mirrored_winding();
    void set_meshes_of_nodes();

    std::vector<Node> nodes_;
    std::vector<Skin> skins_;
    std::vector<Part> parts_;
    std::vector<Triangle> triangles_;
    std::vector<std::string> mesh_names_;
    std::vector<std::uint32_t> mesh_of_triangle_, mesh_of_vertex_;
    std::size_t vertex_count_ = 0;
    double duration_ = 0.0;
};

}  // namespace earshot::geometry
