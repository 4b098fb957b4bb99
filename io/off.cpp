// SPDX-License-Identifier: MIT
#include "earshot/base/error.h"
#include "earshot/io/internal/polygons.h"
#include "earshot/io/internal/text.h"

namespace earshot::io {
namespace {

/// Reads ASCII OFF with its variants COFF, NOFF, STOFF, ...: what follows the coordinates of a
/// vertex or the corners of a face is left out.
class OffReader {
public:
    OffReader(std::string_view text, const std::string& file) : file_(file), lines_(text) {}

    PolygonMesh read() {
        std::string_view line = next_line("the counts");
        const std::string_view keyword = take_word(line);
        if (!keyword.ends_with("OFF") || keyword == "4OFF" || keyword == "nOFF") {
            throw Error(file_, "does not begin with OFF", "export it as three-dimensional OFF");
        }
        if (trimmed(line) == "BINARY") {
            throw Error(file_, "is binary OFF", "export it as ASCII OFF");
        }
        if (trimmed(line).empty()) {
            line = next_line("the counts");
        }
        const std::int64_t vertex_count = count(line);
        const std::int64_t face_count = count(line);
        for (std::int64_t i = 0; i < vertex_count; ++i) {
            add_vertex(next_line("vertex " + std::to_string(i)));
        }
        for (std::int64_t i = 0; i < face_count; ++i) {
            add_face(next_line("face " + std::to_string(i)), "face " + std::to_string(i));
        }
        return std::move(mesh_);
    }

private:
    /// The next line that is not blank, without its comment.
    std::string_view next_line(const std::string& wanted) {
        while (const auto line = lines_.next()) {
            const std::string_view text = trimmed(line->substr(0, line->find('#')));
            if (!text.empty()) {
                return text;
            }
        }
        throw Error(file_, "ends before " + wanted, "copy or export the file again");
    }

    std::int64_t count(std::string_view& line) const {
        const auto number = to_integer(take_word(line));
        if (!number || *number < 0) {
            throw Error(file_,
                        lines_.name() + ": the numbers of vertices and faces are missing",
                        "export the file again");
        }
        return *number;
    }

    void add_vertex(std::string_view line) {
        geometry::Vec3 position(0.0);
        for (int axis = 0; axis < 3; ++axis) {
            const auto number = to_number(take_word(line));
            if (!number) {
                throw Error(
                    file_, lines_.name() + ": a vertex needs three numbers", "correct the line");
            }
            position[axis] = *number;
        }
        mesh_.mesh.positions.push_back(position);
    }

    void add_face(std::string_view line, const std::string& face) {
        const std::int64_t corner_count = count(line);
        corners_.clear();
        for (std::int64_t i = 0; i < corner_count; ++i) {
            const auto corner = to_integer(take_word(line));
            if (!corner) {
                throw Error(file_,
                            lines_.name() + ": " + std::to_string(corner_count) +
                                " corners are claimed, " + std::to_string(i) + " are there",
                            "correct the line");
            }
            corners_.push_back(*corner);
        }
        add_polygon(mesh_, corners_, file_, face);
    }

    const std::string& file_;
    Lines lines_;
    PolygonMesh mesh_;
    std::vector<std::int64_t> corners_;
};

}  // namespace

PolygonMesh parse_off(std::string_view text, const std::string& file) {
    return OffReader(text, file).read();
}

}  // namespace earshot::io
