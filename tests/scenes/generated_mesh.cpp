// SPDX-License-Identifier: MIT
#include "scenes/generated_mesh.h"

#include "earshot/scenes/indexed_mesh.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>
#include <utility>

namespace earshot::scenes {

geometry::Mesh mesh_of(const DraftNode& node, int tessellation) {
    std::size_t materials = 0;
    for (const Face& face : node.faces) {
        materials = std::max(materials, face.material + 1);
    }
    const IndexedMesh indexed = index_faces(node, materials, tessellation);
    geometry::Mesh mesh;
    for (const auto& [x, y, z] : indexed.positions) {
        mesh.positions.emplace_back(x, y, z);
    }
    for (const auto& list : indexed.triangles) {
        mesh.triangles.insert(mesh.triangles.end(), list.begin(), list.end());
    }
    return mesh;
}

geometry::Mesh mesh_of(const Faces& faces, int tessellation) {
    DraftNode node;
    node.faces = faces;
    return mesh_of(node, tessellation);
}

testing::AssertionResult is_closed(const geometry::Mesh& mesh) {
    std::map<std::pair<geometry::VertexId, geometry::VertexId>, int> uses;
    for (const geometry::Triangle& triangle : mesh.triangles) {
        for (std::size_t i = 0; i < 3; ++i) {
            ++uses[{triangle[i], triangle[(i + 1) % 3]}];
        }
    }
    for (const auto& [edge, count] : uses) {
        const auto opposite = uses.find({edge.second, edge.first});
        if (count != 1 || opposite == uses.end()) {
            const Vec3& a = mesh.positions[edge.first];
            const Vec3& b = mesh.positions[edge.second];
            return testing::AssertionFailure()
                   << "edge (" << a.x << ", " << a.y << ", " << a.z << ") to (" << b.x << ", "
                   << b.y << ", " << b.z << ") is used " << count << " times, its opposite "
                   << (opposite == uses.end() ? 0 : opposite->second);
        }
    }
    return mesh.triangles.empty() ? testing::AssertionFailure() << "no triangles"
                                  : testing::AssertionSuccess();
}

double signed_volume(const geometry::Mesh& mesh) {
    double volume = 0.0;
    for (const auto& [a, b, c] : mesh.triangles) {
        volume +=
            glm::dot(mesh.positions[a], glm::cross(mesh.positions[b], mesh.positions[c])) / 6.0;
    }
    return volume;
}

double winding_number(const geometry::Mesh& mesh, const Vec3& point) {
    double angle = 0.0;
    for (const geometry::Triangle& triangle : mesh.triangles) {
        const Vec3 a = mesh.positions[triangle[0]] - point;
        const Vec3 b = mesh.positions[triangle[1]] - point;
        const Vec3 c = mesh.positions[triangle[2]] - point;
        const double la = glm::length(a);
        const double lb = glm::length(b);
        const double lc = glm::length(c);
        const double denominator =
            la * lb * lc + glm::dot(a, b) * lc + glm::dot(b, c) * la + glm::dot(c, a) * lb;
        angle += 2.0 * std::atan2(glm::dot(a, glm::cross(b, c)), denominator);
    }
    return angle / (4.0 * std::acos(-1.0));
}

const DraftNode& node_named(const SceneDraft& draft, const std::string& name) {
    for (const DraftNode& node : draft.nodes) {
        if (node.name == name) {
            return node;
        }
    }
    throw std::out_of_range(name);
}

}  // namespace earshot::scenes
