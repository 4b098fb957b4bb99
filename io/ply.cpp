// SPDX-License-Identifier: MIT
#include "earshot/base/error.h"
#include "earshot/io/internal/ply_records.h"
#include "earshot/io/internal/polygons.h"
#include "earshot/io/internal/text.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace earshot::io {
namespace {

class PlyReader {
public:
    PlyReader(const PlyHeader& header, PlyRecords& records, const std::string& file)
        : header_(header), records_(records), faces_("face", file), file_(file) {}

    /// Elements may stand in any order.
    PolygonMesh read() {
        mesh_.stated_unit = header_.stated_unit;
        for (const PlyElement& element : header_.elements) {
            if (element.name == "vertex") {
                read_vertices(element);
            } else if (element.name == "face") {
                read_faces(element);
            } else if (element.name == "tristrips") {
                throw Error(file_, "holds triangle strips", "export it with faces");
            } else {
                for (std::uint64_t i = 0; i < element.count; ++i) {
                    records_.read(element, nullptr, record_);
                }
            }
        }
        records_.finish(mesh_.warnings);
        faces_.triangulate_into(mesh_);
        return std::move(mesh_);
    }

    /// Whether a face was a point or a line.
    bool has_left_out_faces() const noexcept { return faces_.left_out() > 0; }

private:
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
            records_.read(element, nullptr, record_);
            mesh_.mesh.positions.emplace_back(
                record_.scalars[place[0]], record_.scalars[place[1]], record_.scalars[place[2]]);
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
            records_.read(element, &*found, record_);
            corners_.clear();
            for (const double item : record_.list) {
                if (item != std::floor(item) || std::abs(item) > 1e15) {
                    throw Error(
                        file_,
                        "face " + std::to_string(i) + ": a vertex index is not a whole number",
                        "export the file again");
                }
                corners_.push_back(static_cast<std::int64_t>(item));
            }
            faces_.add(corners_, i);
        }
    }

    const PlyHeader& header_;
    PlyRecords& records_;
    PolygonMesh mesh_;
    PolygonList faces_;
    const std::string& file_;
    PlyRecord record_;
    std::vector<std::int64_t> corners_;
};

/// Text has one element per line. Some writers break lines elsewhere: then, and only then, the
/// numbers are read as one stream, which has to end exactly with the last element.
PolygonMesh read_text(const PlyHeader& header, std::string_view body, const std::string& file) {
    try {
        LinePlyRecords lines(body, header.lines, file);
        return PlyReader(header, lines, file).read();
    } catch (const LinePlyRecords::Short& too_short) {
        try {
            StreamPlyRecords stream(body, file);
            PlyReader reader(header, stream, file);
            PolygonMesh mesh = reader.read();
            // A sign that numbers have been taken for what they are not.
            if (reader.has_left_out_faces()) {
                throw Error(file,
                            "has faces of fewer than three corners",
                            "write every vertex and every face on a line of its own");
            }
            return mesh;
        } catch (const Error& error) {
            throw Error(file, std::string(error.what()) + ": " + too_short.what(), error.remedy());
        }
    }
}

}  // namespace

PolygonMesh parse_ply(std::string_view bytes, const std::string& file) {
    const std::string_view text = decoded_text(bytes, file);
    const PlyHeader header = parse_ply_header(text, file);
    const std::string_view body = text.substr(header.size);
    if (header.format == PlyFormat::ascii) {
        return read_text(header, body, file);
    }
    BinaryPlyRecords records(body, header.format, file);
    return PlyReader(header, records, file).read();
}

}  // namespace earshot::io
