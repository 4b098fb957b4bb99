// SPDX-License-Identifier: MIT
#include "earshot/io/result_names.h"

#include "earshot/base/error.h"

#include <algorithm>
#include <cctype>
#include <map>

namespace earshot::io {
namespace {

using propagation::Emitter;

}  // namespace

std::string as_file_name(const std::string& name) {
    constexpr std::size_t kMaxBytes = 80;
    std::size_t size = std::min(name.size(), kMaxBytes);
    while (size < name.size() && size > 0 &&
           (static_cast<unsigned char>(name[size]) & 0xC0U) == 0x80U) {
        --size;
    }
    std::string text = name.substr(0, size);
    for (char& c : text) {
        const auto byte = static_cast<unsigned char>(c);
        const bool is_plain =
            byte >= 0x80 || std::isalnum(byte) != 0 || c == '-' || c == '_' || c == '.' || c == ' ';
        c = is_plain ? c : '_';
    }
    return text;
}

ResultNames::ResultNames(const propagation::Scene& scene)
    : listener_count_(scene.listeners.size()) {
    std::map<std::string, std::string> pair_of_file;
    for (const Emitter& source : scene.sources) {
        for (const Emitter& listener : scene.listeners) {
            const std::string pair =
                "source \"" + source.name + "\" and listener \"" + listener.name + "\"";
            names_.push_back(as_file_name(source.name) + "__" + as_file_name(listener.name));
            const auto [there, is_new] = pair_of_file.emplace(names_.back(), pair);
            if (!is_new) {
                throw Error(
                    names_.back() + ".wav",
                    "would hold the response of two pairs: " + there->second + ", and " + pair,
                    "rename one of them");
            }
        }
    }
}

}  // namespace earshot::io
