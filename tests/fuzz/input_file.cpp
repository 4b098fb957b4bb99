// SPDX-License-Identifier: MIT
#include "fuzz/input_file.h"

#include <cerrno>
#include <fcntl.h>
#include <stdlib.h>
#include <system_error>
#include <unistd.h>

namespace earshot::test {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const fs::path& file) {
    throw std::system_error(errno, std::generic_category(), file.string());
}

fs::path new_folder() {
    for (const fs::path& parent : {fs::path("/dev/shm"), fs::temp_directory_path()}) {
        std::string name = (parent / "earshot-fuzz-XXXXXX").string();
        if (::mkdtemp(name.data()) != nullptr) {
            return name;
        }
    }
    fail(fs::temp_directory_path());
}

}  // namespace

InputFile::InputFile(const std::string& name)
    : path_(new_folder() / name),
      descriptor_(::open(path_.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0644)) {
    if (descriptor_ < 0) {
        fail(path_);
    }
}

InputFile::~InputFile() {
    ::close(descriptor_);
    std::error_code ignored;
    fs::remove_all(path_.parent_path(), ignored);
}

void InputFile::write(std::string_view bytes) {
    if (::ftruncate(descriptor_, 0) != 0) {
        fail(path_);
    }
    for (std::size_t at = 0; at < bytes.size();) {
        const ssize_t written =
            ::pwrite(descriptor_, bytes.data() + at, bytes.size() - at, static_cast<off_t>(at));
        if (written < 0 && errno != EINTR) {
            fail(path_);
        }
        at += written < 0 ? 0 : static_cast<std::size_t>(written);
    }
}

}  // namespace earshot::test
