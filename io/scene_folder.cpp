// SPDX-License-Identifier: MIT
#include "earshot/io/internal/scene_folder.h"

#include "earshot/base/error.h"
#include "earshot/io/internal/text.h"

#include <algorithm>
#include <system_error>

namespace earshot::io {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const fs::path& name, const std::string& how, const std::string& subject) {
    throw Error(
        subject,
        "its file " + shortened(name.string()) + " lies outside of the scene's folder" + how,
        "put it into the folder, or give --allow-outside if the scene is to be trusted");
}

/// Whether a path that begins at the folder never climbs above it.
bool stays_below(const fs::path& name) {
    int depth = 0;
    for (const fs::path& part : name) {
        depth += part == ".." ? -1 : (part.empty() || part == "." ? 0 : 1);
        if (depth < 0) {
            return false;
        }
    }
    return true;
}

bool is_within(const fs::path& file, const fs::path& folder) {
    const auto [folder_part, file_part] =
        std::mismatch(folder.begin(), folder.end(), file.begin(), file.end());
    return folder_part == folder.end();
}

}  // namespace

SceneFolder::SceneFolder(const fs::path& scene_file, bool allow_outside)
    : allow_outside_(allow_outside) {
    std::error_code failure;
    const fs::path real = fs::canonical(scene_file, failure);
    folder_ = failure ? fs::absolute(scene_file).parent_path() : real.parent_path();
}

std::optional<fs::path> SceneFolder::find(const fs::path& name, const std::string& subject) const {
    if (name.native().find('\0') != std::string::npos) {
        throw Error(subject, "the name of its file holds a zero byte", "export the scene again");
    }
    if (!allow_outside_ && name.is_absolute()) {
        refuse(name, "", subject);
    }
    if (!allow_outside_ && !stays_below(name)) {
        refuse(name, "", subject);
    }
    std::error_code failure;
    const fs::path real = fs::canonical(folder_ / name, failure);
    if (failure) {
        return std::nullopt;
    }
    if (!allow_outside_ && !is_within(real, folder_)) {
        refuse(name, ", where a link leads", subject);
    }
    return fs::is_regular_file(real, failure) ? std::optional(real) : std::nullopt;
}

}  // namespace earshot::io
