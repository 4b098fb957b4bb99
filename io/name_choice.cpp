// SPDX-License-Identifier: MIT
#include "earshot/io/name_choice.h"

#include "earshot/base/assert.h"
#include "earshot/base/error.h"
#include "earshot/base/spelling.h"

#include <algorithm>

namespace earshot::io {

std::size_t find_name(const std::string& file,
                      const std::vector<std::string>& names,
                      const NameChoice& choice) {
    EARSHOT_ASSERT(!names.empty());
    if (choice.name.empty() && names.size() > 1) {
        throw Error(file,
                    "has " + std::to_string(names.size()) + " " + choice.role + "s",
                    "name one of them with " + choice.option);
    }
    if (choice.name.empty()) {
        return 0;
    }
    const auto found = std::find(names.begin(), names.end(), choice.name);
    if (found == names.end()) {
        throw Error(
            choice.name,
            file + " has no such " + choice.role,
            did_you_mean(choice.name, names, "check the names of its " + choice.role + "s"));
    }
    return static_cast<std::size_t>(found - names.begin());
}

}  // namespace earshot::io
