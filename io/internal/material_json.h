// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/propagation/scene.h"

#include <nlohmann/json.hpp>

namespace earshot::io {

/// Acoustic data as `extras.acoustics` of a glTF material and as a value of a SCENE.materials.json:
/// what is 0 or false by default stands there only where it is not.
nlohmann::ordered_json material_json(const propagation::Material& material);

}  // namespace earshot::io
