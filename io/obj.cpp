// SPDX-License-Identifier: MIT
#include "earshot/base/error.h"
#include "earshot/io/internal/obj_groups.h"
#include "earshot/io/internal/polygons.h"
#include "earshot/io/internal/text.h"

#include <algorithm>
#include <map>

namespace earshot::io {
namespace {

/// Reads Wavefront OBJ: vertices, faces, groups and the names of materials. Everything else
/// concerns appearance or free-form surfaces.
class ObjReader {
public:
    explicit ObjReader(const std::string& file) : file_(file), faces_("line", file) {}

    PolygonMesh read(std::string_view text) {
        Lines lines(text);
        while (const auto line = lines.next()) {
            std::string_view rest = joined(*line, lines);
            const std::string_view keyword = take_word(rest);
            if (keyword == "v") {
                add_vertex(rest, lines.name());
            } else if (keyword == "f" || keyword == "fo") {  // fo: the older word for f
                add_face(rest, lines);
            } else if (keyword == "usemtl") {
                use_material(trimmed(rest));
            } else if (keyword == "o") {
                groups_.begin_object(trimmed(rest));
            } else if (keyword == "g") {
                groups_.begin_group(trimmed(rest));
            } else if (keyword == "surf") {
                first_surface_ = surface_count_++ == 0 ? lines.number() : first_surface_;
            } else if (keyword.starts_with('#') && !mesh_.stated_unit) {
                mesh_.stated_unit = unit_in_comment(*line);
            }
        }
        return finished();
    }

private:
    /// A line that ends in a backslash, blanks after it or not, goes on in the next one; a comment
    /// ends with its line.
    std::string_view joined(std::string_view line, Lines& lines) {
        if (!trimmed(line).ends_with('\\') || trimmed(line).starts_with('#')) {
            return line;
        }
        long_line_.clear();
        for (std::optional more = line; more; more = lines.next()) {
            std::string_view part = trimmed(*more);
            const bool goes_on = part.ends_with('\\');
            part.remove_suffix(goes_on ? 1 : 0);
            long_line_ += part;
            long_line_ += ' ';
            if (!goes_on) {
                break;
            }
        }
        return long_line_;
    }

    void add_vertex(std::string_view rest, const std::string& where) {
        geometry::Vec3 position(0.0);
        for (int axis = 0; axis < 3; ++axis) {
            const auto number = to_number(take_word(rest));
            if (!number) {
                throw Error(file_, where + ": a vertex needs three numbers", "correct the line");
            }
            position[axis] = *number;
        }
        mesh_.mesh.positions.push_back(position);
    }

    void add_face(std::string_view rest, const Lines& lines) {
        corners_.clear();
        for (auto word = take_word(rest); !word.empty(); word = take_word(rest)) {
            if (word.starts_with('#')) {
                break;
            }
            corners_.push_back(corner(word.substr(0, word.find('/')), lines));
        }
        if (!faces_.add(corners_, lines.number())) {
            return;
        }
        if (current_ < 0) {
            use_material("default");
        }
        material_of_face_.push_back(static_cast<std::uint32_t>(current_));
        groups_.add_face();
    }

    /// OBJ counts vertices from 1, and from -1 back from the latest. An index that no vertex has
    /// yet is checked when all are known.
    std::int64_t corner(std::string_view word, const Lines& lines) {
        const auto number = to_integer(word);
        const auto count = static_cast<std::int64_t>(mesh_.mesh.positions.size());
        if (!number || *number == 0 || *number < -count) {
            fail_index(shortened(word), lines.name());
        }
        if (*number > largest_index_) {
            largest_index_ = *number;
            line_of_largest_ = lines.name();
        }
        return *number > 0 ? *number - 1 : count + *number;
    }

    [[noreturn]] void fail_index(const std::string& index, const std::string& where) const {
        throw Error(file_,
                    where + ": vertex index " + index + " is not in 1.." +
                        std::to_string(mesh_.mesh.positions.size()),
                    "export the file again");
    }

    void use_material(std::string_view name) {
        const auto next = static_cast<std::int64_t>(material_index_.size());
        const auto [place, is_new] = material_index_.emplace(name, next);
        if (is_new) {
            mesh_.material_names.emplace_back(name);
        }
        current_ = place->second;
    }

    PolygonMesh finished() {
        if (largest_index_ > static_cast<std::int64_t>(mesh_.mesh.positions.size())) {
            fail_index(std::to_string(largest_index_), line_of_largest_);
        }
        const std::vector<std::uint32_t> counts = faces_.triangulate_into(mesh_);
        for (std::size_t face = 0; face < counts.size(); ++face) {
            mesh_.material_of_triangle.insert(
                mesh_.material_of_triangle.end(), counts[face], material_of_face_[face]);
            groups_.join_at_vertices(face, faces_.corners(face));
        }
        mesh_.mesh_names = groups_.names();
        const std::vector<std::uint32_t> meshes = groups_.mesh_of_face();
        for (std::size_t face = 0; face < meshes.size(); ++face) {
            mesh_.mesh_of_triangle.insert(mesh_.mesh_of_triangle.end(), counts[face], meshes[face]);
        }
        if (surface_count_ > 0) {
            mesh_.warnings.push_back({file_,
                                      std::to_string(surface_count_) +
                                          " free-form surfaces are left out, the first at line " +
                                          std::to_string(first_surface_) +
                                          "; export them as polygons"});
        }
        return std::move(mesh_);
    }

    const std::string& file_;
    PolygonMesh mesh_;
    PolygonList faces_;
    ObjGroups groups_;
    std::vector<std::uint32_t> material_of_face_;
    std::map<std::string, std::int64_t, std::less<>> material_index_;
    std::int64_t current_ = -1;  // no usemtl yet
    std::int64_t largest_index_ = 0;
    std::string line_of_largest_;
    std::size_t surface_count_ = 0, first_surface_ = 0;
    std::vector<std::int64_t> corners_;
    std::string long_line_;
};

}  // namespace

PolygonMesh parse_obj(std::string_view bytes, const std::string& file) {
    return ObjReader(file).read(decoded_text(bytes, file));
}

}  // namespace earshot::io
