// SPDX-License-Identifier: MIT
#include "earshot/io/whole_file.h"

#include "earshot/base/error.h"
#include "earshot/io/internal/descriptor.h"

#include <cerrno>
#include <fcntl.h>
#include <sys/stat.h>
#include <system_error>
#include <unistd.h>

namespace earshot::io {
namespace {

namespace fs = std::filesystem;

std::string reason(int code) {
    return std::generic_category().message(code);
}

/// An open file descriptor.
class Descriptor {
public:
    explicit Descriptor(int number) : number_(number) {}
    ~Descriptor() {
        if (number_ >= 0) {
            ::close(number_);
        }
    }
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;

    int number() const noexcept { return number_; }

    /// False, with errno set, if the system reports a late write error.
    bool close() noexcept {
        const int number = number_;
        number_ = -1;
        return ::close(number) == 0;
    }

private:
    int number_;
};

[[noreturn]] void throw_cannot_write(const fs::path& file, int code) {
    const fs::path folder = file.parent_path();
    std::string remedy = "choose a place that can be written to";
    if (code == ENOENT || code == ENOTDIR) {
        remedy = "make the directory " + (folder.empty() ? "." : folder.string()) + " first";
    } else if (code == ENOSPC || code == EDQUOT) {
        remedy = "free space on the disk";
    }
    throw Error(file.string(), "cannot be written: " + reason(code), remedy);
}

void require_no_directory(const fs::path& file) {
    std::error_code failure;
    if (file.filename().empty() || fs::is_directory(file, failure)) {
        throw Error(file.string(), "is a directory, not a file", "name a file in it");
    }
}

/// Creates a file with a name of its own beside `file`; its name is left in `name`.
int open_beside(const fs::path& file, std::string& name) {
    for (unsigned attempt = 0;; ++attempt) {
        name = file.string() + ".partial-" + std::to_string(::getpid()) + "-" +
               std::to_string(attempt);
        const int descriptor = ::open(name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        if (descriptor >= 0) {
            return descriptor;
        }
        if (errno != EEXIST) {
            throw_cannot_write(file, errno);
        }
    }
}

}  // namespace

void require_writable(const fs::path& file) {
    require_no_directory(file);
    std::string temporary;
    const Descriptor descriptor(open_beside(file, temporary));
    ::unlink(temporary.c_str());
}

void write_whole_file(const fs::path& file, const std::function<void(const ByteSink&)>& write) {
    require_no_directory(file);
    std::string temporary;
    Descriptor descriptor(open_beside(file, temporary));
    int code = 0;
    try {
        write([&](std::string_view bytes) {
            if (code == 0 && !write_all(descriptor.number(), bytes)) {
                code = errno;
            }
        });
    } catch (...) {
        ::unlink(temporary.c_str());
        throw;
    }
    if (!descriptor.close() && code == 0) {
        code = errno;
    }
    if (code == 0 && ::rename(temporary.c_str(), file.c_str()) != 0) {
        code = errno;
    }
    if (code != 0) {
        ::unlink(temporary.c_str());
        throw_cannot_write(file, code);
    }
}

void write_whole_file(const fs::path& file, std::string_view bytes) {
    write_whole_file(file, [&](const ByteSink& sink) { sink(bytes); });
}

std::string read_whole_file(const fs::path& file) {
    const Descriptor descriptor(::open(file.c_str(), O_RDONLY | O_CLOEXEC));
    if (descriptor.number() < 0) {
        const int code = errno;
        throw Error(file.string(),
                    code == ENOENT ? "no such file" : "cannot be read: " + reason(code),
                    code == ENOENT ? "check the name and the directory" : "check its permissions");
    }
    struct stat status {};
    if (::fstat(descriptor.number(), &status) == 0 && S_ISDIR(status.st_mode)) {
        throw Error(file.string(), "is a directory, not a file", "name a file in it");
    }
    constexpr std::size_t kStep = 1U << 20U;  // bytes asked for at a time past the known size
    std::string bytes(static_cast<std::size_t>(status.st_size) + 1, '\0');
    std::size_t size = 0;
    while (true) {
        const ssize_t got = ::read(descriptor.number(), bytes.data() + size, bytes.size() - size);
        if (got < 0 && errno == EINTR) {
            continue;
        }
        if (got < 0) {
            throw Error(file.string(), "cannot be read: " + reason(errno), "check the disk");
        }
        if (got == 0) {
            bytes.resize(size);
            return bytes;
        }
        size += static_cast<std::size_t>(got);
        if (size == bytes.size()) {
            bytes.resize(size + kStep);
        }
    }
}

}  // namespace earshot::io
