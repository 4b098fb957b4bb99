// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/scenes/scene_draft.h"

#include <string>

namespace earshot::scenes {

/// An isometric drawing as SVG, io::ScenePictures, with the sources, the listeners and the first
/// reflectors of the scene. What moves is shown at the middle of its key frames.
std::string draw_picture(const SceneDraft& draft);

}  // namespace earshot::scenes
