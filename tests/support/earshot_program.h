// SPDX-License-Identifier: MIT
#pragma once

#include <string>

namespace earshot::test {

/// The path of the earshot program of this build, or of the one that the environment names.
std::string earshot_program();

}  // namespace earshot::test
