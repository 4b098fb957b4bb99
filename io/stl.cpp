// SPDX-License-Identifier: MIT
#include "earshot/base/error.h"
#include "earshot/io/internal/polygons.h"
#include "earshot/io/internal/text.h"

#include <cstring>

namespace earshot::io {
namespace {

constexpr std::size_t kHeaderBytes = 84;  // 80 of comment, 4 of the triangle count
constexpr std::size_t kFacetBytes = 50;   // normal, three vertices, 2 of attributes

/// A vertex of its own for every corner: STL shares none.
void add_triangle(PolygonMesh& mesh, const std::array<geometry::Vec3, 3>& corners) {
    const auto first = static_cast<geometry::VertexId>(mesh.mesh.positions.size());
    mesh.mesh.positions.insert(mesh.mesh.positions.end(), corners.begin(), corners.end());
    mesh.mesh.triangles.push_back({first, first + 1, first + 2});
}

std::size_t claimed_triangles(std::string_view bytes) {
    std::uint32_t count = 0;
    std::memcpy(&count, bytes.data() + kHeaderBytes - sizeof count, sizeof count);
    return count;
}

PolygonMesh parse_binary(std::string_view bytes, std::size_t count) {
    PolygonMesh mesh;
    mesh.mesh.positions.reserve(count * 3);
    mesh.mesh.triangles.reserve(count);
    for (std::size_t i = 0; i < count; ++i) {
        std::array<float, 12> numbers{};  // the normal and three vertices
        std::memcpy(numbers.data(), bytes.data() + kHeaderBytes + i * kFacetBytes, sizeof numbers);
        std::array<geometry::Vec3, 3> corners;
        for (std::size_t k = 0; k < 3; ++k) {
            corners[k] = {numbers[3 + 3 * k], numbers[4 + 3 * k], numbers[5 + 3 * k]};
        }
        add_triangle(mesh, corners);
    }
    return mesh;
}

PolygonMesh parse_ascii(std::string_view text, const std::string& file) {
    PolygonMesh mesh;
    std::array<geometry::Vec3, 3> corners;
    std::size_t corner_count = 0;
    bool is_ended = false;
    Lines lines(text);
    while (const auto line = lines.next()) {
        std::string_view rest = *line;
        const std::string_view keyword = take_word(rest);
        if (keyword == "vertex") {
            for (int axis = 0; axis < 3; ++axis) {
                const auto number = to_number(take_word(rest));
                if (!number || corner_count == 3) {
                    throw Error(file,
                                lines.name() + ": a facet needs three vertices of three numbers",
                                "mend the line");
                }
                corners[corner_count][axis] = *number;
            }
            ++corner_count;
        } else if (keyword == "endloop") {
            if (corner_count != 3) {
                throw Error(file,
                            lines.name() + ": a facet has " + std::to_string(corner_count) +
                                " vertices, not three",
                            "export the file again");
            }
            add_triangle(mesh, corners);
            corner_count = 0;
        }
        is_ended = keyword == "endsolid" || (is_ended && keyword.empty());
    }
    if (!is_ended) {
        throw Error(file, "is truncated: it does not end with endsolid", "copy the file again");
    }
    return mesh;
}

}  // namespace

PolygonMesh parse_stl(std::string_view bytes, const std::string& file) {
    // The size decides: binary files may begin with "solid" too.
    const std::size_t capacity =
        bytes.size() < kHeaderBytes ? 0 : (bytes.size() - kHeaderBytes) / kFacetBytes;
    const bool has_count = bytes.size() >= kHeaderBytes;
    if (has_count && claimed_triangles(bytes) * kFacetBytes + kHeaderBytes == bytes.size()) {
        return parse_binary(bytes, capacity);
    }
    std::string_view start = bytes.substr(0, kHeaderBytes);
    if (take_word(start) == "solid" && bytes.find('\0') == std::string_view::npos) {
        return parse_ascii(bytes, file);
    }
    if (!has_count || claimed_triangles(bytes) > capacity) {
        throw Error(file,
                    "is truncated: " + std::to_string(capacity) + " of " +
                        (has_count ? std::to_string(claimed_triangles(bytes)) : "?") +
                        " triangles are there",
                    "copy or export the file again");
    }
    return parse_binary(bytes, claimed_triangles(bytes));
}

}  // namespace earshot::io
