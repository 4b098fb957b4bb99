// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/scenes/scene_draft.h"

#include <string>

namespace earshot::scenes {

/// An isometric drawing as SVG: the edges of all faces that look towards the viewer, as far as no
/// other such face hides them, so that a room is seen into through its near walls and its ceiling.
/// Sources are red dots, listeners blue ones. What moves is shown at the middle of its key frames.
std::string draw_picture(const SceneDraft& draft);

}  // namespace earshot::scenes
