// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/bvh/deformable_bvh.h"
#include "earshot/geometry/types.h"
#include "earshot/io/svg.h"
#include "earshot/propagation/pair_result.h"
#include "earshot/propagation/scene.h"
#include "earshot/visibility/label_layout.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace earshot::io {

/// How a scene is projected to a picture.
enum class Projection {
    /// Straight down from a horizontal cut just above the highest source or listener, +X to the
    /// right, -Z to the top. What the cut meets is drawn bold.
    plan,
    /// From above, from the right and the front. Triangles whose back shows are absent, so that a
    /// room is seen into through its near walls and its ceiling.
    isometric
};

struct ScenePictureOptions {
    Projection projection = Projection::plan;
    /// Colours of the lines, one per material of the scene; an empty one leaves the material out.
    /// No colours: all materials are grey.
    std::vector<std::string> colours{};
    std::size_t max_reflectors = 6;  ///< that are labelled
};

/// A picture with what its labels were placed by.
struct ScenePicture {
    std::string svg;
    /// The labelled objects: sources, listeners, reflectors.
    std::vector<visibility::LabelledObject> objects;
    visibility::IdImage image;
    visibility::LabelOptions label_options;
    visibility::LabelLayout layout;
};

/// Line drawings of a scene at instants of its animation, with labels of its sources, its listeners
/// and its first reflectors: the surfaces of those first-order reflections of `pairs` that arrive
/// earliest after the direct sound, over all instants. A label names the reflector's material and
/// tells that delay. Of more than 60 sources and listeners the others are marked only. All pictures
/// have one scale, and labels move as little as they can.
class ScenePictures {
public:
    /// `pairs` are results at `times` (seconds, at least one). The scene must outlive the object.
    /// Precondition: indices of pairs, paths and colours are those of the scene.
    ScenePictures(const propagation::Scene& scene,
                  std::vector<double> times,
                  std::span<const propagation::PairResult> pairs,
                  ScenePictureOptions options = {},
                  Executor& executor = Executor::serial());
    ~ScenePictures();
    ScenePictures(ScenePictures&&) noexcept;
    ScenePictures& operator=(ScenePictures&&) noexcept;

    /// The picture at times[frame]. Labels stay near those of the picture that was drawn before.
    /// Precondition: frame < times.size().
    ScenePicture draw(std::size_t frame, Executor& executor = Executor::serial());

private:
    class Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace earshot::io
