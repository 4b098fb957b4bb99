// SPDX-License-Identifier: MIT
#include "earshot/base/error.h"
#include "earshot/io/internal/polygons.h"
#include "earshot/io/internal/text.h"

#include <algorithm>
#include <array>
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

/// Of a word in lower case.
std::size_t find_ignoring_case(std::string_view text, std::string_view word) {
    const auto lower = [](char c) {
        return static_cast<char>(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c);
    };
    const auto* found =
        std::search(text.begin(), text.end(), word.begin(), word.end(), [&](char a, char b) {
            return lower(a) == b;
        });
    return found == text.end() ? std::string_view::npos
                               : static_cast<std::size_t>(found - text.begin());
}

std::size_t claimed_triangles(std::string_view bytes) {
    std::uint32_t count = 0;
    std::memcpy(&count, bytes.data() + kHeaderBytes - sizeof count, sizeof count);
    return count;
}

PolygonMesh parse_binary(std::string_view bytes, std::size_t count) {
    PolygonMesh mesh;
    mesh.stated_unit = unit_in_comment(bytes.substr(0, bytes.substr(0, 80).find('\0')));
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

/// Reads ASCII STL word by word, in any case of letters: writers put a facet on seven lines, on
/// one, or a whole file on one. Names of solids run to the end of their line.
class AsciiReader {
public:
    AsciiReader(std::string_view text, const std::string& file) : file_(file), lines_(text) {}

    PolygonMesh read() {
        while (advance()) {
            const std::string keyword = next_keyword();
            if (!is_known(keyword)) {
                leave_out_line(keyword);
                continue;
            }
            is_ended_ = keyword == "endsolid";
            if (keyword == "vertex") {
                add_vertex();
            } else if (keyword == "endloop") {
                end_loop();
            } else if (keyword == "solid" || keyword == "endsolid") {
                skip_name(keyword);
            } else if (keyword == "normal") {
                skip_normal();
            }
        }
        if (!is_ended_) {
            throw Error(
                file_,
                "is truncated: it does not end with endsolid, " + lines_.name() + " is the last",
                "copy or export the file again");
        }
        warn_of_lines_left_out();
        return std::move(mesh_);
    }

private:
    static bool is_known(std::string_view keyword) noexcept {
        constexpr std::array<std::string_view, 9> kKeywords{"solid",
                                                            "facet",
                                                            "normal",
                                                            "outer",
                                                            "loop",
                                                            "vertex",
                                                            "endloop",
                                                            "endfacet",
                                                            "endsolid"};
        return std::find(kKeywords.begin(), kKeywords.end(), keyword) != kKeywords.end();
    }

    /// Goes to the next line that is not blank if this one is used up; false at the end.
    bool advance() {
        // take_word() stops at the first word, where trimmed() would pass all blanks at the end
        // too.
        for (std::string_view ahead = line_; take_word(ahead).empty(); ahead = line_) {
            const auto next = lines_.next();
            if (!next) {
                return false;
            }
            line_ = *next;
        }
        return true;
    }

    std::string_view next_word() { return advance() ? take_word(line_) : std::string_view(); }

    /// `end loop` and `end solid` count as one word.
    std::string next_keyword() {
        std::string keyword = lower_case(next_word());
        if (keyword == "end") {
            keyword += lower_case(next_word());
        }
        return keyword;
    }

    /// A name may hold any word: it ends with its line, or where a facet begins on that line.
    void skip_name(const std::string& keyword) {
        const std::size_t facet = begin_of_facet();
        const std::string_view before_facet = line_.substr(0, facet);
        const std::size_t solid = keyword == "endsolid"
                                      ? find_ignoring_case(before_facet, " solid ")
                                      : std::string_view::npos;
        const std::string_view name = before_facet.substr(0, solid);
        if (keyword == "solid" && !mesh_.stated_unit) {
            mesh_.stated_unit = unit_in_comment(name);
        }
        line_ = facet == std::string_view::npos ? std::string_view() : line_.substr(name.size());
    }

    /// Where the next facet begins on what is left of the line; npos if none does. The place is
    /// kept until the reader is past it: a line may hold many solids before a facet.
    std::size_t begin_of_facet() {
        const std::size_t end = line_number_of_facet_ == lines_.number() ? facet_rest_ : 0;
        if (end == 0 || line_.size() < end) {
            const std::size_t found = find_ignoring_case(line_, " facet normal ");
            if (found == std::string_view::npos) {
                return found;  // the rest of the line is a name, so that nobody asks again
            }
            line_number_of_facet_ = lines_.number();
            facet_rest_ = line_.size() - found;
        }
        return line_.size() - facet_rest_;
    }

    /// What the numbers are does not matter; some writers leave them out or write no numbers.
    void skip_normal() {
        for (int axis = 0; axis < 3; ++axis) {
            std::string_view ahead = line_;
            if (lower_case(take_word(ahead)) == "outer") {
                return;
            }
            take_word(line_);
        }
    }

    void add_vertex() {
        if (corner_count_ == corners_.size()) {
            throw Error(file_,
                        lines_.name() + ": a facet needs three vertices, this is the fourth",
                        "export it as triangles");
        }
        for (int axis = 0; axis < 3; ++axis) {
            const auto number = to_number(take_word(line_));
            if (!number) {
                throw Error(file_,
                            lines_.name() + ": a facet needs three vertices of three numbers",
                            "correct the line");
            }
            corners_[corner_count_][axis] = *number;
        }
        ++corner_count_;
    }

    void end_loop() {
        if (corner_count_ != corners_.size()) {
            throw Error(file_,
                        lines_.name() + ": a facet has " + std::to_string(corner_count_) +
                            " vertices, not three",
                        "export the file again");
        }
        add_triangle(mesh_, corners_);
        corner_count_ = 0;
    }

    /// Such as the colour that some writers put between facets.
    void leave_out_line(const std::string& keyword) {
        if (corner_count_ > 0) {
            throw Error(file_,
                        lines_.name() + ": \"" + shortened(keyword) + "\" stands within a facet",
                        "export the file again");
        }
        first_left_out_ = lines_left_out_++ == 0 ? lines_.name() : first_left_out_;
        line_ = {};
    }

    void warn_of_lines_left_out() {
        if (lines_left_out_ > 0) {
            mesh_.warnings.push_back({file_,
                                      std::to_string(lines_left_out_) +
                                          " lines that STL does not know are left out, the first "
                                          "is " +
                                          first_left_out_});
        }
    }

    const std::string& file_;
    Lines lines_;
    std::string_view line_;  // what is left of the current line
    PolygonMesh mesh_;
    std::array<geometry::Vec3, 3> corners_{};
    std::size_t corner_count_ = 0;
    bool is_ended_ = false;  // by endsolid
    std::size_t lines_left_out_ = 0;
    std::string first_left_out_;
    std::size_t line_number_of_facet_ = 0;  // of the last facet that begin_of_facet() found
    std::size_t facet_rest_ = 0;            // characters from there to the end of the line
};

/// Whether a byte-order mark or the first letter of `solid` in UTF-16 tells a text.
bool begins_with_mark(std::string_view bytes) {
    constexpr std::string_view kLittleEndian("s\0o", 3), kBigEndian("\0s\0o", 4);
    return bytes.starts_with("\xEF\xBB\xBF") || bytes.starts_with("\xFF\xFE") ||
           bytes.starts_with("\xFE\xFF") || bytes.starts_with(kLittleEndian) ||
           bytes.starts_with(kBigEndian);
}

/// Whether bytes are ASCII STL: the first word is `solid`, and no byte is zero.
bool begins_with_solid(std::string_view bytes) {
    Lines lines(bytes);
    auto line = lines.next();
    while (line && trimmed(*line).empty()) {
        line = lines.next();
    }
    return line && lower_case(take_word(*line)) == "solid" &&
           bytes.find('\0') == std::string_view::npos;
}

bool is_ascii_text(std::string_view bytes) {
    return std::all_of(bytes.begin(), bytes.end(), [](char c) {
        const auto code = static_cast<unsigned char>(c);
        return (code >= 0x20 && code < 0x7f) || (code >= 0x09 && code <= 0x0d);
    });
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
    const std::string_view text = begins_with_mark(bytes) ? decoded_text(bytes, file) : bytes;
    if (begins_with_solid(text)) {
        return AsciiReader(text, file).read();
    }
    if (has_count && is_ascii_text(bytes.substr(0, kHeaderBytes))) {
        throw Error(file, "is text that does not begin with solid", "export it as STL");
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
