// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/propagation/scene.h"

#include <cstddef>
#include <string>
#include <vector>

namespace earshot::io {

/// A name as a part of a file's name: what a file system might not take becomes `_`, and it is cut
/// after 80 bytes, at the beginning of a character.
std::string as_file_name(const std::string& name);

/// `SOURCE__LISTENER` of every pair, the beginnings of the names of its files.
class ResultNames {
public:
    /// What a file system might not take becomes `_`, and names are cut after 80 bytes. Throws
    /// Error if two pairs would share a file, as those of emitters of one name would.
    explicit ResultNames(const propagation::Scene& scene);

    const std::string& of(std::size_t source, std::size_t listener) const noexcept {
        return names_[source * listener_count_ + listener];
    }

private:
    std::size_t listener_count_ = 0;
    std::vector<std::string> names_;
};

}  // namespace earshot::io
