// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <filesystem>
#include <vector>

namespace earshot::test {

using Point = std::array<double, 3>;

/// The triangles of a glTF file at each of the times, evaluated straight from its JSON and bytes by
/// the rules of glTF 2.0 (sections 3.5 to 3.7, 3.11, appendix C), with reading, matrices and
/// interpolation of its own: it shares no code with earshot. Covers what the reference models use:
/// a default scene, triangle lists, skins, morph targets, linear, step and cubic keys, embedded
/// buffers. Corners are given three by three, in the order of nodes, primitives and indices in the
/// file.
std::vector<std::vector<Point>> evaluate_gltf(const std::filesystem::path& file,
                                              std::size_t animation,
                                              const std::vector<double>& times);

}  // namespace earshot::test
