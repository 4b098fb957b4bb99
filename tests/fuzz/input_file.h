// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace earshot::test {

/// A file in a folder of its own whose content changes with every input: readers take a path, and
/// of some the path has a meaning (its suffix, its folder). It lies in /dev/shm, where writing it
/// takes microseconds, or else among the temporary files. It is removed with this object, and so
/// stays where a reader ends the process.
class InputFile {
public:
    explicit InputFile(const std::string& name);
    ~InputFile();
    InputFile(const InputFile&) = delete;
    InputFile& operator=(const InputFile&) = delete;

    const std::filesystem::path& path() const noexcept { return path_; }
    /// Replaces the content.
    void write(std::string_view bytes);

private:
    std::filesystem::path path_;
    int descriptor_ = -1;
};

}  // namespace earshot::test
