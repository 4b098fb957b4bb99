// SPDX-License-Identifier: MIT
#include "earshot/io/internal/gltf_file.h"

#include <limits>
#include <meshoptimizer.h>

namespace earshot::io {
namespace {

using Bytes = std::vector<unsigned char>;
using Json = nlohmann::json;

/// What EXT_meshopt_compression says of one bufferView.
struct CompressedView {
    std::string element;
    const unsigned char* data = nullptr;
    std::size_t size = 0;
    std::size_t count = 0;
    std::size_t stride = 0;
    std::string mode;
    std::string filter;
};

std::string text_of(const GltfFile& file,
                    const Json& object,
                    const char* key,
                    const std::string& element,
                    const char* fallback) {
    const auto found = object.find(key);
    if (found != object.end() && !found->is_string()) {
        file.fail(element, std::string(key) + " is not a text");
    }
    return found == object.end() ? fallback : found->get<std::string>();
}

CompressedView read_view(const GltfFile& file, const Json& extension, std::string element) {
    CompressedView view;
    const std::size_t buffer = file.whole_number(extension, "buffer", element);
    const std::size_t offset = file.whole_number(extension, "byteOffset", element, 0);
    view.size = file.whole_number(extension, "byteLength", element);
    view.count = file.whole_number(extension, "count", element);
    view.stride = file.whole_number(extension, "byteStride", element);
    view.mode = text_of(file, extension, "mode", element, "");
    view.filter = text_of(file, extension, "filter", element, "NONE");
    if (buffer >= file.model.buffers.size()) {
        file.fail(element, "its compressed buffer " + std::to_string(buffer) + " does not exist");
    }
    const Bytes& bytes = file.model.buffers[buffer].data;
    if (offset > bytes.size() || view.size > bytes.size() - offset) {
        file.fail(element,
                  "its " + std::to_string(view.size) + " compressed bytes do not lie in buffer " +
                      std::to_string(buffer) + " of " + std::to_string(bytes.size()) + " bytes");
    }
    view.data = bytes.data() + offset;
    view.element = std::move(element);
    return view;
}

/// The preconditions of the decoders, and a bound of their output by their input: the densest block
/// holds 256 vertices in four bytes per byte of a vertex, and an index takes a third of a byte.
void check_view(const GltfFile& file, const CompressedView& view, std::size_t declared) {
    constexpr std::size_t kMaxRatio = 64;
    constexpr std::size_t kMaxVertexStride = 256;
    const bool is_attributes = view.mode == "ATTRIBUTES";
    if (!is_attributes && view.mode != "TRIANGLES" && view.mode != "INDICES") {
        file.fail(view.element, "its mode is " + condensed(view.mode));
    }
    const bool is_stride_right =
        is_attributes ? view.stride > 0 && view.stride % 4 == 0 && view.stride <= kMaxVertexStride
                      : view.stride == 2 || view.stride == 4;
    if (!is_stride_right) {
        file.fail(
            view.element,
            "byteStride " + std::to_string(view.stride) + " does not go with mode " + view.mode);
    }
    if (view.mode == "TRIANGLES" && view.count % 3 != 0) {
        file.fail(view.element, std::to_string(view.count) + " indices are not whole triangles");
    }
    if (view.count > declared / view.stride || view.count * view.stride != declared) {
        file.fail(view.element,
                  std::to_string(view.count) + " elements of " + std::to_string(view.stride) +
                      " bytes are not its byteLength of " + std::to_string(declared));
    }
    if (declared / kMaxRatio > view.size) {
        file.fail(view.element,
                  std::to_string(view.size) + " compressed bytes cannot hold " +
                      std::to_string(declared));
    }
    const bool is_filter_right =
        view.filter == "NONE" ||
        (is_attributes &&
         ((view.filter == "OCTAHEDRAL" && (view.stride == 4 || view.stride == 8)) ||
          (view.filter == "QUATERNION" && view.stride == 8) || view.filter == "EXPONENTIAL"));
    if (!is_filter_right) {
        file.fail(view.element,
                  "its filter " + condensed(view.filter) + " does not go with byteStride " +
                      std::to_string(view.stride));
    }
}

Bytes decoded(const GltfFile& file, const CompressedView& view) {
    Bytes bytes(view.count * view.stride);
    int failure = 0;
    if (view.mode == "ATTRIBUTES") {
        failure =
            meshopt_decodeVertexBuffer(bytes.data(), view.count, view.stride, view.data, view.size);
    } else if (view.mode == "TRIANGLES") {
        failure =
            meshopt_decodeIndexBuffer(bytes.data(), view.count, view.stride, view.data, view.size);
    } else {
        failure = meshopt_decodeIndexSequence(
            bytes.data(), view.count, view.stride, view.data, view.size);
    }
    if (failure != 0) {
        file.fail(view.element, "its compressed data is damaged");
    }
    if (view.filter == "OCTAHEDRAL") {
        meshopt_decodeFilterOct(bytes.data(), view.count, view.stride);
    } else if (view.filter == "QUATERNION") {
        meshopt_decodeFilterQuat(bytes.data(), view.count, view.stride);
    } else if (view.filter == "EXPONENTIAL") {
        meshopt_decodeFilterExp(bytes.data(), view.count, view.stride);
    }
    return bytes;
}

}  // namespace

void decode_meshopt_views(GltfFile& file) {
    for (std::size_t i = 0; i < file.model.bufferViews.size(); ++i) {
        const std::string element = "bufferView " + std::to_string(i);
        const Json* extension =
            file.extension(file.json["bufferViews"][i], kMeshoptExtension, element);
        if (extension == nullptr) {
            continue;
        }
        const CompressedView view = read_view(file, *extension, element);
        check_view(file, view, file.model.bufferViews[i].byteLength);
        file.spend(element, GltfCost::decoded_bytes, view.count, view.stride);
        const int plain = append_buffer_view(file.model, decoded(file, view));
        const std::size_t stride = file.model.bufferViews[i].byteStride;
        file.model.bufferViews[i] = file.model.bufferViews[static_cast<std::size_t>(plain)];
        file.model.bufferViews[i].byteStride = stride;
    }
}

}  // namespace earshot::io
