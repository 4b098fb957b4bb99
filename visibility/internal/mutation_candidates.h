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

/// A segment that contributed to a visible set, kept to be mutated (Bittner et al. 2009,
/// section 4.2).
struct MutationCandidate {
    geometry::Vec3 from{};  ///< the segment's origin
    geometry::Vec3 to{};    ///< its termination point, on `object`
    ObjectId object = 0;
    double from_radius = 0.0;  ///< radius of the object or cell at `from`, metres
};

/// The buffer of mutation candidates, ordered by how often each was mutated: the least mutated one
/// is selected next, and a full buffer drops the most mutated one.
class MutationCandidates {
public:
    static constexpr std::size_t kMaxSize = std::size_t{1} << 21U;

    explicit MutationCandidates(std::size_t max_size = kMaxSize) : max_size_(max_size) {}

    std::size_t size() const noexcept { return size_; }
    /// The number of distinct mutation counts among the candidates.
    std::size_t levels() const noexcept { return by_mutations_.size(); }
    void add(const MutationCandidate& candidate);
    /// The candidate to mutate next, whose count rises by one; empty if the buffer is.
    std::optional<MutationCandidate> select();

private:
    // Per mutation count, the oldest candidate first; no level is empty. There are few levels: a
    // count of a million needs a million selections of every candidate.
    std::map<std::uint64_t, std::deque<MutationCandidate>> by_mutations_;
    std::size_t size_ = 0;
    std::size_t max_size_;
};

}  // namespace earshot::visibility
