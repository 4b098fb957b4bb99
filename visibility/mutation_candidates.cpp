// SPDX-License-Identifier: MIT
#include "earshot/visibility/internal/mutation_candidates.h"

#include <iterator>

namespace earshot::visibility {

void MutationCandidates::add(const MutationCandidate& candidate) {
    if (size_ == max_size_) {
        const auto most_mutated = std::prev(by_mutations_.end());
        most_mutated->second.pop_front();
        if (most_mutated->second.empty()) {
            by_mutations_.erase(most_mutated);
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
    const auto least_mutated = by_mutations_.begin();
    const MutationCandidate candidate = least_mutated->second.front();
    by_mutations_[least_mutated->first + 1].push_back(candidate);
    least_mutated->second.pop_front();
    if (least_mutated->second.empty()) {
        by_mutations_.erase(least_mutated);
    }
    return candidate;
}

}  // namespace earshot::visibility
