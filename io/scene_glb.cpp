// SPDX-License-Identifier: MIT
#include "earshot/io/scene_glb.h"

#include "earshot/io/internal/json_lines.h"
#include "earshot/io/internal/material_json.h"

#include <glm/gtc/quaternion.hpp>
#include <glm/mat3x3.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <vector>

namespace earshot::io {
namespace {

using Json = nlohmann::ordered_json;
using geometry::Vec3;
static_assert(std::endian::native == std::endian::little, "glTF buffers are little-endian");

// glTF 2.0, section 5: names of numbers.
constexpr int kFloat = 5126;
constexpr int kUnsignedInt = 5125;
constexpr int kVertices = 34962;
constexpr int kIndices = 34963;

Json material_of(const propagation::Material& material) {
    return {{"name", material.name}, {"extras", {{"acoustics", material_json(material)}}}};
}

/// Collects the parts of a file.
class GlbWriter {
public:
    explicit GlbWriter(const propagation::Scene& scene)
        : scene_(scene), positions_(scene.mesh.positions_at(0.0)) {}

    std::string write() {
        Json nodes = Json::array();
        Json meshes = Json::array();
        const std::vector<std::string>& names = scene_.mesh.mesh_names();
        for (std::uint32_t mesh = 0; mesh < names.size(); ++mesh) {
            const std::string name = names[mesh].empty() ? "model" : names[mesh];
            const Json primitives = primitives_of_mesh(mesh);
            if (!primitives.empty()) {
                nodes.push_back({{"name", name}, {"mesh", meshes.size()}});
                meshes.push_back({{"name", name}, {"primitives", primitives}});
            }
        }
        for (const propagation::Emitter& source : scene_.sources) {
            nodes.push_back(node_of(source, "source"));
        }
        for (const propagation::Emitter& listener : scene_.listeners) {
            nodes.push_back(node_of(listener, "listener"));
        }
        Json roots = Json::array();
        for (std::size_t i = 0; i < nodes.size(); ++i) {
            roots.push_back(i);
        }
        Json materials = Json::array();
        for (const propagation::Material& material : scene_.materials) {
            materials.push_back(material_of(material));
        }
        const Json document = {{"asset", {{"version", "2.0"}, {"generator", "earshot"}}},
                               {"scene", 0},
                               {"scenes", Json::array({Json{{"nodes", roots}}})},
                               {"nodes", nodes},
                               {"meshes", meshes},
                               {"materials", materials},
                               {"accessors", accessors_},
                               {"bufferViews", views_},
                               {"buffers", Json::array({Json{{"byteLength", buffer_.size()}}})}};
        return framed(json_text(document));
    }

private:
    Json node_of(const propagation::Emitter& emitter, const char* role) const {
        const propagation::Pose pose = scene_.pose_at(emitter, 0.0);
        // A node that is not turned looks along -Z, +X is to its right.
        const glm::dquat turn =
            glm::normalize(glm::quat_cast(glm::dmat3(-pose.left, pose.up, -pose.front)));
        return {{"name", emitter.name},
                {"translation", {pose.position.x, pose.position.y, pose.position.z}},
                {"rotation", {turn.x, turn.y, turn.z, turn.w}},
                {"extras", {{"acoustics", {{"role", role}}}}}};
    }

    template <typename T>
    std::size_t add_view(const std::vector<T>& values, int target) {
        views_.push_back({{"buffer", 0},
                          {"byteOffset", buffer_.size()},
                          {"byteLength", values.size() * sizeof(T)},
                          {"target", target}});
        buffer_.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
        return views_.size() - 1;
    }

    std::size_t add_positions(const std::vector<Vec3>& positions) {
        std::vector<std::array<float, 3>> singles;
        for (const Vec3& p : positions) {
            singles.push_back(
                {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)});
        }
        std::array<float, 3> lower = singles.front();
        std::array<float, 3> upper = singles.front();
        for (const auto& p : singles) {
            for (std::size_t axis = 0; axis < 3; ++axis) {
                lower[axis] = std::min(lower[axis], p[axis]);
                upper[axis] = std::max(upper[axis], p[axis]);
            }
        }
        accessors_.push_back({{"bufferView", add_view(singles, kVertices)},
                              {"componentType", kFloat},
                              {"count", singles.size()},
                              {"type", "VEC3"},
                              {"min", lower},
                              {"max", upper}});
        return accessors_.size() - 1;
    }

    /// A primitive per material, in the order of materials; they share the mesh's own vertices.
    Json primitives_of_mesh(std::uint32_t mesh) {
        std::vector<Vec3> positions;
        std::vector<geometry::VertexId> number(positions_.size());
        for (geometry::VertexId v = 0; v < positions_.size(); ++v) {
            if (scene_.mesh.mesh_of_vertex()[v] == mesh) {
                number[v] = static_cast<geometry::VertexId>(positions.size());
                positions.push_back(positions_[v]);
            }
        }
        std::vector<std::vector<geometry::Triangle>> triangles(scene_.materials.size());
        for (std::size_t t = 0; t < scene_.mesh.triangles().size(); ++t) {
            if (scene_.mesh.mesh_of_triangle()[t] == mesh) {
                const auto& [a, b, c] = scene_.mesh.triangles()[t];
                triangles[scene_.material_of_triangle[t]].push_back(
                    {number[a], number[b], number[c]});
            }
        }
        Json primitives = Json::array();
        if (positions.empty()) {
            return primitives;
        }
        const std::size_t accessor = add_positions(positions);
        for (std::size_t material = 0; material < triangles.size(); ++material) {
            if (triangles[material].empty()) {
                continue;
            }
            accessors_.push_back({{"bufferView", add_view(triangles[material], kIndices)},
                                  {"componentType", kUnsignedInt},
                                  {"count", 3 * triangles[material].size()},
                                  {"type", "SCALAR"}});
            primitives.push_back({{"attributes", {{"POSITION", accessor}}},
                                  {"indices", accessors_.size() - 1},
                                  {"material", material}});
        }
        return primitives;
    }

    /// glTF 2.0, section 4.4: header, JSON chunk, binary chunk.
    std::string framed(std::string json) const {
        json.resize((json.size() + 3) / 4 * 4, ' ');
        std::string file = "glTF";
        const auto number = [&](std::size_t value) {
            const auto word = static_cast<std::uint32_t>(value);
            file.append(reinterpret_cast<const char*>(&word), sizeof word);
        };
        number(2);
        number(12 + 8 + json.size() + 8 + buffer_.size());
        number(json.size());
        file += "JSON" + json;
        number(buffer_.size());
        file += std::string("BIN\0", 4) + buffer_;
        return file;
    }

    const propagation::Scene& scene_;
    std::vector<Vec3> positions_;
    std::string buffer_;  // of numbers of four bytes: always aligned
    Json accessors_ = Json::array();
    Json views_ = Json::array();
};

}  // namespace

std::string encode_glb(const propagation::Scene& scene) {
    return GlbWriter(scene).write();
}

}  // namespace earshot::io
