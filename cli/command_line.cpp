// SPDX-License-Identifier: MIT
#include "earshot/cli/command_line.h"

#include <algorithm>
#include <string_view>

namespace earshot::cli {
namespace {

/// The last name of a path; slashes at its end do not count.
std::string_view last_name(std::string_view path) {
    while (path.size() > 1 && path.ends_with('/')) {
        path.remove_suffix(1);
    }
    return path.substr(path.rfind('/') + 1);
}

/// "--output=a/b" and "-oa/b" keep the name of the option.
std::string without_folders(std::string_view argument) {
    std::size_t option = 0;
    if (argument.starts_with("--")) {
        const std::size_t sign = argument.find('=');
        option = sign == std::string_view::npos ? argument.size() : sign + 1;
    } else if (argument.starts_with('-')) {
        constexpr std::size_t kShortOption = 2;
        option = std::min(kShortOption, argument.size());
    }
    return std::string(argument.substr(0, option)) +
           std::string(last_name(argument.substr(option)));
}

/// As one word of a shell (POSIX.1-2017, shell command language, section 2.2.2).
std::string quoted(const std::string& word) {
    constexpr std::string_view kPlain =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_@%+=:,./-";
    if (!word.empty() && word.find_first_not_of(kPlain) == std::string::npos) {
        return word;
    }
    std::string text = "'";
    for (const char c : word) {
        text += c == '\'' ? std::string("'\\''") : std::string(1, c);
    }
    return text + "'";
}

}  // namespace

std::string command_line_without_folders(std::span<const char* const> arguments) {
    std::string text = "earshot";
    for (const char* const argument :
         arguments.subspan(std::min<std::size_t>(1, arguments.size()))) {
        text += " " + quoted(without_folders(argument));
    }
    return text;
}

}  // namespace earshot::cli
