// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/types.h"
#include "earshot/visibility/objects.h"

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>

namespace earshot::visibility {

/// A sample that found something, to be varied: from where, to what.
struct Candidate {
    geometry::Vec3 from{};
    geometry::Vec3 to{};  ///< on `object`
    ObjectId object = 0;
    double from_radius = 0.0;  ///< of what lies at `from`, metres
};

/// Samples that found something. The one that was varied the least often is varied next; where
/// there is no more room, the one that was varied the most often goes (Bittner et al. 2009, section
/// 4.2).
class MutationStore {
public:
    static constexpr std::size_t kMost = std::size_t{1} << 21U;

    explicit MutationStore(std::size_t most = kMost) : most_(most) {}

    std::size_t size() const noexcept { return size_; }
    /// How many different numbers of uses there are among the candidates: never more than these.
    std::size_t levels() const noexcept { return by_uses_.size(); }
    void add(const Candidate& candidate);
    /// Empty if nothing was ever added.
    std::optional<Candidate> take();

private:
    // The oldest first; no level is empty. Few candidates are varied a million times each.
    std::map<std::uint64_t, std::deque<Candidate>> by_uses_;
    std::size_t size_ = 0;
    std::size_t most_;
};

}  // namespace earshot::visibility
