// SPDX-License-Identifier: MIT
#include "earshot/frustum/internal/kept_connections.h"

namespace earshot::frustum {

void Connections::add(std::span<const std::uint32_t> subpaths, std::size_t kept) {
    kept_ += kept;
    subpaths_.insert(subpaths_.end(), subpaths.begin(), subpaths.end());
    ends_.push_back(static_cast<std::uint32_t>(subpaths_.size()));
}

void Connections::append(const Connections& others) {
    kept_ += others.kept_;
    const auto first = static_cast<std::uint32_t>(subpaths_.size());
    subpaths_.insert(subpaths_.end(), others.subpaths_.begin(), others.subpaths_.end());
    for (const std::uint32_t end : others.ends_) {
        ends_.push_back(first + end);
    }
}

}  // namespace earshot::frustum
