// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/floating_point.h"

#include <cstddef>
#include <string>
#include <vector>

namespace earshot::io {

/// A name that an option gives, of one of several things of a role.
struct NameChoice {
    std::string role{};    ///< source or listener
    std::string option{};  ///< that gives the name
    std::string name{};    ///< empty: of the only one
};

/// The index of the chosen one of the names that `file` has. Throws Error naming the file if there
/// is none, or if none is chosen of several. Precondition: there is a name.
std::size_t find_name(const std::string& file,
                      const std::vector<std::string>& names,
                      const NameChoice& choice);

}  // namespace earshot::io
