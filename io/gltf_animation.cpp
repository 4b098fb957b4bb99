// SPDX-License-Identifier: MIT
#include "earshot/io/internal/gltf_accessor.h"
#include "earshot/io/internal/gltf_scene.h"
#include "earshot/io/scene_file.h"

#include <glm/gtc/quaternion.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <charconv>
#include <cmath>

namespace earshot::io {
namespace {

using geometry::Interpolation;
using geometry::Track;

/// The animation asked for; -1 if none is and the file has none.
int chosen_animation(const GltfFile& file, const std::string& wanted) {
    const std::vector<tinygltf::Animation>& animations = file.model.animations;
    if (wanted.empty()) {
        return animations.empty() ? -1 : 0;
    }
    std::string names;
    for (std::size_t i = 0; i < animations.size(); ++i) {
        if (animations[i].name == wanted) {
            return static_cast<int>(i);
        }
        names += (i == 0 ? "" : ", ") + animations[i].name;
    }
    std::size_t number = 0;
    const char* end = wanted.data() + wanted.size();
    const auto [stop, code] = std::from_chars(wanted.data(), end, number);
    if (code == std::errc() && stop == end && number < animations.size()) {
        return static_cast<int>(number);
    }
    throw Error(file.name,
                "has no animation \"" + wanted + "\"",
                animations.empty() ? "it has none at all" : "it has: " + names);
}

Interpolation interpolation_of(const GltfFile& file,
                               const std::string& element,
                               const std::string& name) {
    if (name == "STEP") {
        return Interpolation::step;
    }
    if (name == "CUBICSPLINE") {
        return Interpolation::cubic_spline;
    }
    if (!name.empty() && name != "LINEAR") {
        file.fail(element, "its interpolation is " + condensed(name));
    }
    return Interpolation::linear;
}

/// `components` of the output accessor's elements, `width` numbers per key.
Track read_track(const GltfFile& file,
                 const std::string& element,
                 const tinygltf::AnimationSampler& sampler,
                 std::size_t components,
                 std::size_t width) {
    Track track;
    track.interpolation = interpolation_of(file, element, sampler.interpolation);
    track.times = accessor_numbers(file, sampler.input, 1);
    track.values = accessor_numbers(file, sampler.output, components);
    const std::size_t per_key =
        width * (track.interpolation == Interpolation::cubic_spline ? 3U : 1U);
    if (track.times.empty()) {
        file.fail(element, "it has no key times");
    }
    if (track.values.size() != track.times.size() * per_key) {
        file.fail(element,
                  std::to_string(track.values.size()) + " output numbers do not fit " +
                      std::to_string(track.times.size()) + " key times of " +
                      std::to_string(per_key));
    }
    const bool is_ascending =
        std::adjacent_find(track.times.begin(), track.times.end(), std::greater_equal<>()) ==
        track.times.end();
    if (!is_ascending || track.times.front() < 0.0) {
        file.fail(element, "its key times are not strictly ascending from 0");
    }
    const bool is_large = std::any_of(track.values.begin(), track.values.end(), [](double value) {
        return std::abs(value) > kMaxCoordinate;
    });
    if (is_large) {
        file.fail(element, "a key value lies beyond 1e12");
    }
    return track;
}

/// A matrix can only be animated through its parts (it has no shear, as glTF demands of one).
void decompose(const GltfFile& file, const std::string& element, geometry::Node& node) {
    if (!node.matrix) {
        return;
    }
    const glm::dmat3 linear(*node.matrix);
    geometry::Transform parts;
    parts.translation = geometry::Vec3((*node.matrix)[3]);
    for (int axis = 0; axis < 3; ++axis) {
        parts.scale[axis] = std::sqrt(glm::dot(linear[axis], linear[axis]));
        if (!(parts.scale[axis] > 0.0)) {
            file.fail(element, "the matrix of its node cannot be animated: a scale is 0");
        }
    }
    if (glm::determinant(linear) < 0.0) {
        parts.scale.x = -parts.scale.x;
    }
    const glm::dmat3 turn(
        linear[0] / parts.scale.x, linear[1] / parts.scale.y, linear[2] / parts.scale.z);
    parts.rotation = glm::normalize(glm::quat_cast(turn));
    node.rest = parts;
    node.matrix.reset();
}

std::size_t morph_target_count(const GltfFile& file, std::size_t node) {
    const int mesh = file.model.nodes[node].mesh;
    if (mesh < 0 || file.model.meshes[static_cast<std::size_t>(mesh)].primitives.empty()) {
        return 0;
    }
    return file.model.meshes[static_cast<std::size_t>(mesh)].primitives.front().targets.size();
}

class ChannelReader {
public:
    ChannelReader(const GltfFile& file, GltfNodes& nodes, Warnings& warnings)
        : file_(file), nodes_(nodes), warnings_(warnings) {}

    void read(const tinygltf::AnimationChannel& channel,
              const tinygltf::AnimationSampler& sampler,
              const std::string& element) {
        const auto index = static_cast<std::size_t>(channel.target_node);
        geometry::Node& node = nodes_.nodes[static_cast<std::size_t>(nodes_.index_of[index])];
        if (channel.target_path == "translation") {
            decompose(file_, element, node);
            put(node.translation, read_track(file_, element, sampler, 3, 3), element);
        } else if (channel.target_path == "scale") {
            decompose(file_, element, node);
            put(node.scale, read_track(file_, element, sampler, 3, 3), element);
        } else if (channel.target_path == "rotation") {
            decompose(file_, element, node);
            put(node.rotation, read_track(file_, element, sampler, 4, 4), element);
        } else if (channel.target_path == "weights") {
            const std::size_t targets = morph_target_count(file_, index);
            if (targets == 0) {
                file_.fail(element, "it animates morph weights of a node without morph targets");
            }
            put(nodes_.weight_track[index],
                read_track(file_, element, sampler, 1, targets),
                element);
        } else {
            warnings_.push_back(
                {file_.name,
                 element + ": its path " + condensed(channel.target_path) + " moves no geometry"});
        }
    }

private:
    void put(Track& place, Track track, const std::string& element) const {
        if (!place.is_empty()) {
            file_.fail(element, "another channel animates the same property of its node");
        }
        place = std::move(track);
    }

    const GltfFile& file_;
    GltfNodes& nodes_;
    Warnings& warnings_;
};

}  // namespace

void read_animation(const GltfFile& file,
                    const std::string& wanted,
                    GltfNodes& nodes,
                    Warnings& warnings) {
    const int chosen = chosen_animation(file, wanted);
    if (chosen < 0) {
        return;
    }
    const tinygltf::Animation& animation = file.model.animations[static_cast<std::size_t>(chosen)];
    ChannelReader reader(file, nodes, warnings);
    for (std::size_t i = 0; i < animation.channels.size(); ++i) {
        const tinygltf::AnimationChannel& channel = animation.channels[i];
        if (channel.target_node >= 0) {
            reader.read(channel,
                        animation.samplers[static_cast<std::size_t>(channel.sampler)],
                        "animation " + std::to_string(chosen) + " channel " + std::to_string(i));
        }
    }
}

}  // namespace earshot::io
