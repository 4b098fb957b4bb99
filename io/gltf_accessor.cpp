// SPDX-License-Identifier: MIT
#include "earshot/io/internal/gltf_accessor.h"

#include "earshot/io/scene_file.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace earshot::io {
namespace {

using Bytes = std::vector<unsigned char>;

std::string name_of(int accessor) {
    return "accessor " + std::to_string(accessor);
}

/// Bytes of one component; 0 for what glTF does not have.
std::size_t component_size(int type) noexcept {
    switch (type) {
        case TINYGLTF_COMPONENT_TYPE_BYTE:
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
            return 1;
        case TINYGLTF_COMPONENT_TYPE_SHORT:
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
            return 2;
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
        case TINYGLTF_COMPONENT_TYPE_FLOAT:
            return 4;
        default:
            return 0;
    }
}

template <typename T>
T load(const unsigned char* bytes) noexcept {
    T value{};
    std::memcpy(&value, bytes, sizeof value);
    return value;
}

double component(const unsigned char* bytes, int type, bool is_normalized) noexcept {
    double value = 0.0;
    double largest = 1.0;
    switch (type) {
        case TINYGLTF_COMPONENT_TYPE_BYTE:
            value = load<std::int8_t>(bytes);
            largest = 127.0;
            break;
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
            value = load<std::uint8_t>(bytes);
            largest = 255.0;
            break;
        case TINYGLTF_COMPONENT_TYPE_SHORT:
            value = load<std::int16_t>(bytes);
            largest = 32767.0;
            break;
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
            value = load<std::uint16_t>(bytes);
            largest = 65535.0;
            break;
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
            return load<std::uint32_t>(bytes);
        default:
            return static_cast<double>(load<float>(bytes));
    }
    // glTF 2.0 section 3.6.2.2: the lowest signed value stands for -1 like the one above it.
    return is_normalized ? std::max(value / largest, -1.0) : value;
}

/// Elements in a buffer, checked to lie inside it.
struct StridedBytes {
    const unsigned char* first = nullptr;
    std::size_t stride = 0;
};

StridedBytes locate(const GltfFile& file,
                    const std::string& element,
                    int view_index,
                    std::size_t offset,
                    std::size_t element_size,
                    std::size_t count) {
    const tinygltf::BufferView& view = file.model.bufferViews[static_cast<std::size_t>(view_index)];
    const std::string view_name = "bufferView " + std::to_string(view_index);
    const Bytes& buffer = file.model.buffers[static_cast<std::size_t>(view.buffer)].data;
    if (view.byteOffset > buffer.size() || view.byteLength > buffer.size() - view.byteOffset) {
        file.fail(view_name,
                  "its " + std::to_string(view.byteLength) + " bytes from " +
                      std::to_string(view.byteOffset) + " do not lie in buffer " +
                      std::to_string(view.buffer) + " of " + std::to_string(buffer.size()) +
                      " bytes");
    }
    const std::size_t stride = view.byteStride == 0 ? element_size : view.byteStride;
    if (stride < element_size) {
        file.fail(view_name, "byteStride is smaller than an element of " + element);
    }
    // Written so that nothing overflows whatever the file claims.
    const std::size_t capacity =
        offset <= view.byteLength && element_size <= view.byteLength - offset
            ? (view.byteLength - offset - element_size) / stride + 1
            : 0;
    if (count > capacity) {
        file.fail(element,
                  "its " + std::to_string(count) + " elements do not lie in " + view_name + " of " +
                      std::to_string(view.byteLength) + " bytes");
    }
    return {buffer.data() + view.byteOffset + (count == 0 ? 0 : offset), stride};
}

const tinygltf::Accessor& checked(const GltfFile& file, int index, std::size_t components) {
    const tinygltf::Accessor& accessor = file.model.accessors[static_cast<std::size_t>(index)];
    const int has = tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(accessor.type));
    if (has < 0 || static_cast<std::size_t>(has) != components) {
        file.fail(name_of(index),
                  "it has " + std::to_string(has) + " components where " +
                      std::to_string(components) + " are needed");
    }
    if (component_size(accessor.componentType) == 0) {
        file.fail(
            name_of(index),
            "componentType " + std::to_string(accessor.componentType) + " is not one of glTF's");
    }
    if (accessor.bufferView < 0 && accessor.count > kMaxUnbackedNumbers / components) {
        file.fail(name_of(index),
                  "it claims " + std::to_string(accessor.count) + " elements without a bufferView");
    }
    return accessor;
}

/// Calls put(element, bytes) for every element that has bytes, sparse ones last.
template <typename Put>
void for_each_element(const GltfFile& file, int index, std::size_t components, const Put& put) {
    const tinygltf::Accessor& accessor = checked(file, index, components);
    const std::size_t size = component_size(accessor.componentType) * components;
    if (accessor.bufferView >= 0) {
        const StridedBytes block = locate(
            file, name_of(index), accessor.bufferView, accessor.byteOffset, size, accessor.count);
        for (std::size_t i = 0; i < accessor.count; ++i) {
            put(i, block.first + i * block.stride);
        }
    }
    const auto& sparse = accessor.sparse;
    if (!sparse.isSparse) {
        return;
    }
    const std::string element = name_of(index) + " sparse";
    const std::size_t index_size = component_size(sparse.indices.componentType);
    if (index_size == 0 || sparse.count < 0 || sparse.indices.byteOffset < 0 ||
        sparse.values.byteOffset < 0) {
        file.fail(element, "its count, offsets or index type are not valid");
    }
    const auto count = static_cast<std::size_t>(sparse.count);
    const StridedBytes indices = locate(file,
                                        element,
                                        sparse.indices.bufferView,
                                        static_cast<std::size_t>(sparse.indices.byteOffset),
                                        index_size,
                                        count);
    const StridedBytes values = locate(file,
                                       element,
                                       sparse.values.bufferView,
                                       static_cast<std::size_t>(sparse.values.byteOffset),
                                       size,
                                       count);
    for (std::size_t i = 0; i < count; ++i) {
        const double at =
            component(indices.first + i * indices.stride, sparse.indices.componentType, false);
        if (!(at >= 0.0) || at >= static_cast<double>(accessor.count)) {
            file.fail(element, "an index is not below " + std::to_string(accessor.count));
        }
        put(static_cast<std::size_t>(at), values.first + i * values.stride);
    }
}

[[noreturn]] void fail_not_finite(const GltfFile& file, int index, std::size_t element) {
    file.fail(name_of(index), "element " + std::to_string(element) + " is not a finite number");
}

/// The numbers of an accessor; with `require_finite` one that is not finite is an error.
std::vector<double> read_numbers(const GltfFile& file,
                                 int index,
                                 std::size_t components,
                                 bool require_finite) {
    const tinygltf::Accessor& accessor = checked(file, index, components);
    const int type = accessor.componentType;
    const std::size_t size = component_size(type);
    std::vector<double> numbers;
    const auto reserve_once = [&] {
        if (numbers.empty()) {
            file.spend(name_of(index), GltfCost::numbers, accessor.count, components);
            numbers.resize(accessor.count * components);
        }
    };
    for_each_element(file, index, components, [&](std::size_t at, const unsigned char* bytes) {
        reserve_once();
        for (std::size_t i = 0; i < components; ++i) {
            const double value = component(bytes + i * size, type, accessor.normalized);
            if (require_finite && !std::isfinite(value)) {
                fail_not_finite(file, index, at);
            }
            numbers[at * components + i] = value;
        }
    });
    reserve_once();
    return numbers;
}

}  // namespace

std::vector<double> accessor_numbers(const GltfFile& file, int index, std::size_t components) {
    return read_numbers(file, index, components, true);
}

std::vector<std::uint32_t> accessor_indices(const GltfFile& file,
                                            int index,
                                            std::size_t components,
                                            std::size_t bound,
                                            const std::string& what) {
    const tinygltf::Accessor& accessor = checked(file, index, components);
    const int type = accessor.componentType;
    const bool is_unsigned = type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE ||
                             type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ||
                             type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
    if (!is_unsigned) {
        file.fail(name_of(index), "its numbers serve as indices but are not unsigned integers");
    }
    const std::vector<double> numbers = accessor_numbers(file, index, components);
    std::vector<std::uint32_t> indices(numbers.size());
    for (std::size_t i = 0; i < numbers.size(); ++i) {
        if (numbers[i] >= static_cast<double>(bound)) {
            file.fail(name_of(index),
                      "index " + std::to_string(static_cast<std::uint32_t>(numbers[i])) +
                          " is not below " + std::to_string(bound) + ", the number of " + what);
        }
        indices[i] = static_cast<std::uint32_t>(numbers[i]);
    }
    return indices;
}

std::vector<geometry::Vec3> accessor_points(const GltfFile& file, int index) {
    const std::vector<double> numbers = read_numbers(file, index, 3, false);
    std::vector<geometry::Vec3> points(numbers.size() / 3);
    for (std::size_t i = 0; i < points.size(); ++i) {
        points[i] = {numbers[3 * i], numbers[3 * i + 1], numbers[3 * i + 2]};
    }
    return points;
}

void check_used_points(const GltfFile& file,
                       int index,
                       const std::vector<geometry::Vec3>& points,
                       const std::vector<bool>& is_used) {
    for (std::size_t i = 0; i < points.size(); ++i) {
        for (int axis = 0; is_used[i] && axis < 3; ++axis) {
            if (!std::isfinite(points[i][axis])) {
                fail_not_finite(file, index, i);
            }
            if (std::abs(points[i][axis]) > kMaxCoordinate) {
                file.fail(name_of(index),
                          "element " + std::to_string(i) + " lies beyond 1e12 m",
                          "check the units of the export");
            }
        }
    }
}

}  // namespace earshot::io
