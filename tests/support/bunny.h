// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/mesh.h"

#include "support/test_paths.h"
#include <fstream>
#include <iostream>
#include <sstream>
#include <string>

namespace earshot::test {

/// The Stanford bunny (Turk and Levoy 1994), a scanned mesh with holes; no triangles, and a line on
/// standard output, where the third-party meshes are absent.
inline geometry::Mesh stanford_bunny() {
    const std::string path = test::shared_file("models/stanford-bunny.obj").string();
    geometry::Mesh mesh;
    std::ifstream file(path);
    if (!file) {
        std::cout << "skipped: " << path << " is not there\n";
    }
    for (std::string line; std::getline(file, line);) {
        std::istringstream words(line);
        std::string kind;
        words >> kind;
        if (kind == "v") {
            geometry::Vec3& position = mesh.positions.emplace_back();
            words >> position.x >> position.y >> position.z;
        } else if (kind == "f") {
            geometry::Triangle& triangle = mesh.triangles.emplace_back();
            for (geometry::VertexId& vertex : triangle) {
                std::string corner;  // a vertex, and perhaps a normal behind slashes
                words >> corner;
                vertex = static_cast<geometry::VertexId>(std::stoul(corner) - 1);
            }
        }
    }
    return mesh;
}

}  // namespace earshot::test
