// SPDX-License-Identifier: MIT
#include "earshot/visibility/internal/mutation_store.h"

#include <iterator>

namespace earshot::visibility {

void MutationStore::add(const Candidate& candidate) {
    if (size_ == most_) {
        const auto most_used = std::prev(by_uses_.end());
        most_used->second.pop_front();
        if (most_used->second.empty()) {
            by_uses_.erase(most_used);
        }
        --size_;
    }
    by_uses_[0].push_back(candidate);
    ++size_;
}

std::optional<Candidate> MutationStore::take() {
    if (by_uses_.empty()) {
        return std::nullopt;
    }
    const auto least_used = by_uses_.begin();
    const Candidate candidate = least_used->second.front();
    by_uses_[least_used->first + 1].push_back(candidate);
    least_used->second.pop_front();
    if (least_used->second.empty()) {
        by_uses_.erase(least_used);
    }
    return candidate;
}

}  // namespace earshot::visibility
