// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/floating_point.h"
#include "earshot/propagation/path_frames.h"

#include <filesystem>
#include <string>
#include <vector>

namespace earshot::io {

/// The paths of a source and a listener, by their names.
struct PairPathFrames {
    std::string source{}, listener{};
    propagation::PathFrames frames{};
};

/// Reads a paths.json, pairs in the order in which the file has them first, the instants of each in
/// order of time. Materials, directions, lengths and delays are left out: points tell all but the
/// first. Of a diffracted path, whose parts the file does not tell, the pressure is taken as that
/// of one. Throws Error naming the file if it is not what `earshot ir` writes, and for paths round
/// more than one edge.
std::vector<PairPathFrames> read_path_frames(const std::filesystem::path& file);

}  // namespace earshot::io
