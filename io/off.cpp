// SPDX-License-Identifier: MIT
#include "earshot/base/error.h"
#include "earshot/io/internal/polygons.h"
#include "earshot/io/internal/text.h"

namespace earshot::io {
namespace {

/// The keyword that may begin a file, with what stands glued to it (`OFF490 518 0`).
struct Keyword {
    std::string_view word;
    std::string_view glued;
};

Keyword keyword_of(std::string_view word) noexcept {
    const std::size_t end = word.find("OFF");
    const bool is_glued = end != std::string_view::npos && end + 3 < word.size() &&
                          word[end + 3] >= '0' && word[end + 3] <= '9';
    return is_glued ? Keyword{word.substr(0, end + 3), word.substr(end + 3)} : Keyword{word, {}};
}

/// Where the comment of a line begins; `1.#QNAN` is a number.
std::size_t comment_begin(std::string_view line) noexcept {
    std::size_t begin = line.find('#');
    while (begin != std::string_view::npos && begin > 0 && line[begin - 1] == '.') {
        begin = line.find('#', begin + 1);
    }
    return begin;
}

/// Reads ASCII OFF with its variants COFF, NOFF, STOFF, ...: a vertex or a face to a line; what
/// follows the coordinates of a vertex or the corners of a face is left out.
class OffReader {
public:
    OffReader(std::string_view text, const std::string& file)
        : file_(file), lines_(text), faces_("face", file) {}

    PolygonMesh read() {
        const std::string counts = read_header();
        std::string_view line = counts;
        const std::int64_t vertex_count = count(line);
        const std::int64_t face_count = count(line);
        take_word(line);  // the number of edges, which may be left out
        if (!trimmed(line).empty()) {
            throw Error(file_,
                        lines_.name() +
                            ": more than the numbers of vertices, faces and edges stand "
                            "on the line",
                        "write every vertex and every face on a line of its own");
        }
        for (std::int64_t i = 0; i < vertex_count; ++i) {
            add_vertex(next_line("vertex " + std::to_string(i)));
        }
        for (std::int64_t i = 0; i < face_count; ++i) {
            add_face(next_line("face " + std::to_string(i)), static_cast<std::size_t>(i));
        }
        refuse_leftovers();
        faces_.triangulate_into(mesh_);
        return std::move(mesh_);
    }

private:
    /// Returns the counts: what follows the keyword, or the next line.
    std::string read_header() {
        std::string_view line = next_line("the counts");
        const auto [keyword, glued] = keyword_of(take_word(line));
        if (!keyword.ends_with("OFF") || keyword == "4OFF" || keyword == "nOFF") {
            throw Error(file_,
                        to_number(keyword)
                            ? "does not begin with OFF: " + lines_.name() + " holds numbers"
                            : "does not begin with OFF",
                        to_number(keyword) ? "put a line OFF before them"
                                           : "export it as three-dimensional OFF");
        }
        if (trimmed(line) == "BINARY") {
            throw Error(file_, "is binary OFF", "export it as ASCII OFF");
        }
        if (!glued.empty()) {
            return std::string(glued) + std::string(line);
        }
        return std::string(trimmed(line).empty() ? next_line("the counts") : line);
    }

    /// The next line that is not blank, without its comment; nothing at the end.
    std::optional<std::string_view> next_line() {
        while (const auto line = lines_.next()) {
            const std::string_view text = trimmed(line->substr(0, comment_begin(*line)));
            if (!text.empty()) {
                return text;
            }
        }
        return std::nullopt;
    }

    std::string_view next_line(const std::string& wanted) {
        const auto line = next_line();
        if (!line) {
            throw Error(file_, "ends before " + wanted, "copy or export the file again");
        }
        return *line;
    }

    void refuse_leftovers() {
        if (const auto line = next_line()) {
            throw Error(file_,
                        lines_.name() + ": \"" + shortened(*line) +
                            "\" follows the last face that is counted",
                        "correct the numbers of vertices and faces, or export the file again");
        }
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

    void add_face(std::string_view line, std::size_t number) {
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
        faces_.add(corners_, number);
    }

    const std::string& file_;
    Lines lines_;
    PolygonMesh mesh_;
    PolygonList faces_;
    std::vector<std::int64_t> corners_;
};

}  // namespace

PolygonMesh parse_off(std::string_view bytes, const std::string& file) {
    return OffReader(decoded_text(bytes, file), file).read();
}

}  // namespace earshot::io
