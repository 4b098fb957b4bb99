// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <string_view>

namespace earshot::test {

/// A file of the project, `relative` to its root.
std::filesystem::path source_file(std::string_view relative);

/// A file of the third-party meshes and queries, which may be absent: `relative` to their folder.
std::filesystem::path shared_file(std::string_view relative);

}  // namespace earshot::test
