// SPDX-License-Identifier: MIT
#include "earshot/base/error.h"
#include "earshot/io/internal/ply_header.h"
#include "earshot/io/internal/polygons.h"
#include "earshot/io/internal/text.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace earshot::io {
namespace {

/// The numbers of a PLY file after its header, in any of the three encodings.
class PlyNumbers {
public:
    PlyNumbers(std::string_view bytes, PlyFormat format, const std::string& file)
        : rest_(bytes), format_(format), file_(file) {}

    double next(PlyType type) {
        return format_ == PlyFormat::ascii ? next_text() : next_binary(type);
    }

    /// Numbers that are left at most, so that a claimed length can be refused before it is
    /// believed.
    std::size_t max_remaining(PlyType type) const noexcept {
        return format_ == PlyFormat::ascii ? rest_.size() / 2 + 1 : rest_.size() / ply_size(type);
    }

private:
    [[noreturn]] void fail_truncated() const {
        throw Error(file_, "is truncated", "copy or export the file again");
    }

    double next_text() {
        const auto is_blank = [](char c) { return static_cast<unsigned char>(c) <= ' '; };
        const auto* begin = std::find_if_not(rest_.begin(), rest_.end(), is_blank);
        const auto* end = std::find_if(begin, rest_.end(), is_blank);
        const std::string_view word(begin, static_cast<std::size_t>(end - begin));
        rest_.remove_prefix(static_cast<std::size_t>(end - rest_.begin()));
        if (word.empty()) {
            fail_truncated();
        }
        const auto number = to_number(word);
        if (!number) {
            throw Error(file_,
                        "has \"" + std::string(word.substr(0, 24)) + "\" in place of a number",
                        "export the file again");
        }
        return *number;
    }

    double next_binary(PlyType type) {
        const std::size_t size = ply_size(type);
        if (rest_.size() < size) {
            fail_truncated();
        }
        std::array<char, 8> bytes{};
        std::copy_n(rest_.begin(), size, bytes.begin());
        rest_.remove_prefix(size);
        if (format_ == PlyFormat::big_endian) {
            std::reverse(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
        }
        switch (type) {
            case PlyType::int8:
                return as<std::int8_t>(bytes);
            case PlyType::uint8:
                return as<std::uint8_t>(bytes);
            case PlyType::int16:
                return as<std::int16_t>(bytes);
            case PlyType::uint16:
                return as<std::uint16_t>(bytes);
            case PlyType::int32:
                return as<std::int32_t>(bytes);
            case PlyType::uint32:
                return as<std::uint32_t>(bytes);
            case PlyType::float32:
                return static_cast<double>(as<float>(bytes));
            case PlyType::float64:
                return as<double>(bytes);
        }
        return 0.0;
    }

    template <typename T>
    static T as(const std::array<char, 8>& bytes) noexcept {
        T value{};
        std::memcpy(&value, bytes.data(), sizeof value);
        return value;
    }

    std::string_view rest_;
    PlyFormat format_;
    const std::string& file_;
};

class PlyReader {
public:
    PlyReader(std::string_view bytes, const std::string& file)
        : file_(file),
          header_(parse_ply_header(bytes, file)),
          numbers_(bytes.substr(header_.size), header_.format, file) {}

    PolygonMesh read() {
        for (const PlyElement& element : header_.elements) {
            if (element.name == "vertex") {
                read_vertices(element);
            } else if (element.name == "face") {
                read_faces(element);
            } else if (element.name == "tristrips") {
                throw Error(file_, "holds triangle strips", "export it with faces");
            } else {
                for (std::uint64_t i = 0; i < element.count; ++i) {
                    read_element(element, nullptr);
                }
            }
        }
        return std::move(mesh_);
    }

private:
    /// Leaves scalars in scalars_ and the items of the list `wanted` in items_.
    void read_element(const PlyElement& element, const PlyProperty* wanted) {
        scalars_.clear();
        items_.clear();
        for (const PlyProperty& property : element.properties) {
            const double number =
                numbers_.next(property.is_list ? property.count_type : property.type);
            if (!property.is_list) {
                scalars_.push_back(number);
                continue;
            }
            scalars_.push_back(0.0);
            if (!(number >= 0.0) ||
                number > static_cast<double>(numbers_.max_remaining(property.type))) {
                throw Error(file_,
                            "has a list of a length that it is too short for",
                            "copy or export the file again");
            }
            for (auto left = static_cast<std::size_t>(number); left > 0; --left) {
                const double item = numbers_.next(property.type);
                if (&property == wanted) {
                    items_.push_back(item);
                }
            }
        }
    }

    void read_vertices(const PlyElement& element) {
        std::array<std::size_t, 3> place{};
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const std::string name(1, "xyz"[axis]);
            const auto found = std::find_if(
                element.properties.begin(), element.properties.end(), [&](const PlyProperty& p) {
                    return p.name == name && !p.is_list;
                });
            if (found == element.properties.end()) {
                throw Error(file_, "its vertices have no " + name, "export the file again");
            }
            place[axis] = static_cast<std::size_t>(found - element.properties.begin());
        }
        mesh_.mesh.positions.reserve(element.count);
        for (std::uint64_t i = 0; i < element.count; ++i) {
            read_element(element, nullptr);
            mesh_.mesh.positions.emplace_back(
                scalars_[place[0]], scalars_[place[1]], scalars_[place[2]]);
        }
    }

    void read_faces(const PlyElement& element) {
        const auto found = std::find_if(
            element.properties.begin(), element.properties.end(), [](const PlyProperty& p) {
                return p.is_list && (p.name == "vertex_indices" || p.name == "vertex_index");
            });
        if (found == element.properties.end()) {
            throw Error(file_, "its faces have no vertex_indices", "export the file again");
        }
        for (std::uint64_t i = 0; i < element.count; ++i) {
            const std::string face = "face " + std::to_string(i);
            read_element(element, &*found);
            corners_.clear();
            for (const double item : items_) {
                if (item != std::floor(item) || std::abs(item) > 1e15) {
                    throw Error(file_,
                                face + ": a vertex index is not a whole number",
                                "export the file again");
                }
                corners_.push_back(static_cast<std::int64_t>(item));
            }
            add_polygon(mesh_, corners_, file_, face);
        }
    }

    const std::string& file_;
    PlyHeader header_;
    PlyNumbers numbers_;
    PolygonMesh mesh_;
    std::vector<double> scalars_;  // one per property, 0 in place of a list
    std::vector<double> items_;
    std::vector<std::int64_t> corners_;
};

}  // namespace

PolygonMesh parse_ply(std::string_view bytes, const std::string& file) {
    return PlyReader(bytes, file).read();
}

}  // namespace earshot::io
