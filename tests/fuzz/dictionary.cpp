// SPDX-License-Identifier: MIT
#include "fuzz/dictionary.h"

#include <fstream>
#include <stdexcept>
#include <string_view>

namespace earshot::test {
namespace {

/// Between the quotes; throws std::exception for an escape that is not one.
std::string unescaped(std::string_view text) {
    std::string token;
    for (std::size_t i = 0; i < text.size(); ++i) {
        if (text[i] != '\\') {
            token += text[i];
        } else if (text.substr(i + 1, 1) == "x") {
            token += static_cast<char>(std::stoi(std::string(text.substr(i + 2, 2)), nullptr, 16));
            i += 3;
        } else {
            token += text.at(++i);
        }
    }
    return token;
}

}  // namespace

std::vector<std::string> read_dictionary(const std::filesystem::path& file) {
    std::vector<std::string> tokens;
    std::ifstream stream(file);
    for (std::string line; std::getline(stream, line);) {
        if (line.empty() || line.starts_with('#')) {
            continue;
        }
        const std::size_t first = line.find('"');
        const std::size_t last = line.rfind('"');
        if (first == std::string::npos || last == first) {
            throw std::runtime_error(file.string() + ": not a token: " + line);
        }
        tokens.push_back(unescaped(std::string_view(line).substr(first + 1, last - first - 1)));
    }
    return tokens;
}

}  // namespace earshot::test
