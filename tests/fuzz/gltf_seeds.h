// SPDX-License-Identifier: MIT
#pragma once

#include "support/gltf_builder.h"
#include <string>
#include <vector>

namespace earshot::test {

struct GltfSeed {
    std::string name;  ///< without a suffix
    GltfBuilder builder;
};

/// Small glTF scenes that together use every part of the format that the reader knows.
std::vector<GltfSeed> gltf_seeds();

}  // namespace earshot::test
