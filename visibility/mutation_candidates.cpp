// SPDX-License-Identifier: MIT
#include "earshot/visibility/internal/mutation_candidates.h"

#include <iterator>

namespace earshot::visibility {

void MutationCandidates::add(const MutationCandidate& candidate) {
    if (size_ == max_size_) {
        const auto highest = std::prev(by_mutations_.end());
        highest->second.pop_front();
        if (highest->second.empty()) {
            by_mutations_.erase(highest);
        }
        --size_;
    }
    by_mutations_[0].push_back(candidate);
    ++size_;
}

std::optional<MutationCandidate> MutationCandidates::select() {
    if (by_mutations_.empty()) {
        return std::nullopt;
    }
    const auto lowest = by_mutations_.begin();
    const MutationCandidate candidate = lowest->second.front();
    by_mutations_[lowest->first + 1].push_back(candidate);
    lowest->second.pop_front();
    if (lowest->second.empty()) {
        by_mutations_.erase(lowest);
    }
    return candidate;
}

}  // namespace earshot::visibility
