// SPDX-License-Identifier: MIT
#include "support/earshot_program.h"

#include <cstdlib>

namespace earshot::test {

std::string earshot_program() {
    const char* other = std::getenv("EARSHOT_PROGRAM");
    return other == nullptr ? EARSHOT_PROGRAM : other;
}

}  // namespace earshot::test
