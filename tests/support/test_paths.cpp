// SPDX-License-Identifier: MIT
#include "support/test_paths.h"

namespace earshot::test {

std::filesystem::path source_file(std::string_view relative) {
    return std::filesystem::path(EARSHOT_SOURCE_DIR) / relative;
}

std::filesystem::path shared_file(std::string_view relative) {
    return std::filesystem::path(EARSHOT_SHARED_DIR) / relative;
}

}  // namespace earshot::test
