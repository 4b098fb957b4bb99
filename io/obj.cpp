// SPDX-License-Identifier: MIT
#include "earshot/base/error.h"
#include "earshot/io/internal/obj_groups.h"
#include "earshot/io/internal/polygons.h"
#include "earshot/io/internal/text.h"

#include <map>

namespace earshot::io {
namespace {

/// Reads Wavefront OBJ: vertices, faces, groups and the names of materials. Everything else
/// concerns appearance.
class ObjReader {
public:
    explicit ObjReader(const std::string& file) : file_(file) {}

    PolygonMesh read(std::string_view text) {
        Lines lines(text);
        while (const auto line = lines.next()) {
            std::string_view rest = joined(*line, lines);
            const std::string_view keyword = take_word(rest);
            if (keyword == "v") {
                add_vertex(rest, lines.name());
            } else if (keyword == "f") {
                add_face(rest, lines.name());
            } else if (keyword == "usemtl") {
                use_material(trimmed(rest));
            } else if (keyword == "o") {
                groups_.begin_object(trimmed(rest));
            } else if (keyword == "g") {
                groups_.begin_group(trimmed(rest));
            }
        }
        mesh_.mesh_names = groups_.names();
        const std::vector<std::uint32_t> meshes = groups_.mesh_of_face();
        for (std::size_t face = 0; face < meshes.size(); ++face) {
            mesh_.mesh_of_triangle.insert(
                mesh_.mesh_of_triangle.end(), triangles_of_face_[face], meshes[face]);
        }
        return std::move(mesh_);
    }

private:
    /// A line that ends in a backslash goes on in the next one.
    std::string_view joined(std::string_view line, Lines& lines) {
        if (!line.ends_with('\\')) {
            return line;
        }
        long_line_.assign(line.substr(0, line.size() - 1));
        while (const auto more = lines.next()) {
            const bool goes_on = more->ends_with('\\');
            long_line_ += ' ';
            long_line_ += more->substr(0, more->size() - (goes_on ? 1 : 0));
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

    void add_face(std::string_view rest, const std::string& where) {
        corners_.clear();
        for (auto word = take_word(rest); !word.empty(); word = take_word(rest)) {
            if (word.starts_with('#')) {
                break;
            }
            corners_.push_back(corner(word.substr(0, word.find('/')), where));
        }
        const std::size_t before = mesh_.mesh.triangles.size();
        add_polygon(mesh_, corners_, file_, where);
        if (const std::size_t count = mesh_.mesh.triangles.size() - before; count > 0) {
            groups_.add_face(corners_);
            triangles_of_face_.push_back(count);
        }
        if (current_ < 0 && mesh_.material_of_triangle.size() < mesh_.mesh.triangles.size()) {
            use_material("default");
        }
        mesh_.material_of_triangle.resize(mesh_.mesh.triangles.size(),
                                          static_cast<std::uint32_t>(current_));
    }

    /// OBJ counts vertices from 1, and from -1 back from the latest.
    std::int64_t corner(std::string_view word, const std::string& where) const {
        const auto number = to_integer(word);
        const auto count = static_cast<std::int64_t>(mesh_.mesh.positions.size());
        if (!number || *number == 0 || *number > count || *number < -count) {
            throw Error(file_,
                        where + ": vertex index " + std::string(word.substr(0, 24)) +
                            " is not in 1.." + std::to_string(count),
                        "export the file again");
        }
        return *number > 0 ? *number - 1 : count + *number;
    }

    void use_material(std::string_view name) {
        const auto next = static_cast<std::int64_t>(material_index_.size());
        const auto [place, is_new] = material_index_.emplace(name, next);
        if (is_new) {
            mesh_.material_names.emplace_back(name);
        }
        current_ = place->second;
    }

    const std::string& file_;
    PolygonMesh mesh_;
    ObjGroups groups_;
    std::vector<std::size_t> triangles_of_face_;
    std::map<std::string, std::int64_t, std::less<>> material_index_;
    std::int64_t current_ = -1;  // no usemtl yet
    std::vector<std::int64_t> corners_;
    std::string long_line_;
};

}  // namespace

PolygonMesh parse_obj(std::string_view text, const std::string& file) {
    return ObjReader(file).read(text);
}

}  // namespace earshot::io
