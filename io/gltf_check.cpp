// SPDX-License-Identifier: MIT
#include "earshot/base/error.h"
#include "earshot/io/internal/gltf_file.h"

#include <cstdint>

namespace earshot::io {
namespace {

using Json = nlohmann::json;

/// A JSON object with the words that name it in an error.
class Element {
public:
    Element(const GltfFile& file, const Json& value, std::string name)
        : file_(file), value_(value), name_(std::move(name)) {
        if (!value.is_object()) {
            fail("it is not a JSON object");
        }
    }

    [[noreturn]] void fail(const std::string& what) const { file_.fail(name_, what); }

    bool has(const char* key) const { return value_.contains(key); }
    const Json& value(const char* key) const { return value_.at(key); }
    const std::string& name() const { return name_; }

    void need(const char* key) const {
        if (!has(key)) {
            fail(std::string(key) + " is missing");
        }
    }

    /// An index into one of the file's arrays, if given.
    void index(const char* key, const char* array) const {
        if (has(key)) {
            check_index(value(key), key, array);
        }
    }

    void indices(const char* key, const char* array) const {
        for (const Json& item : items(key)) {
            check_index(item, key, array);
        }
    }

    /// Every value of an object, as in the attributes of a primitive.
    void index_table(const char* key, const char* array) const {
        const Element table(file_, value(key), name_ + " " + key);
        for (const auto& [name, item] : value(key).items()) {
            table.check_index(item, condensed(name), array);
        }
    }

    void count(const char* key) const {
        if (has(key) && !value(key).is_number_unsigned()) {
            fail(std::string(key) + " is not a whole number from 0 up");
        }
    }

    void numbers(const char* key, std::size_t how_many) const {
        if (has(key) && items(key).size() != how_many) {
            fail(std::string(key) + " does not hold " + std::to_string(how_many) + " numbers");
        }
        for (const Json& item : items(key)) {
            if (!item.is_number()) {
                fail(std::string(key) + " contains other values than numbers");
            }
        }
    }

    void text(const char* key) const {
        if (has(key) && !value(key).is_string()) {
            fail(std::string(key) + " is not a text");
        }
    }

    /// The items of an array; none if it is not given.
    const Json& items(const char* key) const {
        static const Json none = Json::array();
        if (has(key) && !value(key).is_array()) {
            fail(std::string(key) + " is not an array");
        }
        return has(key) ? value(key) : none;
    }

    Element child(const char* key, const std::string& name) const {
        need(key);
        return {file_, value(key), prefix() + name};
    }

    template <typename Check>
    void each(const char* key, const char* singular, Check check) const {
        std::size_t i = 0;
        for (const Json& item : items(key)) {
            check(Element(file_, item, prefix() + singular + " " + std::to_string(i)));
            ++i;
        }
    }

private:
    std::string prefix() const { return name_.empty() ? "" : name_ + " "; }

    void check_index(const Json& index, const std::string& key, const char* array) const {
        const auto found = file_.json.find(array);
        const std::size_t size = found == file_.json.end() ? 0 : found->size();
        if (!index.is_number_unsigned()) {
            fail(key + " is not an index");
        }
        const auto number = index.get<std::uint64_t>();
        if (number >= size) {
            fail(key + ": index " + std::to_string(number) + " is not below " +
                 std::to_string(size) + ", the number of " + array);
        }
    }

    const GltfFile& file_;
    const Json& value_;
    std::string name_;
};

void check_asset(const GltfFile& file, const Element& root) {
    const Element asset = root.child("asset", "asset");
    asset.need("version");
    asset.text("version");
    const auto version = asset.value("version").get<std::string>();
    if (!version.starts_with("2.")) {
        throw Error(file.name,
                    "is glTF version " + condensed(version) + ", not 2",
                    "export it as glTF 2.0");
    }
}

void check_sparse(const Element& accessor) {
    if (!accessor.has("sparse")) {
        return;
    }
    const Element sparse = accessor.child("sparse", "sparse");
    sparse.need("count");
    sparse.count("count");
    const Element indices = sparse.child("indices", "indices");
    const Element values = sparse.child("values", "values");
    indices.need("componentType");
    indices.count("componentType");
    for (const Element& part : {indices, values}) {
        part.need("bufferView");
        part.index("bufferView", "bufferViews");
        part.count("byteOffset");
    }
}

void check_accessor(const Element& accessor) {
    for (const char* key : {"componentType", "count", "type"}) {
        accessor.need(key);
    }
    accessor.index("bufferView", "bufferViews");
    for (const char* key : {"componentType", "count", "byteOffset"}) {
        accessor.count(key);
    }
    accessor.text("type");
    check_sparse(accessor);
}

void check_view(const Element& view) {
    view.need("buffer");
    view.need("byteLength");
    view.index("buffer", "buffers");
    for (const char* key : {"byteLength", "byteOffset", "byteStride"}) {
        view.count(key);
    }
}

void check_mesh(const Element& mesh) {
    mesh.numbers("weights", mesh.items("weights").size());
    mesh.each("primitives", "primitive", [](const Element& primitive) {
        primitive.need("attributes");
        primitive.index_table("attributes", "accessors");
        primitive.index("indices", "accessors");
        primitive.index("material", "materials");
        primitive.count("mode");
        for (std::size_t i = 0; i < primitive.items("targets").size(); ++i) {
            if (!primitive.value("targets")[i].is_object()) {
                primitive.fail("target " + std::to_string(i) + " is not a JSON object");
            }
        }
        primitive.each("targets", "target", [](const Element& target) {
            target.index("POSITION", "accessors");
        });
    });
}

void check_node(const Element& node) {
    node.indices("children", "nodes");
    node.index("mesh", "meshes");
    node.index("skin", "skins");
    node.numbers("matrix", 16);
    node.numbers("translation", 3);
    node.numbers("rotation", 4);
    node.numbers("scale", 3);
    node.numbers("weights", node.items("weights").size());
    node.text("name");
}

void check_skin(const Element& skin) {
    skin.indices("joints", "nodes");
    skin.index("inverseBindMatrices", "accessors");
    if (skin.items("joints").empty()) {
        skin.fail("it has no joints");
    }
}

void check_animation(const Element& animation) {
    animation.text("name");
    animation.each("samplers", "sampler", [](const Element& sampler) {
        sampler.need("input");
        sampler.need("output");
        sampler.index("input", "accessors");
        sampler.index("output", "accessors");
        sampler.text("interpolation");
    });
    const std::size_t sampler_count = animation.items("samplers").size();
    animation.each("channels", "channel", [=](const Element& channel) {
        channel.need("sampler");
        channel.count("sampler");
        const auto sampler = channel.value("sampler").get<std::uint64_t>();
        if (sampler >= sampler_count) {
            channel.fail("sampler: index " + std::to_string(sampler) + " is not below " +
                         std::to_string(sampler_count));
        }
        const Element target = channel.child("target", "target");
        target.need("path");
        target.text("path");
        target.index("node", "nodes");
    });
}

}  // namespace

void check_gltf_structure(const GltfFile& file) {
    if (!file.json.is_object()) {
        throw Error(file.name, "is JSON, but not a glTF object", "export it as glTF 2.0");
    }
    if (!file.json.contains("asset")) {
        throw Error(file.name, "is JSON, but has no glTF asset", "export it as glTF 2.0");
    }
    const Element root(file, file.json, "");
    check_asset(file, root);
    root.each("buffers", "buffer", [](const Element& buffer) {
        buffer.need("byteLength");
        buffer.count("byteLength");
        buffer.text("uri");
    });
    root.each("bufferViews", "bufferView", check_view);
    root.each("accessors", "accessor", check_accessor);
    root.each("materials", "material", [](const Element& material) { material.text("name"); });
    root.each("meshes", "mesh", check_mesh);
    root.each("nodes", "node", check_node);
    root.each("skins", "skin", check_skin);
    root.each("animations", "animation", check_animation);
    root.each("scenes", "scene", [](const Element& scene) { scene.indices("nodes", "nodes"); });
    root.index("scene", "scenes");
}

}  // namespace earshot::io
