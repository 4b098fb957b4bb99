// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/io/internal/stated_unit.h"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace earshot::io {

enum class PlyFormat { ascii, little_endian, big_endian };
enum class PlyType { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

struct PlyProperty {
    std::string name;
    PlyType type = PlyType::float32;  ///< of the number, or of each item of the list
    bool is_list = false;
    PlyType count_type = PlyType::uint8;
};

struct PlyElement {
    std::string name;
    std::uint64_t count = 0;
    std::vector<PlyProperty> properties;
};

struct PlyHeader {
    PlyFormat format = PlyFormat::ascii;
    std::vector<PlyElement> elements;
    std::size_t size = 0;   ///< bytes up to the first element
    std::size_t lines = 0;  ///< up to the first element
    std::optional<StatedUnit> stated_unit;
};

std::size_t ply_size(PlyType type) noexcept;  ///< bytes

/// Turk 1994, "The PLY polygon file format". Throws Error naming `file` for what is not understood
/// or claims more elements than the file has room for.
PlyHeader parse_ply_header(std::string_view bytes, const std::string& file);

}  // namespace earshot::io
