// SPDX-License-Identifier: MIT
#include "earshot/io/internal/descriptor.h"

#include <cerrno>
#include <cstddef>
#include <unistd.h>

namespace earshot::io {

bool write_all(int descriptor, std::string_view bytes) {
    while (!bytes.empty()) {
        const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
        if (written < 0 && errno == EINTR) {
            continue;
        }
        if (written < 0) {
            return false;
        }
        bytes.remove_prefix(static_cast<std::size_t>(written));
    }
    return true;
}

}  // namespace earshot::io
