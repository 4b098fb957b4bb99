// SPDX-License-Identifier: MIT
#include "earshot/io/internal/gltf_accessor.h"
#include "earshot/io/internal/gltf_primitive.h"

namespace earshot::io {
namespace {

constexpr std::size_t kPerSet = 4;  // joints of a vertex in one JOINTS_n attribute

/// One set of four influences per vertex, appended to those of earlier sets later.
struct InfluenceSet {
    std::vector<std::uint32_t> joints;
    std::vector<double> weights;
};

InfluenceSet read_set(const GltfFile& file,
                      const std::string& element,
                      int joints,
                      int weights,
                      std::size_t vertex_count) {
    constexpr std::size_t kAnyJoint = std::size_t{1} << 32U;  // bounded where a weight counts
    InfluenceSet set;
    set.joints = accessor_indices(file, joints, kPerSet, kAnyJoint, "joints");
    set.weights = accessor_numbers(file, weights, kPerSet);
    if (set.joints.size() != vertex_count * kPerSet || set.weights.size() != set.joints.size()) {
        file.fail(element, "the number of joints or weights is not the number of vertices");
    }
    return set;
}

std::vector<InfluenceSet> read_sets(const GltfFile& file,
                                    const tinygltf::Primitive& primitive,
                                    const std::string& element,
                                    std::size_t vertex_count) {
    std::vector<InfluenceSet> sets;
    while (true) {
        const std::string number = std::to_string(sets.size());
        const auto joints = primitive.attributes.find("JOINTS_" + number);
        const auto weights = primitive.attributes.find("WEIGHTS_" + number);
        const bool has_joints = joints != primitive.attributes.end();
        if (has_joints != (weights != primitive.attributes.end())) {
            file.fail(element, "JOINTS and WEIGHTS of set " + number + " do not go together");
        }
        if (!has_joints) {
            break;
        }
        sets.push_back(read_set(file, element, joints->second, weights->second, vertex_count));
    }
    if (sets.empty()) {
        file.fail(element, "its node has a skin, but it has no JOINTS_0");
    }
    return sets;
}

/// Scales the weights of one vertex to sum 1; false if they are all 0.
bool normalise(std::span<geometry::JointWeight> influences) {
    double sum = 0.0;
    for (const geometry::JointWeight& influence : influences) {
        sum += influence.weight;
    }
    if (!(sum > 0.0)) {
        influences.front().weight = 1.0;
        return false;
    }
    for (geometry::JointWeight& influence : influences) {
        influence.weight /= sum;
    }
    return true;
}

}  // namespace

void read_influences(const GltfFile& file,
                     const tinygltf::Primitive& primitive,
                     const std::string& element,
                     std::size_t joint_count,
                     geometry::Part& part,
                     Warnings& warnings) {
    const std::size_t vertex_count = part.positions.size();
    const std::vector<InfluenceSet> sets = read_sets(file, primitive, element, vertex_count);
    part.influences_per_vertex = sets.size() * kPerSet;
    part.influences.resize(vertex_count * part.influences_per_vertex);
    std::size_t unweighted = 0;
    for (std::size_t vertex = 0; vertex < vertex_count; ++vertex) {
        const std::span<geometry::JointWeight> of_vertex =
            std::span(part.influences)
                .subspan(vertex * part.influences_per_vertex, part.influences_per_vertex);
        for (std::size_t i = 0; i < of_vertex.size(); ++i) {
            const InfluenceSet& set = sets[i / kPerSet];
            const std::size_t at = vertex * kPerSet + i % kPerSet;
            const bool counts = set.weights[at] != 0.0;
            if (set.weights[at] < 0.0 || (counts && set.joints[at] >= joint_count)) {
                file.fail(element,
                          "vertex " + std::to_string(vertex) +
                              " has a negative weight or a joint index that is not below " +
                              std::to_string(joint_count));
            }
            of_vertex[i] = {counts ? set.joints[at] : 0, set.weights[at]};
        }
        unweighted += normalise(of_vertex) ? 0 : 1;
    }
    if (unweighted > 0) {
        warnings.push_back({file.name,
                            element + ": " + std::to_string(unweighted) +
                                " vertices have no joint weight and follow the first joint"});
    }
}

}  // namespace earshot::io
