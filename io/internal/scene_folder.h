// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace earshot::io {

/// The folder of a scene's real path, and the files that the scene names in it. What a scene names
/// comes from whoever made it, so nothing outside of the folder is looked at unless that is
/// allowed.
class SceneFolder {
public:
    SceneFolder(const std::filesystem::path& scene_file, bool allow_outside);

    /// The regular file of that name relative to the folder, as a real path; nothing if there is
    /// none. Throws Error naming `subject` if the file lies outside of the folder: by `..`, as an
    /// absolute path or through a link; the same whether or not it exists.
    std::optional<std::filesystem::path> find(const std::filesystem::path& name,
                                              const std::string& subject) const;

private:
    std::filesystem::path folder_;  ///< canonical
    bool allow_outside_;
};

}  // namespace earshot::io
