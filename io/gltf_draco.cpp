// SPDX-License-Identifier: MIT
#include "earshot/io/internal/gltf_file.h"

#include <cstdint>
#include <cstring>
#include <draco/compression/decode.h>
#include <draco/compression/point_cloud/point_cloud_decoder.h>
#include <draco/core/varint_decoding.h>
#include <draco/metadata/metadata_decoder.h>
#include <map>
#include <memory>
#include <optional>

namespace earshot::io {
namespace {

using Bytes = std::vector<unsigned char>;
using Json = nlohmann::json;

/// Draco allocates for the triangles of its header before it has read them, so a header is believed
/// up to a number that does no harm, and beyond it as far as its bytes are likely to hold them:
/// real meshes take more than a bit per triangle.
constexpr std::size_t kMaxHarmlessTriangles = std::size_t{1} << 22U;
constexpr std::size_t kMaxTrianglesPerByte = 64;

/// The number of triangles in the header of a Draco mesh of bitstream 2.2, which the glTF extension
/// demands. Nothing if the header is not one.
std::optional<std::size_t> declared_triangles(const Bytes& bytes) {
    draco::DecoderBuffer buffer;
    buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    draco::DracoHeader header{};
    if (!draco::PointCloudDecoder::DecodeHeader(&buffer, &header).ok() ||
        header.encoder_type != draco::TRIANGULAR_MESH || header.version_major != 2 ||
        header.version_minor != 2) {
        return std::nullopt;
    }
    buffer.set_bitstream_version(DRACO_BITSTREAM_VERSION(2, 2));
    draco::GeometryMetadata metadata;
    const bool has_metadata = (header.flags & METADATA_FLAG_MASK) != 0;
    if (has_metadata && !draco::MetadataDecoder().DecodeGeometryMetadata(&buffer, &metadata)) {
        return std::nullopt;
    }
    std::uint32_t vertices = 0;
    std::uint32_t triangles = 0;
    if (header.encoder_method == draco::MESH_SEQUENTIAL_ENCODING) {
        return draco::DecodeVarint(&triangles, &buffer) ? std::optional(std::size_t{triangles})
                                                        : std::nullopt;
    }
    std::uint8_t traversal = 0;
    const bool is_read = buffer.Decode(&traversal) && draco::DecodeVarint(&vertices, &buffer) &&
                         draco::DecodeVarint(&triangles, &buffer);
    return is_read ? std::optional(std::size_t{triangles}) : std::nullopt;
}

/// glTF's componentType; 0 for what it does not have.
int component_type(draco::DataType type) noexcept {
    switch (type) {
        case draco::DT_INT8:
            return TINYGLTF_COMPONENT_TYPE_BYTE;
        case draco::DT_UINT8:
            return TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE;
        case draco::DT_INT16:
            return TINYGLTF_COMPONENT_TYPE_SHORT;
        case draco::DT_UINT16:
            return TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT;
        case draco::DT_UINT32:
            return TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
        case draco::DT_FLOAT32:
            return TINYGLTF_COMPONENT_TYPE_FLOAT;
        default:
            return 0;
    }
}

/// Decodes one primitive. What it finds goes into accessors of its own, so that the readers after
/// it need not know of Draco.
class PrimitiveDecoder {
public:
    PrimitiveDecoder(GltfFile& file, const Json& extension, std::string element)
        : file_(file), extension_(extension), element_(std::move(element)) {}

    void decode(tinygltf::Primitive& primitive) {
        check_counts(primitive, compressed_bytes());
        mesh_ = decoded_mesh();
        const std::size_t vertices = mesh_->num_points();
        const auto& declared = accessor(primitive.attributes.at("POSITION"));
        if (declared.count != vertices) {
            fail("Draco holds " + std::to_string(vertices) + " vertices where " +
                 std::to_string(declared.count) + " are declared");
        }
        for (const auto& [name, id] : attribute_ids()) {
            const auto place = primitive.attributes.find(name);
            if (place != primitive.attributes.end()) {
                place->second = attribute_accessor(name, id, place->second);
            }
        }
        primitive.indices = index_accessor(primitive.indices);
    }

private:
    [[noreturn]] void fail(const std::string& what) const { file_.fail(element_, what); }

    const tinygltf::Accessor& accessor(int index) const {
        return file_.model.accessors[static_cast<std::size_t>(index)];
    }

    const Bytes& compressed_bytes() {
        const std::size_t index = file_.whole_number(extension_, "bufferView", element_);
        if (index >= file_.model.bufferViews.size()) {
            fail("its Draco bufferView " + std::to_string(index) + " does not exist");
        }
        const tinygltf::BufferView& view = file_.model.bufferViews[index];
        const Bytes& buffer = file_.model.buffers[static_cast<std::size_t>(view.buffer)].data;
        if (view.byteOffset > buffer.size() || view.byteLength > buffer.size() - view.byteOffset) {
            fail("its Draco data does not lie in buffer " + std::to_string(view.buffer));
        }
        const unsigned char* first = buffer.data() + view.byteOffset;
        bytes_.assign(first, first + view.byteLength);
        return bytes_;
    }

    /// Bounds the work by the file: the header's number of triangles is the declared one, and so
    /// many bytes can hold it.
    void check_counts(const tinygltf::Primitive& primitive, const Bytes& bytes) const {
        if (primitive.mode != TINYGLTF_MODE_TRIANGLES || primitive.indices < 0 ||
            primitive.attributes.find("POSITION") == primitive.attributes.end()) {
            fail("Draco compresses indexed triangles with a POSITION only");
        }
        const std::optional<std::size_t> triangles = declared_triangles(bytes);
        if (!triangles) {
            fail("its Draco data is not a mesh of bitstream 2.2");
        }
        const std::size_t indices = accessor(primitive.indices).count;
        if (indices % 3 != 0 || *triangles != indices / 3) {
            fail("Draco holds " + std::to_string(*triangles) + " triangles where " +
                 std::to_string(indices) + " indices are declared");
        }
        if (*triangles > kMaxHarmlessTriangles &&
            *triangles / kMaxTrianglesPerByte > bytes.size()) {
            fail(std::to_string(bytes.size()) + " bytes of Draco cannot hold " +
                 std::to_string(*triangles) + " triangles");
        }
        // Indices, and as many positions as a mesh of separate triangles has.
        constexpr std::size_t kBytesPerTriangle = 3 * (sizeof(std::uint32_t) + 3 * sizeof(float));
        file_.spend(element_, GltfCost::decoded_bytes, *triangles, kBytesPerTriangle);
    }

    std::unique_ptr<draco::Mesh> decoded_mesh() const {
        draco::DecoderBuffer buffer;
        buffer.Init(reinterpret_cast<const char*>(bytes_.data()), bytes_.size());
        draco::Decoder decoder;
        auto result = decoder.DecodeMeshFromBuffer(&buffer);
        if (!result.ok()) {
            fail("its Draco data is damaged: " + condensed(result.status().error_msg_string()));
        }
        return std::move(result).value();
    }

    /// Names of attributes with the identifiers that they have within Draco.
    std::map<std::string, std::uint32_t> attribute_ids() const {
        std::map<std::string, std::uint32_t> ids;
        const auto found = extension_.find("attributes");
        if (found == extension_.end() || !found->is_object()) {
            fail("the attributes of its Draco data are missing");
        }
        for (const auto& [name, value] : found->items()) {
            const bool has_geometry =
                name == "POSITION" || name.starts_with("JOINTS_") || name.starts_with("WEIGHTS_");
            if (has_geometry) {
                ids[name] = static_cast<std::uint32_t>(
                    file_.whole_number(*found, name.c_str(), element_) & 0xFFFFFFFFU);
            }
        }
        if (ids.find("POSITION") == ids.end()) {
            fail("its Draco data has no POSITION");
        }
        return ids;
    }

    int attribute_accessor(const std::string& name, std::uint32_t id, int declared) {
        const draco::PointAttribute* attribute = mesh_->GetAttributeByUniqueId(id);
        if (attribute == nullptr) {
            fail("Draco has no attribute " + std::to_string(id) + " for " + name);
        }
        tinygltf::Accessor made = accessor(declared);
        const auto width = static_cast<std::size_t>(attribute->num_components());
        made.componentType = component_type(attribute->data_type());
        const int components =
            tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(made.type));
        if (made.componentType == 0 || components != attribute->num_components()) {
            fail("the type of " + name + " in Draco is not that of its accessor");
        }
        const std::size_t size =
            width * static_cast<std::size_t>(draco::DataTypeLength(attribute->data_type()));
        Bytes bytes(mesh_->num_points() * size);
        for (std::uint32_t point = 0; point < mesh_->num_points(); ++point) {
            attribute->GetMappedValue(draco::PointIndex(point), bytes.data() + point * size);
        }
        made.count = mesh_->num_points();
        return add_accessor(std::move(made), std::move(bytes));
    }

    int index_accessor(int declared) {
        Bytes bytes(mesh_->num_faces() * 3 * sizeof(std::uint32_t));
        unsigned char* place = bytes.data();
        for (std::uint32_t i = 0; i < mesh_->num_faces(); ++i) {
            for (const draco::PointIndex& corner : mesh_->face(draco::FaceIndex(i))) {
                const std::uint32_t index = corner.value();
                std::memcpy(place, &index, sizeof index);
                place += sizeof index;
            }
        }
        tinygltf::Accessor made = accessor(declared);
        made.componentType = TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
        made.count = mesh_->num_faces() * 3;
        return add_accessor(std::move(made), std::move(bytes));
    }

    int add_accessor(tinygltf::Accessor made, Bytes bytes) {
        made.bufferView = append_buffer_view(file_.model, std::move(bytes));
        made.byteOffset = 0;
        made.sparse.isSparse = false;
        file_.model.accessors.push_back(std::move(made));
        return static_cast<int>(file_.model.accessors.size()) - 1;
    }

    GltfFile& file_;
    const Json& extension_;
    std::string element_;
    Bytes bytes_;
    std::unique_ptr<draco::Mesh> mesh_;
};

}  // namespace

void decode_draco_primitives(GltfFile& file) {
    for (std::size_t mesh = 0; mesh < file.model.meshes.size(); ++mesh) {
        std::vector<tinygltf::Primitive>& primitives = file.model.meshes[mesh].primitives;
        for (std::size_t i = 0; i < primitives.size(); ++i) {
            const std::string element =
                "mesh " + std::to_string(mesh) + " primitive " + std::to_string(i);
            const Json& json = file.json["meshes"][mesh]["primitives"][i];
            if (const Json* extension = file.extension(json, kDracoExtension, element)) {
                PrimitiveDecoder(file, *extension, element).decode(primitives[i]);
            }
        }
    }
}

}  // namespace earshot::io
