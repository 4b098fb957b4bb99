// SPDX-License-Identifier: MIT
#include "earshot/io/internal/gltf_accessor.h"
#include "earshot/io/internal/gltf_scene.h"

#include <cmath>

namespace earshot::io {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kMaxInstances = std::size_t{1} << 20U;  // of all nodes

/// The attributes that place instances; empty where not given.
struct InstanceAttributes {
    std::vector<double> translations;  // three per instance
    std::vector<double> rotations;     // four, x y z w
    std::vector<double> scales;        // three
    std::size_t count = 0;
};

class AttributeReader {
public:
    AttributeReader(const GltfFile& file, const Json& attributes, std::string element)
        : file_(file), attributes_(attributes), element_(std::move(element)) {}

    InstanceAttributes read() {
        InstanceAttributes read;
        read.translations = numbers("TRANSLATION", 3);
        read.rotations = numbers("ROTATION", 4);
        read.scales = numbers("SCALE", 3);
        if (!count_) {
            file_.fail(element_, "its instances have no TRANSLATION, ROTATION or SCALE");
        }
        read.count = *count_;
        return read;
    }

private:
    std::vector<double> numbers(const char* name, std::size_t components) {
        if (!attributes_.contains(name)) {
            return {};
        }
        const std::size_t accessor = file_.whole_number(attributes_, name, element_);
        if (accessor >= file_.model.accessors.size()) {
            file_.fail(element_,
                       std::string(name) + ": index " + std::to_string(accessor) +
                           " is not below " + std::to_string(file_.model.accessors.size()) +
                           ", the number of accessors");
        }
        check_count(file_.model.accessors[accessor].count);
        return accessor_numbers(file_, static_cast<int>(accessor), components);
    }

    void check_count(std::size_t count) {
        if (count > kMaxInstances) {
            file_.fail(element_,
                       "it has " + std::to_string(count) + " instances, more than 2^20",
                       "split the scene");
        }
        if (count_ && *count_ != count) {
            file_.fail(element_, "the attributes of its instances differ in number");
        }
        count_ = count;
    }

    const GltfFile& file_;
    const Json& attributes_;
    std::string element_;
    std::optional<std::size_t> count_;
};

geometry::Transform transform_of(const GltfFile& file,
                                 const InstanceAttributes& attributes,
                                 std::size_t i,
                                 const std::string& element) {
    geometry::Transform transform;
    if (!attributes.translations.empty()) {
        const double* t = &attributes.translations[3 * i];
        transform.translation = {t[0], t[1], t[2]};
    }
    if (!attributes.scales.empty()) {
        const double* s = &attributes.scales[3 * i];
        transform.scale = {s[0], s[1], s[2]};
    }
    if (!attributes.rotations.empty()) {
        const double* q = &attributes.rotations[4 * i];
        const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
        if (!(length > 0.0)) {
            file.fail(
                element,
                "the rotation of instance " + std::to_string(i) + " is not a unit quaternion");
        }
        transform.rotation = {q[3] / length, q[0] / length, q[1] / length, q[2] / length};
    }
    return transform;
}

}  // namespace

void read_instances(const GltfFile& file, GltfNodes& nodes, Warnings& warnings) {
    const std::size_t own_nodes = nodes.nodes.size();
    for (std::size_t i = 0; i < file.model.nodes.size(); ++i) {
        const std::string element = "node " + std::to_string(i);
        const Json* extension =
            file.extension(file.json["nodes"][i], kInstancingExtension, element);
        if (extension == nullptr || file.model.nodes[i].mesh < 0) {
            continue;
        }
        if (file.model.nodes[i].skin >= 0) {
            // A skin places the vertices by its joints alone.
            warnings.push_back({file.name, element + ": the instances of a skinned mesh coincide"});
            continue;
        }
        const auto attributes = extension->find("attributes");
        if (attributes == extension->end() || !attributes->is_object()) {
            file.fail(element, "the attributes of its instances are missing");
        }
        const InstanceAttributes read = AttributeReader(file, *attributes, element).read();
        if (read.count > kMaxInstances - (nodes.nodes.size() - own_nodes)) {
            file.fail(element, "with it the scene has more than 2^20 instances", "split the scene");
        }
        std::vector<int>& mesh_nodes = nodes.mesh_nodes[i];
        mesh_nodes.clear();
        for (std::size_t k = 0; k < read.count; ++k) {
            geometry::Node node;
            node.name = file.model.nodes[i].name;
            node.parent = nodes.index_of[i];
            node.rest = transform_of(file, read, k, element);
            mesh_nodes.push_back(static_cast<int>(nodes.nodes.size()));
            nodes.nodes.push_back(std::move(node));
        }
    }
}

}  // namespace earshot::io
