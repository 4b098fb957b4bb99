// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <vector>

namespace earshot::frustum {

/// Tells traces of beam trees apart: each has a stamp of its own.
using TraceStamp = std::shared_ptr<const std::uint8_t>;

inline TraceStamp new_stamp() {
    return std::make_shared<const std::uint8_t>();
}

/// In place of the position of something that there was not at the instant before.
inline constexpr std::uint32_t kNotBefore = std::numeric_limits<std::uint32_t>::max();

/// With which subpaths of the listeners each visible facet of a source's beam tree has been
/// connected (the connections of bidirectional path tracing, Veach and Guibas 1994): those to which
/// a leg may run from it, whether or not verification found a path.
class Connections {
public:
    /// Of the visible facet with that position in the tree.
    std::span<const std::uint32_t> of(std::size_t visible) const noexcept {
        const std::size_t begin = visible == 0 ? 0 : ends_[visible - 1];
        return std::span(subpaths_).subspan(begin, ends_[visible] - begin);
    }

    /// Of the next visible facet; the first `kept` were taken over.
    void add(std::span<const std::uint32_t> subpaths, std::size_t kept);
    void append(const Connections& others);

    std::size_t size() const noexcept { return subpaths_.size(); }
    /// Of these, that were taken over.
    std::size_t kept() const noexcept { return kept_; }
    std::size_t bytes() const noexcept {
        return (ends_.size() + subpaths_.size()) * sizeof(std::uint32_t);
    }

private:
    std::vector<std::uint32_t> ends_;  // per visible facet, into subpaths_
    std::vector<std::uint32_t> subpaths_;
    std::size_t kept_ = 0;
};

/// The connections of the instant before, or of now. A facet that was visible in the same frustum
/// through the same aperture, and a subpath that ends in another such one, are connected now if
/// they were: nothing else decides on it.
struct FormerConnections {
    const Connections* connections = nullptr;  ///< null: nothing is known
    bool are_of_now = false;                   ///< of these beam trees, not of those before

    /// Where a visible facet was; `now`: where it is, `before`: as its tree has it.
    std::uint32_t position(std::size_t now, std::uint32_t before) const noexcept {
        if (connections == nullptr) {
            return kNotBefore;
        }
        return are_of_now ? static_cast<std::uint32_t>(now) : before;
    }
};

}  // namespace earshot::frustum
