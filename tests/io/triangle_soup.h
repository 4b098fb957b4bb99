// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/error.h"
#include "earshot/io/scene_file.h"

#include "support/temporary_folder.h"
#include <algorithm>
#include <array>
#include <string>
#include <vector>

namespace earshot::io {

/// The corners of every triangle.
using Soup = std::vector<std::array<geometry::Vec3, 3>>;

inline Soup soup_of(const propagation::Scene& scene, double time = 0.0) {
    const std::vector<geometry::Vec3> positions = scene.mesh.positions_at(time);
    Soup soup;
    for (const geometry::Triangle& t : scene.mesh.triangles()) {
        soup.push_back({positions[t[0]], positions[t[1]], positions[t[2]]});
    }
    return soup;
}

/// Each triangle rotated to begin with its smallest corner, all in order: equal for equal surfaces.
inline Soup canonical(Soup soup) {
    const auto less = [](const geometry::Vec3& a, const geometry::Vec3& b) {
        return std::array{a.x, a.y, a.z} < std::array{b.x, b.y, b.z};
    };
    for (auto& t : soup) {
        std::rotate(t.begin(), std::min_element(t.begin(), t.end(), less), t.end());
    }
    std::sort(soup.begin(), soup.end(), [&](const auto& a, const auto& b) {
        return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end(), less);
    });
    return soup;
}

/// What a file becomes.
struct ReadSoup {
    Soup soup;
    std::string warnings;  ///< of geometry, one after another
    std::string error;
};

/// Reads a file of that name and content, at an instant.
inline ReadSoup read_soup(const std::string& name, const std::string& bytes, double time = 0.0) {
    const test::TemporaryFolder folder;
    ReadSoup result;
    try {
        const LoadedScene loaded = load_scene(folder.file(name, bytes));
        result.soup = soup_of(loaded.scene, time);
        for (const Warning& warning : loaded.warnings) {
            const bool is_acoustic = warning.what.find("acoustic") != std::string::npos;
            result.warnings += is_acoustic ? "" : warning.what + "\n";
        }
    } catch (const Error& error) {
        result.error = error.line();
    }
    return result;
}

}  // namespace earshot::io
