// SPDX-License-Identifier: MIT
#include "earshot/io/internal/gltf_primitive.h"

#include "earshot/io/internal/gltf_accessor.h"

#include <numeric>

namespace earshot::io {
namespace {

using geometry::Triangle;
using geometry::Vec3;
using geometry::VertexId;

std::vector<VertexId> vertex_order(const GltfFile& file,
                                   const tinygltf::Primitive& primitive,
                                   std::size_t vertex_count) {
    if (primitive.indices >= 0) {
        return accessor_indices(file, primitive.indices, 1, vertex_count, "vertices");
    }
    std::vector<VertexId> order(vertex_count);
    std::iota(order.begin(), order.end(), VertexId{0});
    return order;
}

/// glTF 2.0 section 3.7.2.1, which keeps the winding of every triangle of a strip.
std::vector<Triangle> assemble(const GltfFile& file,
                               const std::string& element,
                               int mode,
                               const std::vector<VertexId>& v,
                               Warnings& warnings) {
    std::vector<Triangle> triangles;
    if (mode == TINYGLTF_MODE_TRIANGLES) {
        if (v.size() % 3 != 0) {
            warnings.push_back({file.name,
                                element + ": " + std::to_string(v.size()) +
                                    " indices are not whole triangles; the last " +
                                    std::to_string(v.size() % 3) + " are left out"});
        }
        for (std::size_t i = 0; i + 2 < v.size(); i += 3) {
            triangles.push_back({v[i], v[i + 1], v[i + 2]});
        }
        return triangles;
    }
    for (std::size_t i = 0; i + 2 < v.size(); ++i) {
        if (mode == TINYGLTF_MODE_TRIANGLE_STRIP) {
            triangles.push_back({v[i], v[i + 1 + i % 2], v[i + 2 - i % 2]});
        } else {
            triangles.push_back({v[i + 1], v[i + 2], v[0]});
        }
    }
    return triangles;
}

std::vector<geometry::MorphTarget> read_targets(const GltfFile& file,
                                                const tinygltf::Primitive& primitive,
                                                const std::string& element,
                                                const std::vector<bool>& is_used) {
    const std::size_t vertex_count = is_used.size();
    std::vector<geometry::MorphTarget> targets;
    // Those without displacements too.
    file.spend(element, GltfCost::numbers, primitive.targets.size(), 3 * vertex_count);
    for (std::size_t i = 0; i < primitive.targets.size(); ++i) {
        geometry::MorphTarget target;
        const auto found = primitive.targets[i].find("POSITION");
        if (found == primitive.targets[i].end()) {
            target.displacement.assign(vertex_count, Vec3(0.0));
        } else {
            target.displacement = accessor_points(file, found->second);
        }
        if (target.displacement.size() != vertex_count) {
            file.fail(element,
                      "target " + std::to_string(i) + " has " +
                          std::to_string(target.displacement.size()) + " displacements for " +
                          std::to_string(vertex_count) + " vertices");
        }
        if (found != primitive.targets[i].end()) {
            check_used_points(file, found->second, target.displacement, is_used);
        }
        targets.push_back(std::move(target));
    }
    return targets;
}

/// Moves the elements of the used vertices to the front, `width` per vertex.
template <typename T>
void keep_used(const std::vector<bool>& is_used, std::size_t width, std::vector<T>& elements) {
    std::size_t kept = 0;
    for (std::size_t vertex = 0; vertex < is_used.size(); ++vertex) {
        for (std::size_t i = 0; is_used[vertex] && i < width; ++i) {
            elements[kept++] = elements[vertex * width + i];
        }
    }
    elements.resize(kept);
}

std::vector<bool> used_vertices(const std::vector<Triangle>& triangles, std::size_t vertex_count) {
    std::vector<bool> is_used(vertex_count, false);
    for (const Triangle& triangle : triangles) {
        for (const VertexId vertex : triangle) {
            is_used[vertex] = true;
        }
    }
    return is_used;
}

/// Primitives often share one large vertex buffer; each keeps what it uses.
void drop_unused_vertices(const std::vector<bool>& is_used, GltfPrimitive& primitive) {
    geometry::Part& part = primitive.part;
    std::vector<VertexId> renumbered(is_used.size());
    VertexId next = 0;
    for (std::size_t i = 0; i < is_used.size(); ++i) {
        renumbered[i] = next;
        next += is_used[i] ? 1 : 0;
    }
    for (Triangle& triangle : primitive.triangles) {
        for (VertexId& vertex : triangle) {
            vertex = renumbered[vertex];
        }
    }
    keep_used(is_used, 1, part.positions);
    for (geometry::MorphTarget& target : part.targets) {
        keep_used(is_used, 1, target.displacement);
    }
    if (part.influences_per_vertex > 0) {
        keep_used(is_used, part.influences_per_vertex, part.influences);
    }
}

}  // namespace

std::optional<GltfPrimitive> read_primitive(const GltfFile& file,
                                            const tinygltf::Primitive& primitive,
                                            const std::string& element,
                                            std::size_t joint_count,
                                            Warnings& warnings) {
    if (primitive.mode < TINYGLTF_MODE_TRIANGLES) {
        warnings.push_back({file.name, element + ": points and lines are left out"});
        return std::nullopt;
    }
    if (primitive.mode > TINYGLTF_MODE_TRIANGLE_FAN) {
        file.fail(element, "mode " + std::to_string(primitive.mode) + " is not one of glTF's");
    }
    const auto position = primitive.attributes.find("POSITION");
    if (position == primitive.attributes.end()) {
        warnings.push_back({file.name, element + ": it has no POSITION and is left out"});
        return std::nullopt;
    }
    GltfPrimitive read;
    read.material = primitive.material;
    read.element = element;
    read.part.positions = accessor_points(file, position->second);
    const std::size_t vertex_count = read.part.positions.size();
    read.triangles = assemble(
        file, element, primitive.mode, vertex_order(file, primitive, vertex_count), warnings);
    const std::vector<bool> is_used = used_vertices(read.triangles, vertex_count);
    check_used_points(file, position->second, read.part.positions, is_used);
    read.part.targets = read_targets(file, primitive, element, is_used);
    read.part.rest_weights.assign(read.part.targets.size(), 0.0);
    if (joint_count > 0) {
        read_influences(file, primitive, element, joint_count, read.part, warnings);
    }
    drop_unused_vertices(is_used, read);
    return read;
}

}  // namespace earshot::io
