// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/floating_point.h"
#include "earshot/propagation/path_frames.h"

#include <filesystem>
#include <span>
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

/// A pair that is looked for: names, empty where there is one source or listener alone, and what
/// they are given by, for errors.
struct PairNames {
    std::string source{}, listener{};
    std::string source_option = "source", listener_option = "listener";
};

/// The paths of that pair. Throws Error if there is none. Precondition: `pairs` are those of a
/// file.
const propagation::PathFrames& frames_of_pair(std::span<const PairPathFrames> pairs,
                                              const PairNames& names);

}  // namespace earshot::io
