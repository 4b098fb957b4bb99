// SPDX-License-Identifier: MIT
#pragma once

#include <string>

namespace earshot::test {

// Files whose lengths, counts or checksums have been made to fit their other bytes. What is too
// short to hold them stays as it is.

std::string repair_glb(std::string bytes);           ///< of the file and its chunks
std::string repair_stl(std::string bytes);           ///< triangles of a binary file
std::string repair_visible_sets(std::string bytes);  ///< the checksum
std::string repair_wav(std::string bytes);           ///< of the RIFF container

}  // namespace earshot::test
